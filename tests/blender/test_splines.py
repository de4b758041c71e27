"""Splines come out where Blender itself evaluates them."""

import bpy
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.blender import splines
from addon.blender.reading_curve import read_curve


def evaluated(curve):
    """(k, 3), the vertices that Blender makes of a curve."""
    holder = bpy.data.objects.new("Holder", curve)
    mesh = holder.to_mesh()
    points = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float64).reshape(-1, 3)
    holder.to_mesh_clear()
    bpy.data.objects.remove(holder)
    return points


def read(curve):
    """(k, 3), all the points that are read of a curve."""
    holder = bpy.data.objects.new("Holder", curve)
    bpy.context.scene.collection.objects.link(holder)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    points = np.concatenate([p.points for p in read_curve(holder.evaluated_get(depsgraph), depsgraph)])
    bpy.data.objects.remove(holder)
    return points


def distance_to(points, polyline):
    """How far each point is from a polyline; both (k, 3)."""
    a, along = polyline[:-1], np.diff(polyline, axis=0)
    fraction = ((points[:, None] - a) * along).sum(axis=-1) / np.maximum((along**2).sum(axis=-1), 1e-30)
    nearest = a + np.clip(fraction, 0, 1)[..., None] * along
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)


@settings(max_examples=40, deadline=None)
@given(
    st.integers(2, 7),
    st.booleans(),
    st.integers(1, 9),
    st.lists(st.sampled_from(["FREE", "VECTOR", "ALIGNED", "AUTO"]), min_size=14, max_size=14),
    st.integers(0, 2**31),
)
def test_bezier_splines(count, cyclic, resolution, handles, seed):
    generator = np.random.default_rng(seed)
    curve = bpy.data.curves.new("Bezier", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(count - 1)
    spline.use_cyclic_u, spline.resolution_u = cyclic, resolution
    for i, point in enumerate(spline.bezier_points):
        point.co, point.handle_left, point.handle_right = generator.normal(size=(3, 3))
        point.handle_left_type, point.handle_right_type = handles[2 * i : 2 * i + 2]
    expected = evaluated(curve)
    found = read(curve)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < 2e-5


@settings(max_examples=40, deadline=None)
@given(st.integers(3, 9), st.integers(2, 5), *[st.booleans()] * 3, st.integers(0, 2**31))
def test_nurbs(count, order, cyclic, endpoint, bezier, seed):
    generator = np.random.default_rng(seed)
    curve = bpy.data.curves.new("Nurbs", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("NURBS")
    spline.points.add(count - 1)
    coordinates = np.column_stack([generator.normal(size=(count, 3)), generator.uniform(0.5, 2, count)])
    spline.points.foreach_set("co", coordinates.astype(np.float32).ravel())
    spline.use_cyclic_u, spline.use_endpoint_u, spline.use_bezier_u = cyclic, endpoint, bezier
    spline.order_u, spline.resolution_u = order, 64
    expected = evaluated(curve)
    found = read(curve)
    if bpy.app.version >= (5, 0):
        assert found.shape == expected.shape
        assert np.abs(found - expected).max() < 2e-5
    around = np.concatenate([found, found[:1]]) if cyclic else found
    # Points of one curve at different parameters: as far from each other's chords as so fine chords are from the curve.
    assert distance_to(expected, around).max() < 0.02


def test_catmull_rom_goes_through_its_points_with_the_slope_of_its_neighbours():
    points = np.random.default_rng(4).normal(size=(6, 3))
    curve = splines.catmull_rom(points, True, 500)
    assert np.abs(curve[::500] - points).max() < 1e-12
    slope = (curve[501] - curve[499]) / 2 * 500
    assert slope == pytest.approx((points[2] - points[0]) / 2, abs=0.01)
    # Blender's own formula, in the middle of a segment.
    assert curve[750] == pytest.approx((9 * (points[1] + points[2]) - points[0] - points[3]) / 16)


def test_an_open_catmull_rom_curve_ends_at_its_last_point():
    points = np.random.default_rng(5).normal(size=(4, 3))
    curve = splines.catmull_rom(points, False, 8)
    assert len(curve) == 3 * 8 + 1
    assert np.array_equal(curve[-1], points[-1])
