"""Splines that touch are taken apart into what can be meshed, and points in one place are found: numpy alone."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.blender.outline import Polyline, make_outline
from addon.blender.touching import apart
from addon.blender.welding import border_edges, same_place, weld
from tests.blender.drawing import SQUARE

SQUARES = np.array(SQUARE)


def outline(*loops):
    polylines = [
        Polyline(np.column_stack([loop, np.zeros(len(loop))]), True, number, number % 3, bool(number % 2))
        for number, loop in enumerate(loops, start=1)
    ]
    return make_outline(polylines, np.eye(3))


def splines(outlines):
    return [part.splines.tolist() for part in outlines]


def test_what_does_not_touch_stays_as_it_is():
    given = outline(SQUARES * 4, SQUARES + 1, SQUARES + 10)
    assert apart(given) == [given]


def test_neighbours_take_turns():
    row = apart(outline(*(SQUARES + (i, 0) for i in range(5))))
    assert splines(row) == [[1, 3, 5], [2, 4]]
    assert [part.materials.tolist() for part in row] == [[1, 0, 2], [2, 1]]
    assert [part.smooth.tolist() for part in row] == [[True, True, True], [False, False]]


def test_an_enclave_that_fills_its_hole():
    assert splines(apart(outline(SQUARES * 3, SQUARES + 1, SQUARES + 1))) == [[1, 2], [3]]
    # In whatever order they were drawn, the first of two alike is the hole.
    assert sorted(splines(apart(outline(SQUARES + 1, SQUARES + 1, SQUARES * 3)))) == [[1, 3], [2]]


def test_an_island_that_touches_its_hole_in_a_point():
    assert splines(apart(outline(SQUARES * 5, SQUARES * 3 + 1, SQUARES + 1))) == [[1, 2], [3]]


def test_a_hole_that_touches_its_contour_stays_with_it_for_the_mesher_to_name():
    assert splines(apart(outline(SQUARES * 3, SQUARES, SQUARES + (3, 0)))) == [[1, 2], [3]]


def test_two_of_the_same_cancel_each_other_and_are_left_to_the_mesher():
    assert splines(apart(outline(SQUARES, SQUARES))) == [[1, 2]]


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 5), st.integers(1, 5), st.floats(1e-3, 1e3), st.randoms(use_true_random=False))
def test_no_two_of_a_chessboard_are_together_if_they_share_a_corner(rows, columns, size, random):
    loops = [(SQUARES + (i, j)) * size for i in range(columns) for j in range(rows)]
    random.shuffle(loops)
    parts = apart(outline(*loops))
    assert sorted(number for part in parts for number in part.splines.tolist()) == list(range(1, len(loops) + 1))
    for part in parts:
        corners = np.concatenate(part.loops)
        assert len(np.unique(np.rint(corners / size), axis=0)) == len(corners)


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
