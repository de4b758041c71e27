"""Contours that cross, united: what they wind around, told by counting windings independently."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import tessera
from tessera.contour import signed_area
from tessera.uncrossed import uncrossed
from tests.library.polygons import circle, seeds
from tests.validity import check_mesh

SQUARE = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
PENTAGRAM = np.array([(np.sin(a), np.cos(a)) for a in np.arange(5) * 4 * np.pi / 5])


def winding(points, loops):
    """How often loops run around points (n, 2) together: their angles, added up."""
    turns = np.zeros(len(points))
    for loop in loops:
        a, b = loop - points[:, None], np.roll(loop, -1, axis=0) - points[:, None]
        turns += np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=-1)).sum(axis=1)
    return np.rint(turns / (2 * np.pi)).astype(int)


@pytest.mark.parametrize(
    ("loops", "areas"),
    [
        ([SQUARE, SQUARE + 1], [7]),
        ([SQUARE[::-1], SQUARE[::-1] + 1], [7]),
        ([SQUARE, SQUARE + [1, 0]], [6]),  # with edges along each other
        ([SQUARE, SQUARE + [2, 0]], [8]),  # beside each other
        ([SQUARE, SQUARE + [2 + 1e-7, 0.5]], [8]),  # all but
        ([PENTAGRAM], [1.1225699414489634]),
        ([SQUARE[[0, 2, 1, 3]]], [1, 1]),  # a bow tie
        ([SQUARE, SQUARE[::-1] + 1], [3, 3]),  # the second takes away from the first
    ],
)
def test_what_is_wound_around_is_united(loops, areas):
    made, of = uncrossed(loops)
    assert sorted(signed_area(loop) for loop in made) == pytest.approx(areas)
    assert len(of) == len(made) and set(of) <= set(range(len(loops)))


def test_what_crosses_nothing_stays_as_it_is():
    loops = [circle(30) * 5, circle(12), SQUARE + 20, SQUARE + 21]
    made, of = uncrossed(loops)
    assert of[:2].tolist() == [0, 1] and len(made) == 3 and of[2] in (2, 3)
    assert all(np.array_equal(a, b) for a, b in zip(made, loops[:2], strict=False))
    alone, of = uncrossed(loops[:3])
    assert of.tolist() == [0, 1, 2] and all(np.array_equal(a, b) for a, b in zip(alone, loops, strict=False))


def test_what_encloses_nothing_stays_as_it_is():
    there_and_back = np.array([[0.0, 0], [2, 0], [1, 0]])
    made, of = uncrossed([there_and_back, SQUARE + 5])
    assert sorted(of.tolist()) == [0, 1] and any(np.array_equal(loop, there_and_back) for loop in made)


@settings(deadline=None, max_examples=30)
@given(seeds, st.integers(1, 3), st.integers(3, 8), st.sampled_from([1.0, 1e-3, 1e4]))
def test_any_scribble_becomes_the_outlines_of_what_it_winds_around(seed, n_loops, n_points, scale):
    rng = np.random.default_rng(seed)
    loops = [scale * np.round(rng.uniform(-1, 1, (n_points, 2)), 2).astype(np.float32) for _ in range(n_loops)]
    made, _ = uncrossed(loops)
    places = scale * rng.uniform(-1, 1, (400, 2))
    inside = winding(places, made) % 2 == 1  # by the even-odd rule, as the mesher takes them
    start, end = np.concatenate(loops), np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    along, offset = end - start, places[:, None] - start
    share = np.clip((offset * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-300), 0, 1)
    clear = np.linalg.norm(offset - share[..., None] * along, axis=-1).min(axis=1) > 1e-4 * scale
    assert np.array_equal(inside[clear], (winding(places, loops) != 0)[clear])


@settings(deadline=None, max_examples=8)
@given(seeds)
def test_it_can_be_meshed(seed):
    rng = np.random.default_rng(seed)
    loops = [circle(20) * rng.uniform(0.5, 1, 2) + rng.uniform(-1, 1, 2) for _ in range(4)]
    made, _ = uncrossed(loops)
    assume(min(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).min() for loop in made) > 1e-3)
    mesh = tessera.mesh(made, 0.2)
    check_mesh(mesh.vertices, mesh.triangles, made, keep=False)
