"""How fast a linked mesh follows its curve in Blender: ``python -m benchmarks.following``.

A curve drawn by hand, of 300 control points, is kept linked at 500 to 4000 triangles; one of its points moves, and the
mesh follows: with a draft while the curve changes, and as its settings say when it rests. Printed are the milliseconds
of the processor for each, the median of seven times.
"""

from __future__ import annotations

import time

import bpy
import numpy as np

import addon.blender
from addon.blender import following

TIMES = 7


def main() -> None:
    """Draw, link, and move a point several times."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.blender.register()
    print("triangles   draft: worst, mean quality   as set: worst, mean quality")
    for n_triangles in (500, 1000, 2000, 4000):
        curve = draw()
        bpy.ops.tessera.mesh_curve(size_by="TRIANGLE_COUNT", triangle_count=n_triangles, keep_linked=True)
        obj = bpy.context.object
        # Edges are a little shorter than their target.
        obj.tessera.settings.edge_length = 1.05 * float(np.mean(obj.tessera.edge_lengths[1]))
        obj.tessera.settings.size_by = "EDGE_LENGTH"
        line = ""
        for draft in (True, False):
            seconds = np.median([follow(curve, obj, number, draft) for number in range(TIMES)])
            line += f"{1000 * seconds:8.0f}{obj.tessera.q_worst:10.3f}{obj.tessera.q_mean:10.3f}"
        print(f"{len(obj.data.polygons):9}{line}")
    addon.blender.unregister()


def draw() -> bpy.types.Object:
    """A wavy closed line, as the Draw tool leaves it; it is selected."""
    t = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    radius = 1 + 0.28 * np.cos(3 * t + 0.4) + 0.12 * np.sin(5 * t) + 0.01 * np.sin(40 * t)
    data = bpy.data.curves.new("Drawn", "CURVE")
    spline = data.splines.new("POLY")
    spline.points.add(len(t) - 1)
    points = np.column_stack([radius * np.cos(t), radius * np.sin(t), np.zeros(len(t)), np.ones(len(t))])
    spline.points.foreach_set("co", points.ravel())
    spline.use_cyclic_u = True
    obj = bpy.data.objects.new("Drawn", data)
    bpy.context.scene.collection.objects.link(obj)
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def follow(curve: bpy.types.Object, obj: bpy.types.Object, number: int, draft: bool) -> float:
    """Seconds in which the mesh follows after a point of the curve has moved."""
    curve.data.splines[0].points[0].co.x += 0.001 * (number + 1)
    curve.data.update_tag()
    bpy.context.view_layer.update()
    since = time.process_time()
    assert following.mesh_again(obj, draft)
    return time.process_time() - since


if __name__ == "__main__":
    main()
