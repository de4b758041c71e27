"""Object > Convert > Mesh by Tessera."""

from typing import TYPE_CHECKING

import bpy

from ..kinds import READABLE

if TYPE_CHECKING:
    from ..meshing import Meshed


class TESSERA_OT_mesh_curve(bpy.types.Operator):
    """Make an even triangle mesh of each selected planar closed curve or text; the curve stays as it is"""

    bl_idname = "tessera.mesh_curve"
    bl_label = "Mesh by Tessera"
    bl_options = {"REGISTER", "UNDO"}

    # Not remembered from one use to the next: a length that suits one object rarely suits another.
    edge_length: bpy.props.FloatProperty(
        name="Edge Length",
        description="Target length of the triangles' edges, in the world's units. "
        "At first 1/25 of the longer side of the largest outline",
        default=0.0,
        min=0.0,
        soft_max=1000.0,
        precision=4,
        subtype="DISTANCE",
        unit="LENGTH",
        options={"SKIP_SAVE"},
    )
    boundary: bpy.props.EnumProperty(
        name="Boundary",
        description="Which vertices the mesh has on the outline",
        items=(
            ("RESAMPLE", "Resample", "Vertices at the target edge length along the outline; corners are kept"),
            ("KEEP", "Keep", "Exactly the vertices of the outline at the curve's resolution, and no other"),
        ),
        default="RESAMPLE",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Object Mode. What is selected is not asked: Adjust Last Operation polls when the new mesh is selected."""
        if context.mode != "OBJECT":
            cls.poll_message_set("Only in Object Mode")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Mesh everything, and only then make objects: a failure leaves the scene as it was."""
        from .. import meshing  # here, so that enabling the add-on does not load the mesher

        objects = [obj for obj in context.selected_objects if obj.type in READABLE]
        if not objects:
            self.report({"ERROR"}, "No curve or text is selected. Select what is to be meshed")
            return {"CANCELLED"}
        depsgraph = context.evaluated_depsgraph_get()
        try:
            outlines = [meshing.read(obj, depsgraph) for obj in objects]
            if not self.properties.is_property_set("edge_length"):
                self.edge_length = meshing.default_edge_length(outlines)
            meshed = [
                meshing.mesh(obj, outline, self.edge_length, self.boundary.lower())
                for obj, outline in zip(objects, outlines, strict=True)
            ]
        except meshing.Failure as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        _show(context, [m.write() for m in meshed], objects)
        self._summarise(meshed)
        return {"FINISHED"}

    def _summarise(self, meshed: "list[Meshed]") -> None:
        for m in meshed:
            for warning in m.report.warnings:
                self.report({"WARNING"}, f"{m.obj.name}: {warning}")
        triangles = sum(len(m.triangles) for m in meshed)
        worst = min(m.report.q_worst for m in meshed)
        mean = sum(m.report.q_mean * len(m.triangles) for m in meshed) / triangles
        self.report({"INFO"}, f"{triangles} triangles, quality {mean:.3f} on average, {worst:.3f} at worst")


def _show(context: bpy.types.Context, made: list[bpy.types.Object], sources: list[bpy.types.Object]) -> None:
    """Select the new objects in place of their sources, as Blender's own Convert does."""
    active = context.view_layer.objects.active
    for source in sources:
        source.select_set(False)
    for obj in made:
        obj.select_set(True)
    index = sources.index(active) if active in sources else 0
    context.view_layer.objects.active = made[index]
