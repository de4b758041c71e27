"""Measures of cavities against slow readings of them: angles for what is inside, each edge for distances."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from tessera.cavity import areas, is_inside, next_vertices, signed_distances
from tests.library.polygons import placed, placements, simple_polygons


def winding(point, contour):
    """How often a contour goes around a point, by the angles that it sees its edges under."""
    z = (contour - point) @ [1, 1j]
    return round(np.angle(np.roll(z, -1) / z).sum() / (2 * np.pi))


def distance(point, contour):
    """To the closest of many points on each edge."""
    step = np.linspace(0, 1, 2001)[:, None]
    return min(
        np.linalg.norm(a + step * (b - a) - point, axis=1).min()
        for a, b in zip(contour, np.roll(contour, -1, axis=0), strict=True)
    )


@settings(max_examples=25, deadline=None)
@given(st.lists(simple_polygons, min_size=1, max_size=3), placements, st.integers(0, 10**6))
def test_distances_and_sides(polygons, placement, seed):
    contours = [placed(polygon, placement) for polygon in polygons]
    n_contour = np.array([len(contour) for contour in contours])
    padded = np.full((len(contours), n_contour.max(), 2), contours[0][0])
    for row, contour in enumerate(contours):
        padded[row, : len(contour)] = contour
    low, high = padded.min(axis=1, keepdims=True), padded.max(axis=1, keepdims=True)
    points = low + (high - low) * np.random.default_rng(seed).uniform(-0.2, 1.2, (len(contours), 9, 2))
    found, inside = signed_distances(points, padded, n_contour), is_inside(points, padded, n_contour)
    for row, contour in enumerate(contours):
        extent = np.ptp(contour, axis=0).max()
        assert np.array_equal(next_vertices(padded, n_contour)[row, : len(contour)], np.roll(contour, -1, axis=0))
        assert areas(padded, n_contour)[row] > 0
        for point, own, within in zip(points[row], found[row], inside[row], strict=True):
            away = distance(point, contour)
            assert abs(abs(own) - away) < 2e-3 * extent
            if away > 1e-6 * extent:
                assert within == (own > 0) == (winding(point, contour) == 1)
