"""One operator a file."""

import bpy

from .mesh_curve import TESSERA_OT_mesh_curve

_CLASSES = (TESSERA_OT_mesh_curve,)


def register() -> None:
    """Register every operator."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Unregister every operator, in the opposite order."""
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
