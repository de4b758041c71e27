"""Sizing functions: the edge length that is wanted at a point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# How fast the wanted length may fall off beside an edge that is longer than the target, in length per length.
GRADATION = 0.5
LONG = 1.5  # times the target edge length, from which an edge is longer than it could be
_BLOCK = 1 << 22  # distances held at a time


def grade_from_edges(
    polygons: list[np.ndarray], owner: np.ndarray, edge_length: float
) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """The target edge length everywhere, but larger beside boundary edges that are longer and may not be split.

    polygons: (k, 2) arrays, as they will be in the mesh; owner: the number of the mesh that each bounds. A mesh knows
    nothing of the others' edges, wherever they are. Without long edges the function is constant.
    """
    starts = np.concatenate(polygons)
    ends = np.concatenate([np.roll(polygon, -1, axis=0) for polygon in polygons])
    lengths = np.linalg.norm(ends - starts, axis=1)
    of = np.repeat(owner, [len(polygon) for polygon in polygons])
    long = np.flatnonzero(lengths > LONG * edge_length)
    long = long[np.argsort(of[long], kind="stable")]
    starts, edges, lengths = starts[long], (ends - starts)[long], lengths[long]
    owners, first, count = np.unique(of[long], return_index=True, return_counts=True)

    def sizing(points: np.ndarray, owner: np.ndarray) -> np.ndarray:
        """(k, 2) points of meshes (k,) -> (k,) wanted edge lengths."""
        wanted = np.full(len(points), float(edge_length))
        order = np.argsort(owner, kind="stable")
        begin, end = (np.searchsorted(owner[order], owners, side=side) for side in ("left", "right"))
        for i, j, b, n in zip(begin, end, first, count, strict=True):
            here, long = order[i:j], slice(b, b + n)
            wanted[here] = _beside(points[here], starts[long], edges[long], lengths[long], wanted[here])
        return wanted

    return sizing


def _beside(
    points: np.ndarray, starts: np.ndarray, edges: np.ndarray, lengths: np.ndarray, wanted: np.ndarray
) -> np.ndarray:
    """The `wanted` lengths (k,) at points (k, 2), or what edges (e, 2) from `starts` ask for there, if that is more."""
    step = max(1, _BLOCK // max(1, len(points)))
    for first in range(0, len(starts), step):
        part = slice(first, first + step)
        offset = points[:, None] - starts[part]
        t = (offset * edges[part]).sum(-1) / (edges[part] ** 2).sum(-1)
        away = np.linalg.norm(offset - np.clip(t, 0, 1)[..., None] * edges[part], axis=-1)
        wanted = np.maximum(wanted, (lengths[part] - GRADATION * away).max(axis=1))
    return wanted
