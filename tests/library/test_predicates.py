"""Predicates against rational arithmetic."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tessera.predicates import orientation, segments_cross

small = st.integers(-3, 3).map(float)
point = st.tuples(small, small)


def exact_sign(a, b, c) -> int:
    (ax, ay), (bx, by), (cx, cy) = (tuple(map(Fraction, map(float, p))) for p in (a, b, c))
    determinant = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (determinant > 0) - (determinant < 0)


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-6, 1.0, 1e6]), st.sampled_from([0.0, 1.0, 1e6]))
def test_nearly_collinear_points_have_the_exact_sign(seed, scale, offset):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 30, 2)) * scale + offset
    c = a + rng.normal(size=(30, 1)) * (b - a)
    c += rng.integers(-2, 3, size=(30, 2)) * np.spacing(c)
    assert orientation(a, b, c).tolist() == [exact_sign(*p) for p in zip(a, b, c, strict=True)]


def test_every_stage_of_orientation_is_exact():
    # Collinear by exact differences, by inexact ones, bent by the last bits, and by less than the smallest product.
    line = np.array([[0.0, 0.0], [3.0, 1.0], [1.5, 0.5]])
    tiny = np.array([[0.375, 0.375], [-0.625, -0.375], [-0.125, -5e-324]])
    bent = np.array([[0.1, 0.1], [0.7, 0.7], [0.3, 0.3]])
    far = np.array([[0.0, 1e-200], [1.0, 1e-200], [3e-300, 0.0]])
    moved = bent + [[0, 0], [0, 0], [0, 5.6e-17]]
    triangles = np.array([line, line / 3, line * 1e6 + 0.1, tiny, bent, moved, far, line * 1e-160])
    triangles = np.concatenate([triangles, triangles[:, ::-1], triangles[:, [1, 2, 0]]])
    assert orientation(*triangles.transpose(1, 0, 2)).tolist() == [exact_sign(*corners) for corners in triangles]


def test_orientation_broadcasts_and_handles_tiny_and_axis_parallel_points():
    grid = np.array([[0, 0], [1, 0], [2, 0], [0, 1]], dtype=float)
    assert orientation(grid[0], grid[1], grid).tolist() == [0, 0, 0, 1]
    assert orientation(grid[0] * 1e-160, grid[1] * 1e-160, grid * 1e-160).tolist() == [0, 0, 0, 1]
    assert orientation(grid[:, None], grid[None], grid[3]).shape == (4, 4)


def on_segment(p, a, b) -> bool:
    return exact_sign(a, b, p) == 0 and all(min(u, v) <= w <= max(u, v) for u, v, w in zip(a, b, p, strict=True))


def cross_by_definition(a, b, c, d) -> bool:
    """Solve for the common points with fractions, and drop a shared end."""
    if exact_sign(a, b, c) * exact_sign(a, b, d) < 0 and exact_sign(c, d, a) * exact_sign(c, d, b) < 0:
        return True
    touching = {p for p in (c, d) if on_segment(p, a, b)} | {p for p in (a, b) if on_segment(p, c, d)}
    return bool(touching - ({a, b} & {c, d})) or len(touching) > 1


@given(point, point, point, point)
def test_segments_cross_agrees_with_its_definition(a, b, c, d):
    if a != b and c != d:
        got = segments_cross(*(np.array(p) for p in (a, b, c, d)))
        assert bool(got) == cross_by_definition(a, b, c, d)


def test_segments_cross_takes_arrays():
    a, b = np.array([[0.0, 0], [0, 0]]), np.array([[2.0, 0], [2, 0]])
    c, d = np.array([[1.0, 0], [2, 0]]), np.array([[1.0, 1], [2, 1]])
    assert segments_cross(a, b, c, d).tolist() == [True, False]
