"""Sizing functions: the edge length that is wanted at a point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# How fast the wanted length may fall off beside an edge that is longer than the target, in length per length.
GRADATION = 0.5
LONG = 1.5  # times the target edge length, from which an edge is longer than it could be
_BLOCK = 1 << 22  # distances held at a time


def grade_from_edges(polygons: list[np.ndarray], edge_length: float) -> Callable[[np.ndarray], np.ndarray]:
    """The target edge length everywhere, but larger beside boundary edges that are longer and may not be split.

    polygons: (k, 2) arrays, as they will be in the mesh. Without long edges the function is constant.
    """
    starts = np.concatenate(polygons)
    ends = np.concatenate([np.roll(polygon, -1, axis=0) for polygon in polygons])
    lengths = np.linalg.norm(ends - starts, axis=1)
    long = lengths > LONG * edge_length
    starts, edges, lengths = starts[long], (ends - starts)[long], lengths[long]

    def sizing(points: np.ndarray) -> np.ndarray:
        """(k, 2) points -> (k,) wanted edge lengths."""
        wanted = np.full(len(points), float(edge_length))
        step = max(1, _BLOCK // max(1, len(points)))
        for first in range(0, len(starts), step):
            part = slice(first, first + step)
            offset = points[:, None] - starts[part]
            t = (offset * edges[part]).sum(-1) / (edges[part] ** 2).sum(-1)
            away = np.linalg.norm(offset - np.clip(t, 0, 1)[..., None] * edges[part], axis=-1)
            wanted = np.maximum(wanted, (lengths[part] - GRADATION * away).max(axis=1))
        return wanted

    return sizing
