"""Run inside a Blender with the extension installed, by test_installed.py: writes what happened as JSON after `--`."""

import json
import sys

import addon_utils
import bpy

heavy_before = [name for name in ("onnxruntime",) if name in sys.modules]
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)

bpy.ops.curve.primitive_bezier_circle_add(radius=1.0)
assert bpy.ops.tessera.mesh_curve(edge_length=0.15) == {"FINISHED"}
mesh = bpy.context.object
package = "bl_ext.user_default.tessera"
quality = sys.modules[f"{package}.addon.tessera.quality"].element_quality
vertices = __import__("numpy").array([vertex.co[:2] for vertex in mesh.data.vertices], dtype=float)
triangles = __import__("numpy").array([polygon.vertices[:] for polygon in mesh.data.polygons])

data = bpy.data.curves.new("Bow tie", "CURVE")
spline = data.splines.new("POLY")
spline.points.add(3)
for point, (x, y) in zip(spline.points, [(0, 0), (1, 1), (1, 0), (0, 1)], strict=True):
    point.co = (x, y, 0.0, 1.0)
spline.use_cyclic_u = True
bow_tie = bpy.data.objects.new("Bow tie", data)
bpy.context.scene.collection.objects.link(bow_tie)
bpy.ops.object.select_all(action="DESELECT")
bow_tie.select_set(True)
objects_before = sorted(obj.name for obj in bpy.data.objects)
try:
    bpy.ops.tessera.mesh_curve(edge_length=0.1)
    refusal = ""
except RuntimeError as error:
    refusal = str(error)
objects_after = sorted(obj.name for obj in bpy.data.objects)

import onnxruntime  # noqa: E402

module = sys.modules[f"{package}.addon.blender.menus"]
addon_utils.disable(package)
menus = sum(
    function.__module__ == module.__name__
    for name in ("VIEW3D_MT_object_convert", "VIEW3D_MT_object_context_menu")
    for function in getattr(bpy.types, name).draw._draw_funcs
)
facts = {
    "module": module.__name__,
    "heavy_before": heavy_before,
    "onnxruntime": onnxruntime.__file__,
    "triangles": len(triangles),
    "q_mean": float(quality(vertices, triangles).mean()),
    "refusal": refusal,
    "objects_before_refusal": objects_before,
    "objects_after_refusal": objects_after,
    "menus_after_disabling": menus,
}
with open(sys.argv[sys.argv.index("--") + 1], "w") as file:
    json.dump(facts, file)
