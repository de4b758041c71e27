"""Contours that cross, as the letters of many fonts have them, to the outlines of what they wind around.

A stroke that is drawn across another belongs to the letter, and so does what both cover: what a contour, or several
together, run around a number of times other than zero (the non-zero rule, by which fonts are filled).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from .budget import total_length
from .contour import edges_of, signed_area
from .crossings import close_pairs, crossing_pairs, gaps
from .faces import find_faces
from .graph import connected, graph_faces
from .noding import TOLERANCE, Noded, node_curves
from .regions import windings

# Rounded crossings bend the edges that they divide a little, which may cross others then.
_MOST_TRIES = 4


def uncrossed(loops: Sequence[ArrayLike]) -> tuple[list[np.ndarray], np.ndarray]:
    """The outlines of loops that cross or touch themselves or each other, and all others as they are.

    loops: (k, 2) float64 each, closed, without repeating the first point, finite. Returns loops, and of each the number
    (l,) int64 of the given one that most of it is of. Where crossings cannot be told apart, or leave
    nothing, their loops stay.
    """
    loops = [np.asarray(loop, dtype=np.float64) for loop in loops]
    start, end = edges_of(loops)
    of = np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
    tolerance = TOLERANCE * float(np.ptp(start, axis=0).max())
    pairs = np.concatenate(
        [crossing_pairs(start, end, np.zeros(len(start), dtype=np.int64)), *_near(start, end, of, tolerance)]
    )
    if not len(pairs):
        return loops, np.arange(len(loops))
    group, meets = connected(len(loops), of[pairs]), np.unique(of[pairs])
    apart = np.setdiff1d(np.arange(len(loops)), meets)
    made, number = [loops[k] for k in apart], [apart]
    for together in (meets[group[meets] == first] for first in np.unique(group[meets])):
        outlines, own = _outlines([loops[k] for k in together], tolerance)
        made += outlines
        number.append(together[own])
    return made, np.concatenate(number)


def _near(start: np.ndarray, end: np.ndarray, of: np.ndarray, tolerance: float) -> Iterator[np.ndarray]:
    """Pairs (k, 2) of edges (n, 2) of different loops (n,) that are as near to each other as to be taken to touch."""
    for pairs in close_pairs(start, end, np.zeros(len(start), dtype=np.int64), tolerance):
        pairs = pairs[of[pairs[:, 0]] != of[pairs[:, 1]]]
        yield pairs[gaps(start, end, pairs)[0] <= tolerance]


def _outlines(loops: list[np.ndarray], tolerance: float) -> tuple[list[np.ndarray], np.ndarray]:
    """`uncrossed`, of loops that all hang together; what is nearer to each other than a tolerance touches."""
    curves = loops
    for _ in range(_MOST_TRIES):
        curves = _divided_at_crossings(curves)
        noded = node_curves(curves, [True] * len(curves), tolerance)
        if isinstance(noded, Noded):
            outlines, number = _around(noded, len(loops), tolerance)
            if len(outlines):
                return outlines, number
            break
    return loops, np.arange(len(loops))


def _divided_at_crossings(curves: list[np.ndarray]) -> list[np.ndarray]:
    """The same with a vertex, common to both edges, where two of them cross inside of both."""
    start, end = edges_of(curves)
    one, other = crossing_pairs(start, end, np.zeros(len(start), dtype=np.int64)).T
    along, across, offset = end[one] - start[one], end[other] - start[other], start[other] - start[one]
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel edges have no crossing of their own
        area = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
        share = (offset[:, 0] * across[:, 1] - offset[:, 1] * across[:, 0]) / area
        of_other = (offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / area
    (inside,) = np.nonzero((share > 0) & (share < 1) & (of_other > 0) & (of_other < 1))
    place = start[one[inside]] + share[inside, None] * along[inside]
    edge = np.concatenate([np.arange(len(start)), one[inside], other[inside]])
    order = np.lexsort((np.concatenate([np.full(len(start), -1.0), share[inside], of_other[inside]]), edge))
    points, edge = np.concatenate([start, place, place])[order], edge[order]
    of = np.repeat(np.arange(len(curves)), [len(curve) for curve in curves])[edge]
    return np.split(points, np.flatnonzero(np.diff(of)) + 1)


def _around(noded: Noded, n_loops: int, tolerance: float) -> tuple[list[np.ndarray], np.ndarray]:
    """The outlines of the faces that are wound around, and the loop of each; none that is thinner than a tolerance."""
    faces = graph_faces(noded.points, noded.edges)
    wound = windings(len(noded.edges), noded.edge, noded.curve, noded.sign, faces, n_loops)
    left, right = np.split(wound.sum(axis=1)[faces.of_half_edge] != 0, 2)
    (bounds,) = np.nonzero(left != right)
    tails, heads = np.where(left, noded.edges.T, noded.edges.T[::-1])[:, bounds]
    walk, size = find_faces(noded.points, tails, heads, np.full(len(tails), -1))
    of = np.empty(len(noded.edges), dtype=np.int64)
    of[noded.edge] = noded.curve
    outlines, number = [], []
    for part in np.split(walk, np.cumsum(size)[:-1]) if len(size) else ():
        points = noded.points[tails[part]]
        if abs(signed_area(points)) > tolerance * total_length([points]):
            outlines.append(points)
            number.append(np.bincount(of[bounds[part]]).argmax())
    return outlines, np.array(number, dtype=np.int64)
