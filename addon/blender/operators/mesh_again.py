"""Mesh Again, and Unlink: for meshes that are kept linked to their source."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from .. import following
from ..linked import is_draft, is_linked, linked_settings, problem, unlink
from .stepping import Refusal, Stepping

if TYPE_CHECKING:
    from ..meshing import Batch
    from ..settings import Settings


class TESSERA_OT_mesh_again(Stepping, bpy.types.Operator):
    """Mesh the selected linked meshes again, as their sources and settings are now; materials and modifiers stay"""

    bl_idname = "tessera.mesh_again"
    bl_label = "Mesh Again"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Object Mode, with a linked mesh active."""
        return _poll(cls, context)

    def chosen(self, context: bpy.types.Context) -> list[tuple[bpy.types.Object, Settings]]:
        """The sources, by the settings at the meshes."""
        self.targets = _targets(context)
        for obj in self.targets:
            if trouble := problem(obj):
                raise Refusal(f"Mesh '{obj.name}': {trouble}")
        return [(obj.tessera.source, linked_settings(obj)) for obj in self.targets]

    def write(self, context: bpy.types.Context, batch: Batch) -> None:
        """New geometry for each mesh whose source could be meshed."""
        from .. import meshing, results

        for target, outcome in zip(self.targets, batch.outcomes, strict=True):
            if isinstance(outcome, meshing.Meshed):
                results.rewrite(target, outcome)


class TESSERA_OT_unlink(bpy.types.Operator):
    """Forget the source: the selected linked meshes become plain meshes, and stay as they are"""

    bl_idname = "tessera.unlink"
    bl_label = "Unlink"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Object Mode, with a linked mesh active."""
        return _poll(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Forget it."""
        for obj in _targets(context):
            if is_draft(obj) and not following.mesh_again(obj):
                self.report({"WARNING"}, f"Mesh '{obj.name}' stays the draft that it is: {obj.tessera.message}")
            unlink(obj)
        return {"FINISHED"}


def _poll(cls, context: bpy.types.Context) -> bool:
    if context.mode != "OBJECT" or not is_linked(context.object):
        cls.poll_message_set("Only in Object Mode, for a mesh of this file that was made with Keep Linked")
        return False
    return True


def _targets(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The linked meshes that are selected, and the active one."""
    chosen = [obj for obj in context.selected_objects if is_linked(obj)]
    return chosen if context.object in chosen else [context.object, *chosen]
