"""The grid that NN2 scores: the candidates are those that a plain test in double precision finds."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tessera.cavity import even_lengths, signed_distances
from tessera.grid import make_grids, steps
from tests.library.polygons import placed, placements, simple_polygons, star


def whole_grid(grids):
    y, x = np.meshgrid(steps(grids.resolution), steps(grids.resolution), indexing="ij")
    points = np.broadcast_to(np.stack([x.ravel(), y.ravel()]), (len(grids.spacing), 2, grids.resolution**2))
    return np.swapaxes(grids.places(points), 1, 2)


@settings(max_examples=30, deadline=None)
@given(simple_polygons, placements, st.sampled_from([6, 12, 20, 48]))
@example(star(12, 0.9), (1.0, 0.0, 0.0), 6)  # rows of the grid run through vertices
def test_admissible_points_are_inside_and_clear_of_the_contour(polygon, placement, resolution):
    contour = placed(polygon, placement)[None]
    n = np.array([contour.shape[1]])
    margin = 0.2 * even_lengths(contour, n, np.array([5]))
    grids = make_grids(contour, n, margin, resolution)
    points = whole_grid(grids)
    away = signed_distances(points, contour, n)
    expected = away > margin[:, None]
    doubtful = np.abs(away - margin[:, None]) < 1e-3 * grids.spacing[:, None]
    assert ((expected == grids.admissible) | doubtful).all()


def test_a_contour_has_the_same_candidates_among_others():
    rng = np.random.default_rng(3)
    counts = rng.integers(3, 17, 40)
    contour = np.full((40, 16, 2), 7.0)
    for row, n in enumerate(counts):
        angle = 2 * np.pi * (np.arange(n) + rng.random(n)) / n
        contour[row, :n] = rng.uniform(0.3, 1, (n, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    margin = np.full(40, 0.05)
    together = make_grids(contour, counts, margin, 16).admissible
    for row, n in enumerate(counts):
        alone = make_grids(contour[row : row + 1, :n], counts[row : row + 1], margin[:1], 16).admissible
        assert (alone[0] == together[row]).all()


def test_no_contours():
    grids = make_grids(np.zeros((0, 5, 2)), np.zeros(0, dtype=np.int64), np.zeros(0), 8)
    assert grids.admissible.shape == (0, 64)
