"""Object > Convert > Mesh by Tessera, and the same for the curve or text in Edit Mode."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..kinds import is_readable
from ..layout import draw_settings
from ..preferences import default_settings
from ..properties import annotations, read_settings, start_with
from .stepping import Refusal, Stepping

if TYPE_CHECKING:
    from ..meshing import Batch
    from ..settings import Settings

_MODES = frozenset({"OBJECT", "EDIT_CURVE", "EDIT_CURVES", "EDIT_TEXT", "EDIT_GREASE_PENCIL", "EDIT_GPENCIL"})


class TESSERA_OT_mesh_curve(Stepping, bpy.types.Operator):
    """Triangulate planar closed curves, texts, strokes and flat meshes evenly: mesh or remesh each selected object"""

    bl_idname = "tessera.mesh_curve"
    bl_label = "Mesh Curve by Tessera"
    bl_options = {"REGISTER", "UNDO", "PRESET"}
    __annotations__ = annotations()

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """The mode. What is selected is not asked: Adjust Last Operation polls when the new mesh is selected."""
        if context.mode not in _MODES:
            cls.poll_message_set("Only in Object Mode and in the Edit Mode of curves, texts and strokes")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Start with the preferences, where neither a script, a preset nor the last use says anything."""
        start_with(default_settings(), self)
        return super().invoke(context, event)

    def chosen(self, context: bpy.types.Context) -> list[tuple[bpy.types.Object, Settings]]:
        """What is selected, or what is in Edit Mode."""
        objects = [obj for obj in _objects(context) if is_readable(obj)]
        if not objects:
            raise Refusal("Nothing that can be meshed is selected. Select curves, texts, strokes or flat meshes")
        settings = read_settings(self)
        return [(obj, settings) for obj in objects]

    def write(self, context: bpy.types.Context, batch: Batch) -> None:
        """Make the meshes, and select them in place of their sources."""
        from .. import results

        sources = [meshed.task.obj for meshed in batch.meshed]
        active = sources.index(context.object) if context.object in sources else 0
        if context.mode != "OBJECT":
            # Undo in Edit Mode knows of the edited object alone.
            bpy.ops.object.mode_set(mode="OBJECT")
        made = results.write_results(list(batch.meshed))
        replaced = read_settings(self).result == "REPLACE"
        if not results.select(context, made, [] if replaced else sources, active):
            name = made[0].users_collection[0].name
            self.report({"WARNING"}, f"The mesh is in the collection '{name}', which this view layer does not show")
        if len(batch.meshed) == 1:
            # So that Adjust Last Operation starts from a length, and not from 0.
            self.edge_length = batch.meshed[0].edge_length

    def draw(self, context: bpy.types.Context) -> None:
        """The settings, in Adjust Last Operation."""
        draw_settings(self.layout, self)


def _objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    return list(context.selected_objects if context.mode == "OBJECT" else context.objects_in_mode)
