"""The sidebar's tab: what was made, how good it is, and what a linked mesh is made of."""

from __future__ import annotations

import bpy

from . import notes, overlay
from .layout import draw_failures, draw_settings, draw_text
from .linked import BINS, is_linked, problem, shape_of

_MOST_FAILURES = 5
_LINE = 42  # characters that fit the sidebar


class TESSERA_PT_mesh(bpy.types.Panel):
    """How good the active mesh is."""

    bl_label = "Tessera"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Tessera"

    def draw(self, context: bpy.types.Context) -> None:
        """The overlay's switch, and the numbers."""
        layout, obj = self.layout, context.object
        operator = "tessera.remesh_faces" if context.mode == "EDIT_MESH" else "tessera.mesh_curve"
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator(operator, icon="MESH_DATA")
        layout.prop(context.window_manager, "tessera_show_quality", icon="OVERLAY", toggle=True)
        if context.window_manager.tessera_show_quality:
            overlay.draw_legend(layout)
        if obj is not None and obj.type == "MESH" and obj.tessera.n_triangles:
            if obj.tessera.shape != shape_of(obj.data):
                draw_text(layout, "Edited since it was meshed: these numbers are of before", _LINE)
            _draw_statistics(layout, obj.tessera)


class TESSERA_PT_linked(bpy.types.Panel):
    """The source and the settings of a linked mesh."""

    bl_label = "Keep Linked"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Tessera"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """A linked mesh is active."""
        return is_linked(context.object)

    def draw(self, context: bpy.types.Context) -> None:
        """Source, settings, and the button."""
        layout, note = self.layout, context.object.tessera
        layout.operator_context = "INVOKE_DEFAULT"
        row = layout.row(align=True)
        row.operator("tessera.mesh_again", icon="FILE_REFRESH")
        row.operator("tessera.unlink", text="", icon="UNLINKED")
        layout.prop(note, "automatic")
        row = layout.row()
        row.enabled = False
        row.prop(note, "source")
        for trouble in dict.fromkeys((problem(context.object), note.message)):
            if trouble:
                draw_text(layout.box(), trouble, _LINE)
        draw_settings(layout, note.settings, source=note.source, without=("result",))


class TESSERA_PT_failures(bpy.types.Panel):
    """What could not be meshed."""

    bl_label = "Not Meshed"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Tessera"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Something failed in the last use."""
        return bool(notes.still_there())

    def draw(self, context: bpy.types.Context) -> None:
        """Each failure, with a button that leads to its place."""
        draw_failures(self.layout, _MOST_FAILURES, _LINE)


def _draw_statistics(layout: bpy.types.UILayout, note) -> None:
    column = layout.column(align=True)
    shortest, mean, longest = (bpy.utils.units.to_string(*_unit(), length) for length in note.edge_lengths)
    for name, value in (
        ("Triangles", f"{note.n_triangles:,}"),
        ("Worst quality", f"{note.q_worst:.3f}"),
        ("Mean quality", f"{note.q_mean:.3f}"),
        ("Shortest edge", shortest),
        ("Mean edge", mean),
        ("Longest edge", longest),
    ):
        row = column.split(factor=0.5)
        row.label(text=name)
        row.label(text=value)
    column = layout.column(align=True)
    column.label(text="Triangles by quality")
    for low, high, count in zip(BINS, BINS[1:], note.histogram):
        share = count / note.n_triangles
        column.progress(factor=share, type="BAR", text=f"{low:.1f} – {high:.1f}: {count:,}")


def _unit() -> tuple[str, str]:
    system = bpy.context.scene.unit_settings.system
    return system, "LENGTH"


_CLASSES = (TESSERA_PT_mesh, TESSERA_PT_linked, TESSERA_PT_failures)


def register() -> None:
    """Register the panels."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Unregister the panels, in the opposite order."""
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
