"""Curves on common vertices: ends that lie on another curve become vertices of it, and places that are one, one vertex.

Vertices of different curves are one vertex if they are closer than a tolerance, and so is a vertex on another curve's
edge, which it then divides. Within one curve only what is exactly so counts. What meets elsewhere crosses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .crossings import close_pairs, crossing_pairs, crossing_place
from .graph import connected
from .predicates import orientation

# Of the size of the domain: ten times the rounding of coordinates that were stored in 32 bits.
TOLERANCE = 1e-6


@dataclass(frozen=True)
class Noded:
    """Curves as edges (e, 2) of common points (p, 2), each edge once.

    point_of: (n,) the point that each of the curves' vertices became; first: (c,) that of each curve's first; edge,
    curve, sign: (t,) which edges each curve runs along, and whether from the edge's first end to its second (1) or back
    (-1).
    """

    points: np.ndarray
    edges: np.ndarray
    point_of: np.ndarray
    first: np.ndarray
    edge: np.ndarray
    curve: np.ndarray
    sign: np.ndarray


@dataclass(frozen=True)
class Crossing:
    """Where two curves (their numbers) cross."""

    curves: tuple[int, int]
    place: tuple[float, float]


def node_curves(curves: Sequence[np.ndarray], closed: Sequence[bool], tolerance: float) -> Noded | Crossing:
    """Put polylines (k, 2), of which some are closed, on common vertices; a point is one of a single vertex.

    tolerance: a length. Gives a Crossing where two of them cross, or run along each other in part of an edge.
    """
    length = np.array([len(curve) for curve in curves])
    points, curve = np.concatenate(curves), np.repeat(np.arange(len(curves)), length)
    first = np.cumsum(length) - length
    end = np.arange(len(points)) + 1
    last = first + length - 1
    end[last] = np.where(closed, first, last)
    start = np.flatnonzero((end != np.arange(len(points))) | (length[curve] == 1))
    end = end[start]
    merged, (segment, share, vertex) = _incidences(points, start, end, curve, tolerance)
    label = connected(len(points), merged)
    used, point_of = np.unique(label, return_inverse=True)
    edge, of = _divided(point_of[start], point_of[end], segment, share, point_of[vertex])
    sign = np.where(edge[:, 0] < edge[:, 1], 1, -1)
    key, number = np.unique(edge.min(axis=1) * len(used) + edge.max(axis=1), return_inverse=True)
    edges = np.stack(np.divmod(key, len(used)), axis=1)
    noded = Noded(points[used], edges, point_of, point_of[first], number, curve[start[of]], sign)
    return _crossing(noded, curve) or noded


def _incidences(points, start, end, curve, tolerance):
    """Pairs (k, 2) of vertices that are one, and vertices on edges: the edge, the share of it before, the vertex."""
    merged = [np.zeros((0, 2), dtype=np.int64)]
    edge, share, vertex = [np.zeros(0, dtype=np.int64)], [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
    for pairs in close_pairs(points[start], points[end], np.zeros(len(start), dtype=np.int64), tolerance):
        one = np.concatenate([pairs[:, 0], pairs[:, 0], pairs[:, 1], pairs[:, 1]])
        v = np.concatenate([start[pairs[:, 1]], end[pairs[:, 1]], start[pairs[:, 0]], end[pairs[:, 0]]])
        apart = (v != start[one]) & (v != end[one])
        one, v = one[apart], v[apart]
        here, a, b = points[v], points[start[one]], points[end[one]]
        along, offset = b - a, here - a
        square = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
        t = np.clip(np.sum(offset * along, axis=1) / square, 0.0, 1.0)
        near = np.hypot(*(offset - t[:, None] * along).T) <= tolerance
        within = np.all((here >= np.minimum(a, b)) & (here <= np.maximum(a, b)), axis=1)
        exactly = within & (orientation(a, b, here) == 0)
        on = np.where(curve[v] == curve[start[one]], exactly, near | exactly)
        for place, at in ((a, start), (b, end)):
            same = on & (curve[v] != curve[start[one]]) & (np.hypot(*(here - place).T) <= tolerance)
            same |= on & np.all(here == place, axis=1)
            merged.append(np.column_stack([v, at[one]])[same])
            on &= ~same
        edge.append(one[on])
        share.append(t[on])
        vertex.append(v[on])
    return np.concatenate(merged), tuple(map(np.concatenate, (edge, share, vertex)))


def _divided(start, end, edge, share, vertex):
    """The edges from start to end (s,), divided at vertices (k,): the parts (e, 2) and the edge of each (e,)."""
    between = (vertex != start[edge]) & (vertex != end[edge])
    _, once = np.unique(np.column_stack([edge, vertex])[between], axis=0, return_index=True)
    edge, share, vertex = (part[between][once] for part in (edge, share, vertex))
    n = np.arange(len(start))
    of = np.concatenate([n, edge, n])
    order = np.lexsort((np.concatenate([np.full(len(n), -1.0), share, np.full(len(n), 2.0)]), of))
    of, stop = of[order], np.concatenate([start, vertex, end])[order]
    part = np.flatnonzero((of[1:] == of[:-1]) & (stop[1:] != stop[:-1]))
    return np.column_stack([stop[part], stop[part + 1]]), of[part]


def _crossing(noded: Noded, curve: np.ndarray) -> Crossing | None:
    """The first place where edges meet that have no vertex there, exactly; curve: (n,) of each of the vertices."""
    alone = np.setdiff1d(np.arange(len(noded.points)), noded.edges)
    ends = np.concatenate([noded.edges, np.column_stack([alone, alone])])
    start, end = noded.points[ends[:, 0]], noded.points[ends[:, 1]]
    pairs = crossing_pairs(start, end, np.zeros(len(ends), dtype=np.int64))
    if not len(pairs):
        return None
    curve_of = np.empty(len(ends), dtype=np.int64)
    curve_of[noded.edge] = noded.curve
    own = np.empty(len(noded.points), dtype=np.int64)
    own[noded.point_of] = curve
    curve_of[len(noded.edges) :] = own[alone]
    one, other = pairs[0]
    return Crossing((int(curve_of[one]), int(curve_of[other])), crossing_place(start, end, pairs[0]))
