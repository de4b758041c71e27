"""Small contours without inner vertices need no table: the best of all their triangulations is taken.

The listing closes sub-contours of three edges so (Algorithm 3, lines 28-30). With a few more, the best triangulation is
found by dynamic programming: between vertices i and j it is, for some vertex k between them, the triangle (i, k, j) and
the best between i and k, and k and j. This costs less than a table, is never mistaken, and saves most contours a level
or two of the recursion; with more edges than eight it costs as much. The best is that of the smallest sum of q⁻⁴, as
poor elements count most.

A triangulation of the corners' numbers whose triangles are all counter-clockwise is one of the polygon: how often they
cover a point is the polygon's winding number around it, which is 0 or 1.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np

from .cavities import Contours
from .entries import quality
from .predicates import orientation

MOST_EDGES = 8
_FLATTEST = 1e-70  # quality of elements that have an area, but none in floating point
_TIE = 1 + 1e-9  # what costs no more than the least by this factor is a tie, so that rounding rarely decides
_TOGETHER = 256  # contours at a time, so that what is known of all their triangles stays in the processor's cache


def close(contours: Contours) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elements (t, 3) of the contours that need no table, their rows (t,), and which contours those are (B,) bool.

    A contour without any triangulation, which is no simple counter-clockwise polygon, gets no element.
    """
    closed = (contours.n_inner == 0) & (contours.n_contour <= MOST_EDGES)
    elements, rows = [np.zeros((0, 3), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for n in np.unique(contours.n_contour[closed]):
        chosen = np.flatnonzero(closed & (contours.n_contour == n))
        for part in np.array_split(chosen, -(-len(chosen) // _TOGETHER)):
            own, row = _best(contours.points[part, :n])
            elements.append(own)
            rows.append(part[row])
    return np.concatenate(elements), np.concatenate(rows), closed


def _best(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The elements (t, 3) of the best triangulations of polygons (b, n, 2), if they have one, and their rows (t,)."""
    n = points.shape[1]
    triples, spans = _spans(n)
    corners = points.swapaxes(0, 1)[triples.T]
    q = quality(*np.ascontiguousarray(corners).view(np.complex128)[..., 0])
    cost = np.maximum(q, _FLATTEST) ** -2
    cost = np.where(orientation(*corners) > 0, cost * cost, np.inf)
    # From vertex i to vertex j is row n i + j; polygons are the last axis.
    least, choice = np.zeros((n * n, len(points))), np.zeros((n * n, len(points)), dtype=np.int64)
    for own, triangle, before, after in spans:
        sums = cost[triangle] + least[before] + least[after]
        least[own] = sums.min(axis=0)
        choice[own] = (sums <= least[own] * _TIE).argmax(axis=0)
    open_spans = np.zeros(least.shape, dtype=bool)
    open_spans[n - 1] = np.isfinite(least[n - 1])
    elements, rows = [], []
    for own, *_ in spans[::-1]:
        number, row = np.nonzero(open_spans[own])
        i, j = np.divmod(own[number], n)
        k = i + 1 + choice[own[number], row]
        open_spans[n * i + k, row] = open_spans[n * k + j, row] = True
        elements.append(np.stack([i, k, j], axis=1))
        rows.append(row)
    return np.concatenate(elements), np.concatenate(rows)


@cache
def _spans(n: int) -> tuple[np.ndarray, list[tuple[np.ndarray, ...]]]:
    """Triangles of n corners (k, 3), and the spans between two vertices of an n-gon, shorter ones first.

    Of each length l: the spans' rows (n - l,), and for every vertex between (l - 1, n - l) the number of the triangle,
    and the rows of the spans before and after it.
    """
    triples = np.array(list(combinations(range(n), 3)))
    number = np.zeros((n, n, n), dtype=np.int64)
    number[tuple(triples.T)] = np.arange(len(triples))
    spans = []
    for length in range(2, n):
        i, split = np.arange(n - length), np.arange(1, length)[:, None]
        k, j = i + split, i + length
        spans.append((n * i + j, number[i, k, j], n * i + k, n * k + j))
    return triples, spans
