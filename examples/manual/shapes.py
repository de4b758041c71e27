"""What is meshed in the manual's pictures, as Blender's curves, texts and meshes."""

from __future__ import annotations

from pathlib import Path

import bmesh
import bpy
import numpy as np

from .window import add

LOGO = Path(__file__).resolve().parents[1] / "logo.svg"


def words(body: str) -> bpy.types.Object:
    """A text in Blender's own font."""
    data = bpy.data.curves.new("Words", "FONT")
    data.body = body
    return add("Words", data)


def logo() -> list[bpy.types.Object]:
    """The logo's SVG file by Blender's own importer, made 2 units wide."""
    import addon_utils  # Blender's own

    addon_utils.enable("io_curve_svg")
    before = set(bpy.data.objects)
    bpy.ops.import_curve.svg(filepath=str(LOGO))
    curves = sorted(set(bpy.data.objects) - before, key=lambda obj: obj.name)
    width = max(corner[0] for curve in curves for corner in curve.bound_box)
    for curve in curves:
        curve.scale *= 2.0 / width
    return curves


def poly(name: str, loops: list[np.ndarray]) -> bpy.types.Object:
    """Closed polygons (k, 2) as one curve."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "2D"
    for loop in loops:
        spline = data.splines.new("POLY")
        spline.points.add(len(loop) - 1)
        spline.points.foreach_set("co", np.column_stack([loop, np.zeros(len(loop)), np.ones(len(loop))]).ravel())
        spline.use_cyclic_u = True
    return add(name, data)


def bezier(name: str, points: list[tuple]) -> bpy.types.Object:
    """A closed Bézier curve; each point is x, y, and the x, y of its two handles, or alone where it is a corner."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.resolution_u = "2D", 16
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(len(points) - 1)
    spline.use_cyclic_u = True
    for point, given in zip(spline.bezier_points, points, strict=True):
        point.co = (*given[:2], 0)
        if len(given) == 2:
            point.handle_left_type = point.handle_right_type = "VECTOR"
        else:
            point.handle_left_type = point.handle_right_type = "FREE"
            point.handle_left, point.handle_right = (*given[2:4], 0), (*given[4:], 0)
    return add(name, data)


def bodice() -> bpy.types.Object:
    """Half of the front of a shirt, in metres: neck, shoulder, armhole, side, hem."""
    return bezier(
        "Front",
        [
            (0, 0),
            (0.26, 0.0),
            (0.25, 0.36, 0.25, 0.30, 0.18, 0.38),
            (0.20, 0.58, 0.16, 0.50, 0.20, 0.58),
            (0.08, 0.62, 0.08, 0.62, 0.08, 0.56),
            (0.0, 0.52, 0.04, 0.52, 0.0, 0.52),
        ],
    )


def sleeve() -> bpy.types.Object:
    """A sleeve, in metres: its cap is an S on either side."""
    obj = bezier(
        "Sleeve",
        [
            (0.06, 0.0),
            (0.26, 0.0),
            (0.32, 0.24, 0.32, 0.24, 0.26, 0.25),
            (0.16, 0.38, 0.24, 0.38, 0.08, 0.38),
            (0.0, 0.24, 0.06, 0.25, 0.0, 0.24),
        ],
    )
    obj.location.x = 0.34
    return obj


def airfoil(n: int = 80) -> np.ndarray:
    """NACA 0012 with a sharp trailing edge and chord 1, (2 n - 2, 2), clockwise from there."""
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, n)))
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    lower, upper = np.column_stack([x, -half]), np.column_stack([x, half])
    return np.concatenate([lower[::-1], upper[1:-1]])


def around_the_airfoil() -> bpy.types.Object:
    """A channel with an airfoil in it, at an angle of attack of 8 degrees, as a hole."""
    angle = np.radians(-8.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    channel = np.array([[-1.0, -0.9], [2.4, -0.9], [2.4, 0.9], [-1.0, 0.9]])
    return poly("Channel", [channel, (airfoil() - [0.25, 0]) @ turn.T + [0.25, 0]])


def bracket() -> bpy.types.Object:
    """A plate 0.2 thick, L-shaped, whose large faces are n-gons."""
    corners = [(0, 0), (2, 0), (2, 0.7), (0.9, 0.9), (0.7, 1.8), (0, 1.8)]
    bm = bmesh.new()
    face = bm.faces.new([bm.verts.new((x, y, 0.0)) for x, y in corners])
    made = bmesh.ops.extrude_face_region(bm, geom=[face])
    bmesh.ops.translate(bm, vec=(0, 0, 0.2), verts=[v for v in made["geom"] if isinstance(v, bmesh.types.BMVert)])
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)
    data = bpy.data.meshes.new("Bracket")
    bm.to_mesh(data)
    bm.free()
    return add("Bracket", data)


def bow_tie() -> bpy.types.Object:
    """A curve that crosses itself."""
    return poly("Bow tie", [np.array([(0.0, 0.0), (2.0, 1.0), (2.0, 0.0), (0.0, 1.0)])])
