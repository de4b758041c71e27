"""Where the operators are found: Object > Convert, the object context menu, and the menus of the Edit Modes."""

import bpy

from .kinds import is_readable
from .operators.mesh_curve import TESSERA_OT_mesh_curve
from .operators.remesh_faces import TESSERA_OT_remesh_faces

# Blender's search looks at the words of menu entries, so these have those that users look for.
_MESH_CURVE = "Mesh Curve by Tessera (Triangulate, Remesh)"
_REMESH_FACES = "Remesh Flat Faces by Tessera (Triangulate)"


def _draw_convert(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    if context.object is not None and is_readable(context.object):
        _draw_curve(menu, context)


def _draw_curve(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(TESSERA_OT_mesh_curve.bl_idname, text=_MESH_CURVE, icon="MESH_DATA")


def _draw_faces(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(TESSERA_OT_remesh_faces.bl_idname, text=_REMESH_FACES, icon="MOD_TRIANGULATE")


_MENUS = (
    ("VIEW3D_MT_object_convert", _draw_convert),
    ("VIEW3D_MT_object_context_menu", _draw_convert),
    ("VIEW3D_MT_edit_curve", _draw_curve),
    ("VIEW3D_MT_edit_mesh_faces", _draw_faces),
)


def register() -> None:
    """Append to the menus."""
    for name, draw in _MENUS:
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    """Remove from the menus."""
    for name, draw in reversed(_MENUS):
        getattr(bpy.types, name).remove(draw)
