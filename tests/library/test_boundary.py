from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tessera.boundary import resample, resample_loops
from tessera.contour import nesting, signed_area
from tessera.predicates import segments_cross
from tests.library.polygons import LETTER_E, circle, letter_s, placed, placements, seeds, simple_polygons, spiral
from tests.validity import on_the_loops, polygon_is_simple


def edge_lengths(loop):
    return np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)


@given(simple_polygons, st.sampled_from([10.0, 1.0, 0.3, 0.05]), placements)
@settings(deadline=None, max_examples=60)
def test_stays_on_the_contour_simple_and_counter_clockwise(polygon, edge_length, placement):
    polygon = placed(polygon, placement)
    result = resample(polygon, edge_length * placement[0])
    assert len(result) >= 3 and signed_area(result) > 0 and polygon_is_simple(result)
    on_the_loops(result, [polygon])


@given(simple_polygons, st.sampled_from([1.0, 0.2]))
@settings(deadline=None)
def test_keeps_corners_exactly_that_are_not_all_but_one(polygon, edge_length):
    assume(np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1).min() > 0.05 * edge_length)
    came, goes = polygon - np.roll(polygon, 1, axis=0), np.roll(polygon, -1, axis=0) - polygon
    cosine = np.sum(came * goes, axis=1) / np.linalg.norm(came, axis=1) / np.linalg.norm(goes, axis=1)
    corners = {tuple(p) for p in polygon[cosine < np.cos(np.radians(33))]}
    assert corners <= {tuple(p) for p in resample(polygon, edge_length)}


def test_of_corners_that_are_all_but_one_one_stays():
    """As the hundredth of an edge by which some fonts step aside."""
    step = np.array([[0, 0], [1, 0], [1, 0.5], [0.998, 0.502], [0.998, 1], [0, 1]])
    result = resample(step, 0.1)
    assert edge_lengths(result).min() > 0.09
    assert edge_lengths(resample(step, 0.02)).min() < 0.003  # there it is a tenth of an edge


@pytest.mark.parametrize("edge_length", [0.02, 0.026, 0.04])
def test_loops_that_lie_well_inside_each_other_need_no_vertices_more(edge_length):
    """Whatever rounding makes of a loop's own corners, which lie on itself and not in it."""
    angle = np.linspace(0, 1.7 * np.pi, 60)
    # Like an e, its leftmost corner is inside of its own bounding box.
    outer = np.concatenate([[(-0.3, 0)], np.column_stack([np.cos(angle), np.sin(angle)])])
    for shift in np.linspace(-1, 1, 41):
        loops = [(0.2 * loop + [0.1, shift]).astype(np.float32).astype(float) for loop in (outer, circle(25) * 0.2)]
        loops[1] += [0, 0.1]
        together = resample_loops(loops, edge_length, np.zeros(2, dtype=int))
        for loop, alone in zip(together, (resample(loop, edge_length) for loop in loops), strict=True):
            np.testing.assert_array_equal(loop, alone)


@pytest.mark.parametrize("n", [12, 13, 60, 5000])
def test_a_circle_has_no_corners_and_even_spacing(n):
    result = resample(circle(n), 0.7)
    assert len(result) == 9
    assert np.ptp(edge_lengths(result)) < 0.05


def test_arcs_between_corners_have_the_nearest_number_of_edges():
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    assert len(resample(square, 0.1)) == 40
    assert edge_lengths(resample(square, 0.1)) == pytest.approx(np.full(40, 0.1))
    assert len(resample(square, 0.28)) == 16
    assert resample(square, 5.0).tolist() == square.tolist()
    subdivided = resample(square, 0.01)
    assert resample(subdivided, 0.1) == pytest.approx(resample(square, 0.1))


@given(st.integers(0, 99))
@settings(deadline=None, max_examples=20)
def test_does_not_depend_on_where_the_list_starts(shift):
    for polygon in (circle(100), letter_s(), LETTER_E):
        expected = resample(polygon, 0.3)
        got = resample(np.roll(polygon, shift, axis=0), 0.3)
        assert got[np.lexsort(got.T)] == pytest.approx(expected[np.lexsort(expected.T)], abs=1e-12)


@given(seeds)
@settings(deadline=None, max_examples=20)
def test_loops_of_one_domain_stay_apart_and_batches_do_not_matter(seed):
    rng = np.random.default_rng(seed)
    ring = spiral(80, turns=0.9, width=0.5)
    loops = [ring, ring * 0.6, ring * 0.3, circle(50) * 0.1]
    sizes = rng.choice([0.1, 0.7, 2.0], size=4)
    apart = resample_loops(loops, sizes)
    for loop, size, got in zip(loops, sizes, apart, strict=True):
        assert np.array_equal(resample(loop, size), got)
    turned = [np.array([[np.cos(i), np.sin(i)], [-np.sin(i), np.cos(i)]]) * 0.999**i for i in range(4)]
    together = resample_loops([circle(400) @ turn for turn in turned], 0.5, domain=np.zeros(4, dtype=int))
    for first, second in combinations(together, 2):
        a, b, c, d = first, np.roll(first, -1, axis=0), second, np.roll(second, -1, axis=0)
        assert not segments_cross(a[:, None], b[:, None], c, d).any()


def bump(height: float) -> np.ndarray:
    """A circle that bulges, in or out, between two of the vertices that a coarse resampling takes; no corners."""
    angle = np.arange(2000) * 2 * np.pi / 2000
    radius = 1 + height * np.exp(-((angle - 2) ** 2) / 0.01)
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@pytest.mark.parametrize("edge_length", [0.2, 0.4, 0.8, 1.5])
@pytest.mark.parametrize(("height", "at"), [(0.25, 1.17), (-0.3, 0.85)])
def test_a_hole_stays_inside_and_an_island_outside(height, at, edge_length):
    small = circle(12) * 0.02 + [at * np.cos(2), at * np.sin(2)]
    for loops in ([bump(height), small], [small, bump(height)]):
        before, after = nesting(loops), nesting(resample_loops(loops, edge_length, np.zeros(2, dtype=int)))
        assert before.holes.tolist() == after.holes.tolist() and len(before.holes) == (height > 0)
