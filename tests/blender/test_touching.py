"""Splines that touch become one mesh: common vertices along what they share, and none anywhere twice."""

import bpy
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.blender.welding import border_edges, same_place, weld
from tests.blender.drawing import SQUARE, border, distance_to, poly_curve, triangles, vertices

SQUARES = np.array(SQUARE)


def box(low, high, radius=0.0):
    """A rectangle's loop, its corners rounded."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    if not radius:
        return low + SQUARES * (high - low)
    turns = np.radians(np.arange(0, 91, 15))
    arcs = []
    for quarter, corner in enumerate([high, (low[0], high[1]), low, (high[0], low[1])]):
        angle = turns + quarter * np.pi / 2
        arc = np.column_stack([np.cos(angle), np.sin(angle)])
        arcs.append(corner + radius * (arc - np.sign(arc[3])))
    return np.concatenate(arcs)


# Beside a side from (0, 0) to (0, 2): where another's side begins and ends.
BESIDE = {
    "whole": (0, 2),
    "T": (0.6, 1.3),
    "flush": (0, 0.9),
    "part": (1.2, 2.7),
    "more": (-0.5, 2.5),
    "corner": (2, 3),
}


@st.composite
def touching(draw):
    """Two or three loops, and the segments that they share (k, 2, 2)."""
    radius = draw(st.sampled_from([0.0, 0.1]))
    kinds = [kind for kind in BESIDE if not (radius and kind == "corner")]
    loops, shared = [box((0, 0), (1.5, 2), radius)], []

    def attach(x, width, low, high):
        loops.append(box((min(x, x + width), low), (max(x, x + width), high), radius))
        if low < 2:  # else in a corner
            shared.append([(x, max(0, low) + radius), (x, min(2, high) - radius)])

    if draw(st.booleans()):  # two beside one side, and beside each other
        at = draw(st.sampled_from([0.5, 0.7, 1.1]))
        attach(1.5, 1.0, draw(st.sampled_from([0.0, -0.4, 0.2])), at)
        attach(1.5, draw(st.sampled_from([1.0, 0.6, 1.4])), at, 1.9)
        width = min(np.ptp(loops[1][:, 0]), np.ptp(loops[2][:, 0]))
        shared.append([(1.5 + radius, at), (1.5 + width - radius, at)])
    else:
        attach(1.5, 1.0, *BESIDE[draw(st.sampled_from(kinds))])
        if draw(st.booleans()):
            attach(0, -0.8, *BESIDE[draw(st.sampled_from(kinds))])
    order = draw(st.permutations(range(len(loops))))
    return [loops[i] for i in order], np.array(shared, dtype=float).reshape(-1, 2, 2), radius


def euler(tris):
    """Vertices, less edges, plus triangles: 1 for what hangs together and has no hole."""
    sides = np.sort(np.concatenate([tris[:, [0, 1]], tris[:, [1, 2]], tris[:, [2, 0]]]), axis=1)
    return len(np.unique(tris)) - len(np.unique(sides, axis=0)) + len(tris)


@settings(max_examples=50, deadline=None)
@given(touching(), st.sampled_from([1e-3, 1.0, 25.4, 1e3]), st.floats(0, 360), st.sampled_from(["KEEP", "RESAMPLE"]))
def test_what_touches_is_one_mesh_without_a_crack(drawn, unit, degrees, boundary):
    loops, shared, radius = drawn
    angle = np.radians(degrees)
    turn = unit * np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    curve = poly_curve(*(loop @ turn for loop in loops))
    for number, spline in enumerate(curve.data.splines):
        curve.data.materials.append(bpy.data.materials.new(f"Part {number}"))
        spline.material_index = number
    assert bpy.ops.tessera.mesh_curve(edge_length=0.15 * unit, boundary=boundary) == {"FINISHED"}
    made = bpy.context.object
    points, tris = vertices(made)[:, :2] / unit, triangles(made)
    far = np.linalg.norm(points[:, None] - points, axis=2) + np.eye(len(points))
    assert far.min() > 1e-3
    # With rounded corners, three that meet around a T leave a gap there.
    assert euler(tris) == (0 if radius and len(shared) == len(loops) else 1)
    middle = points[border(tris)].mean(axis=1)
    for segment in shared @ turn / unit:
        assert distance_to(segment, middle).min() > 5e-3
    material = np.array([polygon.material_index for polygon in made.data.polygons])
    across = np.linalg.det(np.diff(points[tris], axis=1)) / 2
    rounding = 0.1 if radius and boundary == "RESAMPLE" else 1e-4
    for number, loop in enumerate(loops):
        area = 0.5 * abs(np.sum(loop[:, 0] * np.roll(loop[:, 1], -1) - loop[:, 1] * np.roll(loop[:, 0], -1)))
        assert across[material == number].sum() == pytest.approx(area, rel=rounding)
    bpy.data.batch_remove([made, curve])


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0)])
def test_an_enclave_that_fills_its_hole_has_its_own_material(order):
    loops = [SQUARES * 3, SQUARES + 1, SQUARES + 1]
    curve = poly_curve(*(loops[i] for i in order))
    inner = [number for number, i in enumerate(order) if i]
    for number, spline in enumerate(curve.data.splines):
        curve.data.materials.append(bpy.data.materials.new(f"Part {number}"))
        spline.material_index = number
    assert bpy.ops.tessera.mesh_curve(edge_length=0.4) == {"FINISHED"}
    made = bpy.context.object
    found = {polygon.material_index for polygon in made.data.polygons}
    # Of two alike, the first is the hole.
    assert found == {order.index(0), max(inner)}
    assert euler(triangles(made)) == 1


@pytest.mark.parametrize("count", [300, 1500])
def test_a_wanted_number_of_triangles_is_met_where_splines_touch(count):
    poly_curve(SQUARES * 2, SQUARES + (2, 0.5), SQUARES + (2, 1.5))
    assert bpy.ops.tessera.mesh_curve(size_by="TRIANGLE_COUNT", triangle_count=count) == {"FINISHED"}
    assert abs(len(bpy.context.object.data.polygons) / count - 1) <= 0.1
    assert euler(triangles(bpy.context.object)) == 1


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 40), st.sampled_from([1, 2, 3]), st.integers(0, 2**31))
def test_close_points_are_in_one_place_and_far_ones_are_not(count, dimensions, seed):
    generator = np.random.default_rng(seed)
    centres = generator.integers(-20, 20, size=(count, dimensions)).astype(float)
    copies = np.repeat(centres, 3, axis=0) + generator.uniform(-0.5e-3, 0.5e-3, size=(3 * count, dimensions))
    label = same_place(copies, 1e-3)
    same = (np.repeat(centres, 3, axis=0)[:, None] == np.repeat(centres, 3, axis=0)).all(axis=2)
    assert np.array_equal(label[:, None] == label, same)
    assert (label <= np.arange(len(label))).all() and np.array_equal(label[label], label)


def test_no_border_of_the_search_parts_two_that_are_close():
    for offset in np.linspace(-4.1, 4.1, 83):
        points = np.array([(offset, -offset), (offset + 0.99, -offset - 0.99)])
        assert same_place(points, 1.0).tolist() == [0, 0]


def test_welded_triangles_share_their_edge():
    triangles = np.array([(0, 1, 2), (3, 4, 5)])
    assert len(border_edges(triangles)) == 6
    kept, welded = weld(triangles, np.array([0, 1, 2, 1, 0, 5]))
    assert kept.tolist() == [0, 1, 2, 5] and welded.tolist() == [[0, 1, 2], [1, 0, 3]]
    assert sorted(map(tuple, border_edges(welded).tolist())) == [(0, 3), (1, 2), (2, 0), (3, 1)]
