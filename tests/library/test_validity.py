"""The checker accepts good meshes and names each way to be wrong."""

import numpy as np
import pytest

from tests.validity import check_many, check_mesh, polygon_is_simple

SQUARE = np.array([[0, 0], [2, 0], [2, 2], [0, 2]], dtype=float)
VERTICES = np.vstack([SQUARE, [[1, 1]]])
FAN = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])


def test_accepts_a_valid_mesh_of_either_winding():
    check_mesh(VERTICES, FAN, [SQUARE])
    check_mesh(VERTICES, FAN, [SQUARE[::-1]])
    check_mesh(VERTICES, FAN, [SQUARE], keep=False)


def test_accepts_a_hole_and_two_pieces():
    inner = 0.5 + SQUARE / 2
    vertices = np.vstack([SQUARE, inner])
    ring = [[i, (i + 1) % 4, 4 + (i + 1) % 4] for i in range(4)] + [[i, 4 + (i + 1) % 4, 4 + i] for i in range(4)]
    check_mesh(vertices, np.array(ring), [SQUARE, inner])
    check_mesh(np.vstack([VERTICES, VERTICES + 5]), np.vstack([FAN, FAN + 5]), [SQUARE, SQUARE + 5])


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (VERTICES, FAN[:3], "not the contour's edges"),
        (VERTICES, FAN[:, ::-1], "inverted"),
        (VERTICES, np.vstack([FAN, FAN[:1]]), "same direction"),
        (np.vstack([VERTICES, [[3, 3]]]), FAN, "no triangle uses"),
        (np.vstack([SQUARE, [[2, 1]]]), FAN, "inverted or empty"),
        (np.vstack([SQUARE, [[3, 1]]]), FAN, "inverted"),
        (np.vstack([SQUARE + 1e-3, [[1, 1]]]), FAN, "not the contour's edges"),
    ],
)
def test_refuses(vertices, triangles, message):
    with pytest.raises(AssertionError, match=message):
        check_mesh(vertices, triangles, [SQUARE])


def test_a_resampled_boundary_must_lie_on_the_contour():
    with pytest.raises(AssertionError, match="not on the contour"):
        check_mesh(VERTICES * 0.9, FAN, [SQUARE], keep=False)


def test_batches():
    points = np.stack([VERTICES, np.vstack([SQUARE[:3], SQUARE[:2]])])
    contour, inner = np.array([4, 3]), np.array([1, 0])
    triangles, owner = np.vstack([FAN, [[0, 1, 2]]]), np.array([0, 0, 0, 0, 1])
    check_many(points, contour, inner, triangles, owner)
    for keep in (slice(1, None), slice(0, 4)):
        with pytest.raises(AssertionError):
            check_many(points, contour, inner, triangles[keep], owner[keep])
    with pytest.raises(AssertionError, match="inverted"):
        check_many(points * [1, -1], contour, inner, triangles, owner)


def test_polygon_is_simple():
    assert polygon_is_simple(SQUARE)
    assert not polygon_is_simple(SQUARE[[0, 2, 1, 3]])
    assert not polygon_is_simple(np.array([[0, 0], [2, 0], [1, 0], [1, 1]], dtype=float))  # folds back
    assert not polygon_is_simple(np.array([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], dtype=float))  # touches an edge
    assert polygon_is_simple(np.array([[0, 0], [1, 0], [2, 0], [1, 1]], dtype=float))  # collinear
