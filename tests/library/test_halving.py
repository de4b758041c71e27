"""Elements whose edges are all halved: what the networks would choose among, and when they are still asked."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tessera.halving import find_halved, four_elements
from tessera.quality import element_quality

seeds = st.integers(0, 2**32 - 1)
# The connections of a hexagon whose corners 0, 2 and 4 are no elements' middles: the middles joined, or one of those
# three edges flipped.
CONNECTIONS = [
    [[0, 1, 5], [1, 2, 3], [5, 3, 4], [1, 3, 5]],
    [[1, 2, 3], [5, 3, 4], [0, 1, 3], [0, 3, 5]],
    [[0, 1, 5], [5, 3, 4], [1, 2, 5], [2, 3, 5]],
    [[0, 1, 5], [1, 2, 3], [1, 3, 4], [1, 4, 5]],
]


def halved_elements(rng: np.random.Generator, count: int, aside: float) -> tuple[np.ndarray, np.ndarray]:
    """Points, corners first, and the contours (count, 15) of elements with a vertex amid each edge, or beside it."""
    corners = rng.normal(size=(count, 3, 2))
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    corners[u[:, 0] * v[:, 1] < u[:, 1] * v[:, 0]] = corners[u[:, 0] * v[:, 1] < u[:, 1] * v[:, 0]][:, ::-1]
    share = rng.uniform(0.35, 0.65, (count, 3, 1))
    amid = share * corners + (1 - share) * np.roll(corners, -1, axis=1) + aside * rng.normal(size=(count, 3, 2))
    cells = np.full((count, 15), -1)
    cells[:, :6:2] = np.arange(3 * count).reshape(count, 3)
    cells[:, 1:6:2] = 3 * count + cells[:, :6:2]
    return np.concatenate([corners.reshape(-1, 2), amid.reshape(-1, 2)]), cells


@settings(deadline=None, max_examples=20)
@given(seeds, st.sampled_from([0.0, 0.1]))
def test_the_four_elements_are_the_best_by_their_smallest_angle(seed, aside):
    points, cells = halved_elements(np.random.default_rng(seed), 200, aside)
    cells = cells[find_halved(points, cells, 600)]
    assert len(cells) > 5
    angles = [smallest_angle(points, cells[:, np.array(connection)]) for connection in CONNECTIONS]
    assert (angles[0] > np.max(angles[1:], axis=0) - 1e-9).all()
    four = four_elements(cells)
    assert (element_quality(points, four) > 0).all()
    np.testing.assert_array_equal(four.reshape(-1, 4, 3), cells[:, np.array(CONNECTIONS[0])])


def smallest_angle(points: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """(k,) of elements (k, 4, 3) of several connections; below 0 where one is reversed."""
    x = points[elements]
    u, v = np.roll(x, -1, axis=2) - x, np.roll(x, 1, axis=2) - x
    return np.arctan2(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0], (u * v).sum(-1)).min(axis=(1, 2))


def test_others_are_left_to_the_networks():
    equilateral = np.array([[0, 0], [1, 0], [0.5, 0.75**0.5]])
    amid = 0.5 * (equilateral + np.roll(equilateral, -1, axis=0))
    points = np.concatenate([equilateral, amid, [[0.25, 0.0]]])
    rows = [[0, 3, 1, 4, 2, 5], [0, 6, 3, 1, 4, 2], [0, 3, 1, 4, 2, -1], [0, 1, 2, -1, -1, -1]]
    cells = np.pad(np.array(rows), ((0, 0), (0, 9)), constant_values=-1)
    np.testing.assert_array_equal(find_halved(points, cells, 3), [True, False, False, False])
    assert not find_halved(points * [1, 0.3], cells, 3).any()  # obtuse
