"""A last pass over finished meshes: an edge is exchanged where that raises the worse quality of its two elements.

The pass ends: a flip takes away an element of some quality and puts in two that are better, so the qualities of a mesh,
from the worst upwards, become larger in lexicographic order, and a mesh has finitely many triangulations. What is left
is valid: both new elements have a positive area only if the two old ones form a strictly convex quadrilateral, and then
cover what they covered. That area needs no exact sign: a quality is off by about 1e-15, whatever the coordinates, and
that of new elements is above that of valid ones by `_GAIN`.
"""

from __future__ import annotations

import numpy as np

from .edges import among
from .quality import element_quality

_GAIN = 1e-6  # in the pair's worse quality: less is not worth a flip, and rounding is far below


def flip_edges(vertices: np.ndarray, triangles: np.ndarray, fixed: np.ndarray | None = None) -> np.ndarray:
    """The same meshes with better elements: (m, 3); boundary edges and fixed ones (f, 2) stay, and so do all vertices.

    vertices: (n, 2) float64; triangles: (m, 3) int, counter-clockwise, of one mesh or of many that share no vertices:
    what is done to one does not depend on the others, and its triangles stay in the places that it has.
    """
    triangles = triangles.copy()
    quality = element_quality(vertices, triangles)
    changed = np.ones(len(triangles), dtype=bool)
    while changed.any():
        # Only an edge of an element that changed can have become worth a flip.
        touched = np.zeros(len(vertices), dtype=bool)
        touched[triangles[changed]] = True
        near = np.flatnonzero(np.count_nonzero(touched[triangles], axis=1) >= 2)
        pairs, better = _quadrilaterals(triangles[near], len(vertices), fixed)
        pairs = near[pairs]
        then = np.stack([element_quality(vertices, better[:, side]) for side in (0, 1)], axis=1)
        gain = then.min(axis=1) - quality[pairs].min(axis=1)
        worth = np.flatnonzero(gain > _GAIN)
        changed = np.zeros(len(triangles), dtype=bool)
        changed[pairs[worth]] = True
        chosen = worth[_independent(pairs[worth], gain[worth], len(triangles))]
        triangles[pairs[chosen]], quality[pairs[chosen]] = better[chosen], then[chosen]
    return triangles


def _quadrilaterals(
    triangles: np.ndarray, n_vertices: int, fixed: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """The pairs of triangles (m, 3) on the two sides of each edge (e, 2), and those after its exchange (e, 2, 3).

    Edges that are fixed (f, 2) are left out.
    """
    start, end = triangles.ravel().astype(np.int64), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(start, end) * n_vertices + np.maximum(start, end)
    order = np.argsort(key)
    twice = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    if fixed is not None:
        first = order[twice]
        twice = twice[~among(np.column_stack([start[first], end[first]]), fixed)]
    sides = np.sort(np.stack([order[twice], order[twice + 1]], axis=1), axis=1)
    pairs, corner = np.divmod(sides, 3)
    left, right = np.moveaxis(triangles[pairs, (corner + 2) % 3], 1, 0)
    u, v = start[sides[:, 0]], end[sides[:, 0]]
    exchanged = np.stack([np.stack([u, right, left], axis=1), np.stack([right, v, left], axis=1)], axis=1)
    return pairs, exchanged


def _independent(pairs: np.ndarray, gain: np.ndarray, n_triangles: int) -> np.ndarray:
    """(e,) bool: the flips of pairs (e, 2) of triangles that gain most among all flips of either triangle."""
    rank = np.empty(len(pairs), dtype=np.int64)
    # Equal gains by the triangles' places, whose order within a mesh is the same in every batch.
    rank[np.lexsort((pairs[:, 1], pairs[:, 0], -gain))] = np.arange(len(pairs))
    first = np.full(n_triangles, len(pairs))
    for side in pairs.T:
        np.minimum.at(first, side, rank)
    return (first[pairs] == rank[:, None]).all(axis=1)
