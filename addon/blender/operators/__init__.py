"""One operator a file."""

import bpy

from .mesh_again import TESSERA_OT_mesh_again, TESSERA_OT_unlink
from .mesh_curve import TESSERA_OT_mesh_curve
from .remesh_faces import TESSERA_OT_remesh_faces
from .select_place import TESSERA_OT_select_place

_CLASSES = (
    TESSERA_OT_mesh_curve,
    TESSERA_OT_remesh_faces,
    TESSERA_OT_mesh_again,
    TESSERA_OT_unlink,
    TESSERA_OT_select_place,
)


def register() -> None:
    """Register every operator."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Unregister every operator, in the opposite order."""
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
