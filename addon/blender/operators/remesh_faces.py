"""Mesh > Faces > Remesh Flat Faces by Tessera: in Edit Mode, the selected flat faces or closed edge loops."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..layout import draw_settings
from ..properties import annotations, read_settings, start_with
from ..settings import Settings
from .stepping import Refusal, Stepping

if TYPE_CHECKING:
    from ..meshing import Batch


class TESSERA_OT_remesh_faces(Stepping, bpy.types.Operator):
    """Remesh the selected flat faces, or fill selected closed edge loops, with even triangles; the rest stays"""

    bl_idname = "tessera.remesh_faces"
    bl_label = "Remesh Flat Faces by Tessera"
    bl_options = {"REGISTER", "UNDO", "PRESET"}
    __annotations__ = annotations(without=("result",))

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Edit Mode of a mesh."""
        if context.mode != "EDIT_MESH":
            cls.poll_message_set("Only in the Edit Mode of meshes")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Start with the last use's settings, but for those that rarely suit twice."""
        start_with(Settings(), self)
        return super().invoke(context, event)

    def chosen(self, context: bpy.types.Context) -> list[tuple[bpy.types.Object, Settings]]:
        """The meshes in which something is selected."""
        objects = [obj for obj in context.objects_in_mode_unique_data if obj.data.total_vert_sel]
        if not objects:
            raise Refusal("Nothing is selected. Select flat faces, or the edges of a closed flat loop")
        settings = read_settings(self)
        return [(obj, settings) for obj in objects]

    def write(self, context: bpy.types.Context, batch: Batch) -> None:
        """Replace the selected parts."""
        from ..writing import write_part

        for meshed in batch.meshed:
            write_part(meshed.task.obj, list(meshed.pieces))
        if len(batch.meshed) == 1:
            self.edge_length = batch.meshed[0].edge_length

    def draw(self, context: bpy.types.Context) -> None:
        """The settings, in Adjust Last Operation."""
        draw_settings(self.layout, self, source=context.object, without=("result",))
