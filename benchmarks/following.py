"""How fast a linked mesh follows its curve in Blender: ``python -m benchmarks.following``.

A curve drawn by hand, of 300 control points, is kept linked at 500 to 4000 triangles; one of its points moves, and the
mesh follows. Printed are the processor's seconds of each part, the least of seven times.
"""

from __future__ import annotations

import time

import bpy
import numpy as np

import addon.blender
from addon.blender import following, meshing, results
from addon.blender.linked import fingerprint, linked_settings

TIMES = 7


def main() -> None:
    """Draw, link, and move a point several times."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.blender.register()
    print("triangles    read    mesh   write     all, milliseconds of the processor")
    for n_triangles in (500, 1000, 2000, 4000):
        curve = draw()
        bpy.ops.tessera.mesh_curve(size_by="TRIANGLE_COUNT", triangle_count=n_triangles, keep_linked=True)
        obj = bpy.context.object
        obj.tessera.settings.edge_length = float(np.mean(obj.tessera.edge_lengths[1]))
        obj.tessera.settings.size_by = "EDGE_LENGTH"
        seconds = np.min([follow(curve, obj, number) for number in range(TIMES)], axis=0)
        numbers = "".join(f"{1000 * part:8.1f}" for part in (*seconds, seconds.sum()))
        print(f"{len(obj.data.polygons):9}{numbers}")
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


def follow(curve: bpy.types.Object, obj: bpy.types.Object, number: int) -> tuple[float, float, float]:
    """Seconds to read, to mesh and to write, after a point has moved: what `following.mesh_again` does."""
    curve.data.splines[0].points[0].co.x += 0.001 * (number + 1)
    curve.data.update_tag()
    bpy.context.view_layer.update()
    clock = [time.process_time()]
    settings = linked_settings(obj)
    task = meshing.read_task(curve, bpy.context.evaluated_depsgraph_get(), settings)
    assert fingerprint(task, settings) != obj.tessera.fingerprint
    clock.append(time.process_time())
    meshed = meshing.finish(meshing.mesh_task(task))
    clock.append(time.process_time())
    results.rewrite(obj, meshed)
    clock.append(time.process_time())
    assert not following.mesh_again(obj)  # it is as it would be
    return tuple(np.diff(clock))


if __name__ == "__main__":
    main()
