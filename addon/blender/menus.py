"""Where the operators are found: Object > Convert, the object context menu, and the menus of the Edit Modes."""

from collections.abc import Callable

import bpy

from .kinds import is_readable
from .operators.mesh_curve import TESSERA_OT_mesh_curve
from .operators.remesh_faces import TESSERA_OT_remesh_faces

# Blender's search looks at the words of menu entries, so these have those that users look for.
_MESH_CURVE = "Mesh Curve by Tessera (Triangulate, Remesh)"
_REMESH_FACES = "Remesh Flat Faces by Tessera (Triangulate)"


def _draw_context(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Where something is selected that can be meshed; what is active does not matter to the operator."""
    if any(is_readable(obj) for obj in context.selected_objects):
        _draw_curve(menu, context)


def _draw_curve(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(TESSERA_OT_mesh_curve.bl_idname, text=_MESH_CURVE, icon="MESH_DATA")


def _draw_faces(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator(TESSERA_OT_remesh_faces.bl_idname, text=_REMESH_FACES, icon="MOD_TRIANGULATE")


_MENUS = (
    ("VIEW3D_MT_object_convert", _draw_curve),  # always, so that search finds it
    ("VIEW3D_MT_object_context_menu", _draw_context),
    ("VIEW3D_MT_edit_curve", _draw_curve),
    ("VIEW3D_MT_edit_font", _draw_curve),
    ("VIEW3D_MT_edit_curves", _draw_curve),
    ("VIEW3D_MT_edit_greasepencil", _draw_curve),
    ("VIEW3D_MT_edit_gpencil", _draw_curve),  # of Blender 4.2
    ("VIEW3D_MT_edit_mesh_faces", _draw_faces),
)


def _menus() -> list[tuple[type[bpy.types.Menu], Callable]]:
    """Those that this Blender has."""
    return [(getattr(bpy.types, name), draw) for name, draw in _MENUS if hasattr(bpy.types, name)]


def register() -> None:
    """Append to the menus."""
    for menu, draw in _menus():
        menu.append(draw)


def unregister() -> None:
    """Remove from the menus."""
    for menu, draw in reversed(_menus()):
        menu.remove(draw)
