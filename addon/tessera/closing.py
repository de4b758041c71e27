"""Small contours without inner vertices need no table: all their triangulations are looked at, and the best is taken.

The listing closes sub-contours of three edges so (Algorithm 3, lines 28-30). With a few more, there are still so few
triangulations (Catalan's numbers) that this costs less than a table, is never mistaken, and saves most contours a level
or two of the recursion. The best is that of the largest q_worst + q_mean, which is what entries are ordered by, too.

A triangulation of the corners' numbers whose triangles are all counter-clockwise is one of the polygon: how often they
cover a point is the polygon's winding number around it, which is 0 or 1.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np

from .cavities import Contours
from .entries import BITS, quality
from .predicates import orientation

MOST_EDGES = 8


def close(contours: Contours) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elements (t, 3) of the contours that need no table, their rows (t,), and which contours those are (B,) bool.

    A contour without any triangulation, which is no simple counter-clockwise polygon, gets no element.
    """
    closed = (contours.n_inner == 0) & (contours.n_contour <= MOST_EDGES)
    elements, rows = [np.zeros((0, 3), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for n in np.unique(contours.n_contour[closed]):
        row = np.flatnonzero(closed & (contours.n_contour == n))
        best, possible = _best(contours.points[row, :n])
        elements.append(best[possible].reshape(-1, 3))
        rows.append(np.repeat(row[possible], n - 2))
    return np.concatenate(elements), np.concatenate(rows), closed


def _best(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The best triangulations (b, n - 2, 3) of polygons (b, n, 2), and whether they have one (b,)."""
    triples, members = _triangulations(points.shape[1])
    corners = points.swapaxes(0, 1)[triples.T]
    # Polygons are the last axis: sums over the few triangles of each triangulation are then additions of long rows.
    q = quality(*np.ascontiguousarray(corners).view(np.complex128)[..., 0])
    q = np.where(orientation(*corners) > 0, q, -1)
    worst = mean = q[members[0]]
    for number in members[1:]:
        own = q[number]
        worst, mean = np.minimum(worst, own), mean + own
    valid = worst >= 0
    score = np.where(valid, worst + mean / len(members), 0)
    # In whole numbers, so that rounding rarely decides between equals: the first one is theirs. Beside the best one, so
    # that flat triangulations are told apart too.
    size = np.maximum(score.max(axis=0), np.finfo(float).tiny)
    score = np.where(valid, (score / size * 2**BITS).astype(np.int64), -1)
    best = score.argmax(axis=0)
    return triples[members.T[best]], valid.any(axis=0)


@cache
def _triangulations(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of n corners (k, 3), and the triangulations of an n-gon as their numbers (n - 2, c)."""
    triples = list(combinations(range(n), 3))

    def of(corners: tuple[int, ...]) -> list[list[tuple[int, ...]]]:
        """The triangulations of some corners: the vertex that the first edge is connected to, and those of the rest."""
        if len(corners) < 3:
            return [[]]
        first, second, *others = corners
        return [
            [(first, second, third), *left, *right]
            for k, third in enumerate(others, 2)
            for left in of(corners[1 : k + 1])
            for right in of((first, *corners[k:]))
        ]

    return np.array(triples), np.array([sorted(map(triples.index, found)) for found in of(tuple(range(n)))]).T.copy()
