"""Objects for the tests, linked into the scene and selected, and measures of their meshes."""

import bpy
import numpy as np

SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def poly_curve(*loops, name="Outline", cyclic=True, dimensions="2D"):
    """A curve object of straight splines; loops: sequences of (x, y) or (x, y, z)."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = dimensions
    for loop in loops:
        points = np.zeros((len(loop), 4), dtype=np.float32)
        points[:, 3] = 1.0
        points[:, : len(loop[0])] = loop
        spline = curve.splines.new("POLY")
        spline.points.add(len(loop) - 1)
        spline.points.foreach_set("co", points.ravel())
        spline.use_cyclic_u = cyclic
    return _link(bpy.data.objects.new(name, curve))


def circle(radius=1.0, name="Circle"):
    """A Bezier circle, as Add > Curve > Circle makes it."""
    bpy.ops.curve.primitive_bezier_circle_add(radius=radius)
    obj = bpy.context.object
    obj.name = name
    return obj


def text(body, name="Text"):
    """A text object in Blender's own font."""
    data = bpy.data.curves.new(name, "FONT")
    data.body = body
    return _link(bpy.data.objects.new(name, data))


def star(points=7, outer=1.0, inner=0.45):
    """A star's loop, (2 * points, 2): not convex, with sharp corners."""
    angles = np.arange(2 * points) * np.pi / points
    radii = np.where(np.arange(2 * points) % 2 == 0, outer, inner)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def select(*objects):
    """Only these are selected, the first is active."""
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]


def vertices(obj):
    """(n, 3) float64 in the object's space."""
    out = np.empty((len(obj.data.vertices), 3), dtype=np.float32)
    obj.data.vertices.foreach_get("co", out.ravel())
    return out.astype(np.float64)


def triangles(obj):
    """(m, 3) int32."""
    assert all(polygon.loop_total == 3 for polygon in obj.data.polygons)
    out = np.empty(3 * len(obj.data.polygons), dtype=np.int32)
    obj.data.loops.foreach_get("vertex_index", out)
    return out.reshape(-1, 3)


def world(obj, points):
    """(n, 3) in the object's space to world space."""
    matrix = np.array(obj.matrix_world, dtype=np.float64)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def counts():
    """How much of everything there is, and what is selected: what a failure must leave as it was."""
    kinds = ("objects", "meshes", "curves", "materials", "collections")
    selected = sorted(obj.name for obj in bpy.context.selected_objects)
    active = bpy.context.view_layer.objects.active
    names = sorted(item.name for kind in kinds for item in getattr(bpy.data, kind))
    return names, selected, active.name if active else None


def _link(obj):
    bpy.context.scene.collection.objects.link(obj)
    select(obj)
    return obj


def border(tris):
    """The edges of exactly one triangle, (k, 2)."""
    edges = np.sort(np.concatenate([tris[:, [0, 1]], tris[:, [1, 2]], tris[:, [2, 0]]]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    assert count.max() <= 2
    return unique[count == 1]


def distance_to(polygon, points):
    """How far each point is from a closed polyline; both in any dimension."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    along = np.einsum("pkd,kd->pk", points[:, None] - a, b - a) / np.sum((b - a) ** 2, axis=1)
    nearest = a + np.clip(along, 0, 1)[..., None] * (b - a)
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)


def move(curve, number, x):
    """One point of the curve, and what Blender does after it."""
    curve.data.splines[0].points[number].co.x = x
    curve.data.update_tag()
    bpy.context.view_layer.update()


def right(mesh):
    return vertices(mesh)[:, 0].max()
