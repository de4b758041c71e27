"""Run inside Blender by test_installed.py: saves a scene of curves, or of so many stars, under the path after `--`."""

import math
import sys

import bpy


def curve(name, loop, cyclic=True):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "2D"
    spline = data.splines.new("POLY")
    spline.points.add(len(loop) - 1)
    for point, (x, y) in zip(spline.points, loop, strict=True):
        point.co = (x, y, 0.0, 1.0)
    spline.use_cyclic_u = cyclic
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, data))


path, *count = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
if count:
    for number in range(int(count[0])):
        n = 6 + number
        points = [(math.cos(math.pi * i / n), math.sin(math.pi * i / n)) for i in range(2 * n)]
        curve(f"Star {number:02}", [(x, y) if i % 2 else (x / 2, y / 2) for i, (x, y) in enumerate(points)])
    bpy.ops.wm.save_as_mainfile(filepath=path)
    sys.exit()
curve("Outline", [(0, 0), (2, 0), (2, 1), (1, 0.5), (0, 1)])
curve("Path", [(0, 3), (1, 3), (1, 4)], cyclic=False)
curve("Bow tie", [(3, 0), (4, 1), (4, 0), (3, 1)])
words = bpy.data.curves.new("Words", "FONT")
words.body = "TOM"
bpy.context.scene.collection.objects.link(bpy.data.objects.new("Words", words))
bpy.ops.wm.save_as_mainfile(filepath=path)
