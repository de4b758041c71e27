"""The flip pass: valid, never worse, done when it ends, the same in every batch."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import tessera
from tessera.flips import flip_edges
from tessera.quality import element_quality
from tessera.triangulation import triangulate
from tests.library.adversaries import TABLES, members, padded, tables
from tests.library.polygons import LETTER_E
from tests.validity import check_many, check_mesh

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def triangulated(batch, table):
    """A batch of meshes, mostly bad ones: points, n_contour, n_inner, triangles in slots, their owners."""
    points, n_contour, n_inner = padded(batch)
    result = triangulate(points, n_contour, n_inner, TABLES[table])
    return points, n_contour, n_inner, result.triangles, result.owner


def flipped(points, triangles, owner):
    first = owner[:, None] * points.shape[1]
    return flip_edges(points.reshape(-1, 2), triangles + first) - first


def ascending(points, triangles):
    return np.sort(element_quality(points, triangles))


def best_gain(points: np.ndarray, triangles: np.ndarray) -> float:
    """The most that one flip would raise the worse quality of two elements by, edge by edge."""
    opposite = {(t[k], t[(k + 1) % 3]): t[(k + 2) % 3] for t in triangles.tolist() for k in range(3)}
    gains = [0.0]
    for (u, v), left in opposite.items():
        right = opposite.get((v, u))
        if right is not None:
            now = element_quality(points, np.array([[u, v, left], [v, u, right]])).min()
            gains.append(element_quality(points, np.array([[u, right, left], [right, v, left]])).min() - now)
    return max(gains)


@settings(max_examples=40, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.lists(members, min_size=1, max_size=10), tables)
def test_flips_leave_valid_and_better_meshes(batch, table):
    points, n_contour, n_inner, triangles, owner = triangulated(batch, table)
    after = flipped(points, triangles, owner)
    check_many(points, n_contour, n_inner, after, owner)
    for row in range(len(batch)):
        old, new = (ascending(points[row], elements[owner == row]) for elements in (triangles, after))
        different = np.flatnonzero(np.abs(old - new) > 1e-9)
        assert not len(different) or new[different[0]] > old[different[0]]
        assert best_gain(points[row], after[owner == row]) < 1e-5
        alone = flipped(points[[row]], triangles[owner == row], np.zeros((owner == row).sum(), int))
        assert np.array_equal(alone, after[owner == row])


def test_the_shorter_diagonal_is_taken():
    rhombus = np.array([[0, 0], [2, -1], [4, 0], [2, 1]], dtype=float)
    result = flip_edges(rhombus, np.array([[0, 1, 2], [0, 2, 3]]))
    assert {frozenset(t) for t in result.tolist()} == {frozenset((0, 1, 3)), frozenset((1, 2, 3))}


@pytest.mark.parametrize("corner", [[0.5, 0.5], [0.7, 0.7]])  # a straight angle, and one that bends inwards
def test_quadrilaterals_that_are_not_strictly_convex_stay(corner):
    points, triangles = np.array([[0, 0], [1, 0], corner, [0, 1]]), np.array([[0, 1, 2], [0, 2, 3]])
    assert np.array_equal(flip_edges(points, triangles[:, [1, 2, 0]]), triangles[:, [1, 2, 0]])


def test_equal_diagonals_stay():
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    assert np.array_equal(flip_edges(np.array(SQUARE, dtype=float), triangles), triangles)


def test_no_triangles():
    assert flip_edges(np.zeros((4, 2)), np.zeros((0, 3), dtype=np.int32)).shape == (0, 3)


def test_public_functions_take_the_option():
    plain, better = (tessera.mesh([LETTER_E], 0.31, flips=flips) for flips in (False, True))
    check_mesh(better.vertices, better.triangles, [LETTER_E], keep=False)
    assert np.array_equal(plain.vertices, better.vertices)
    assert np.array_equal(flip_edges(plain.vertices, plain.triangles), better.triangles)
    (many,) = tessera.mesh_many([[LETTER_E]], 0.31, flips=True)
    assert np.array_equal(many.triangles, better.triangles)
    one = tessera.mesh_contour(SQUARE, 0.3, flips=True)
    check_mesh(one.vertices, one.triangles, [np.array(SQUARE, dtype=float)])
    assert "flips" in one.report.seconds and "flips" in better.report.seconds and "flips" not in plain.report.seconds
