"""Where the operators are found: Object > Convert, and the object context menu, for curves and text."""

import bpy

from .kinds import READABLE
from .operators.mesh_curve import TESSERA_OT_mesh_curve


def _draw_convert(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    if context.object is not None and context.object.type in READABLE:
        menu.layout.separator()
        menu.layout.operator(TESSERA_OT_mesh_curve.bl_idname, icon="MESH_DATA")


_MENUS = ("VIEW3D_MT_object_convert", "VIEW3D_MT_object_context_menu")


def register() -> None:
    """Append to the menus."""
    for name in _MENUS:
        getattr(bpy.types, name).append(_draw_convert)


def unregister() -> None:
    """Remove from the menus."""
    for name in reversed(_MENUS):
        getattr(bpy.types, name).remove(_draw_convert)
