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
        """Activate the object, select the point of a curve or the vertex of a mesh, frame it."""
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
        if obj.type in {"CURVE", "MESH"} and obj.is_editable and obj.data.is_editable:
            at = np.array(obj.matrix_world.inverted_safe() @ Vector(self.place))
            if obj.type == "CURVE":
                bpy.ops.object.mode_set(mode="EDIT")
                _select_in_curve(obj.data, self.spline, at)
            else:
                bpy.ops.object.mode_set(mode="OBJECT")
                _select_in_mesh(obj.data, at)
                bpy.ops.object.mode_set(mode="EDIT")
        _frame(context)
        return {"FINISHED"}


def _select_in_curve(curve: bpy.types.Curve, number: int, at: np.ndarray) -> None:
    bpy.ops.curve.select_all(action="DESELECT")
    splines = [curve.splines[number - 1]] if 0 < number <= len(curve.splines) else curve.splines
    points = [point for spline in splines for point in (spline.bezier_points or spline.points)]
    if points:
        nearest = min(points, key=lambda point: np.linalg.norm(np.array(point.co)[:3] - at))
        name = "select_control_point" if isinstance(nearest, bpy.types.BezierSplinePoint) else "select"
        setattr(nearest, name, True)


def _select_in_mesh(mesh: bpy.types.Mesh, at: np.ndarray) -> None:
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    chosen = np.zeros(len(mesh.vertices), dtype=bool)
    if len(chosen):
        chosen[np.argmin(np.linalg.norm(points.reshape(-1, 3) - at, axis=1))] = True
    for items in (mesh.edges, mesh.polygons):
        items.foreach_set("select", np.zeros(len(items), dtype=bool))
    mesh.vertices.foreach_set("select", chosen)


def _frame(context: bpy.types.Context) -> None:
    """Centre the 3D views on the cursor."""
    for area in context.screen.areas if context.screen else ():
        if area.type == "VIEW_3D":
            area.spaces.active.region_3d.view_location = context.scene.cursor.location
