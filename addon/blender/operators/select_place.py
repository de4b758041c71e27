"""Go to where a failure is: what is nearest to it is selected in Edit Mode, and the view shows it."""

import bpy
import numpy as np
from mathutils import Vector


class TESSERA_OT_select_place(bpy.types.Operator):
    """Select the point next to where meshing failed, in Edit Mode, and put the 3D cursor there"""

    bl_idname = "tessera.select_place"
    bl_label = "Select the Point"
    bl_options = {"REGISTER", "UNDO"}

    object_name: bpy.props.StringProperty(name="Object", description="Name of the object that could not be meshed")
    spline: bpy.props.IntProperty(name="Spline", description="Number of its spline, from 1; 0: any", min=0)
    place: bpy.props.FloatVectorProperty(
        name="Place", description="Where it is, in world space and units", size=3, subtype="XYZ", unit="LENGTH"
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Activate the object, select its point where it has such, frame it."""
        from ..selecting import can_select, select_nearest  # here, so that enabling the add-on does not load the mesher

        obj = context.view_layer.objects.get(self.object_name)
        if obj is None or not obj.visible_get():
            self.report({"ERROR"}, f"'{self.object_name}' is not to be seen in this view layer. Show it first")
            return {"CANCELLED"}
        if context.mode != "OBJECT" and context.object != obj:
            bpy.ops.object.mode_set(mode="OBJECT")
        if context.mode == "OBJECT":
            for other in context.selected_objects:
                other.select_set(False)
            obj.select_set(True)
            context.view_layer.objects.active = obj
        context.scene.cursor.location = self.place
        if can_select(obj):
            at = np.array(obj.matrix_world.inverted_safe() @ Vector(self.place))
            bpy.ops.object.mode_set(mode="OBJECT")
            select_nearest(obj, self.spline, at)
        _frame(context)
        return {"FINISHED"}


def _frame(context: bpy.types.Context) -> None:
    """Centre the 3D views on the cursor."""
    for area in context.screen.areas if context.screen else ():
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_location = context.scene.cursor.location
