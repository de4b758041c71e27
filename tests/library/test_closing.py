"""Contours without inner vertices get the best of all their triangulations."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tessera.cavities import Contours
from tessera.closing import MOST_EDGES, close
from tessera.quality import element_quality
from tessera.triangulation import triangulate
from tests.library.adversaries import sector
from tests.validity import check_many

BY_BRUTE_FORCE = 6  # edges of contours whose triangulations are all tried


def contours(polygons: list[np.ndarray]) -> Contours:
    """Contours without inner vertices, padded."""
    n_contour = np.array([len(polygon) for polygon in polygons])
    points = np.zeros((len(polygons), n_contour.max(), 2))
    for row, polygon in zip(points, polygons, strict=True):
        row[: len(polygon)] = polygon
    slots = np.broadcast_to(np.arange(points.shape[1], dtype=np.int32), points.shape[:2])
    return Contours(points, slots, np.arange(len(points), dtype=np.int32), n_contour, 0 * n_contour)


def all_triangulations(corners: tuple[int, ...]):
    """By brute force: all sets of n - 2 triangles that pass contour edges once and all others there and back."""
    n = len(corners)
    for chosen in combinations(combinations(range(n), 3), n - 2):
        edges = [(a, b) for t in chosen for a, b in zip(t, (*t[1:], t[0]), strict=True)]
        boundary = [edge for edge in edges if edge[::-1] not in edges]
        if len(set(edges)) == len(edges) and sorted(boundary) == sorted((k, (k + 1) % n) for k in range(n)):
            yield np.array(chosen)


def meshed_validly(polygons: list[np.ndarray]) -> list[np.ndarray]:
    """The elements of each polygon, checked."""
    triangles, row, closed = close(contours(polygons))
    assert closed.all()
    elements = [triangles[row == number] for number in range(len(polygons))]
    for polygon, own in zip(polygons, elements, strict=True):
        check_many(polygon[None], np.array([len(polygon)]), np.array([0]), own, np.zeros(len(own), int))
    return elements


def cost(polygon, triangles):
    q = element_quality(polygon, triangles)
    return (q**-4.0).sum() if q.min() > 0 else np.inf


@settings(max_examples=15, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.lists(st.tuples(st.integers(3, BY_BRUTE_FORCE), st.integers(0, 2**32)), min_size=1, max_size=3))
def test_the_best_triangulation_is_found(drawn):
    polygons = [sector(seed, n) for n, seed in drawn]
    for polygon, own in zip(polygons, meshed_validly(polygons), strict=True):
        least = min(cost(polygon, found) for found in all_triangulations(range(len(polygon))))
        assert cost(polygon, own) == pytest.approx(least, rel=1e-6)


@settings(max_examples=30, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.lists(st.tuples(st.integers(3, MOST_EDGES), st.integers(0, 2**32)), min_size=1, max_size=8))
def test_every_small_contour_is_meshed_validly(drawn):
    meshed_validly([sector(seed, n) for n, seed in drawn])


def test_contours_with_inner_vertices_or_more_edges_are_left():
    polygon = sector(0, MOST_EDGES + 1)
    triangles, row, closed = close(contours([polygon, np.array([[0, 0], [1, 0], [0, 1]])]))
    assert closed.tolist() == [False, True] and row.tolist() == [1] and triangles.tolist() == [[0, 1, 2]]


def test_what_is_no_simple_counter_clockwise_polygon_is_told():
    clockwise = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=float)
    bow_tie = np.array([[0, 0], [1, 1], [1, 0], [0, 1]], dtype=float)
    for polygon in (clockwise, bow_tie):
        with pytest.raises(ValueError, match="contour 0"):
            triangulate(polygon[None], np.array([4]), np.array([0]), lambda *rest: np.ones((len(rest[-1]), 2)))
