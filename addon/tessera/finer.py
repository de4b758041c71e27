"""From a boundary of one level to the next finer one: which of its vertices lie between the ends of each edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Arcs:
    """A boundary to which a mesh's boundary edges are to be refined.

    points: (n, 2) of all loops, one behind the other; size: (m,) of the loops; coarse, fine: (n,) bool, which points
    the mesh has on its boundary, and which it is to have; number: (v,) int, the point that each vertex of the mesh is,
    or -1.
    """

    points: np.ndarray
    size: np.ndarray
    coarse: np.ndarray
    fine: np.ndarray
    number: np.ndarray

    def between(self, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points between the ends of boundary edges (k, 2): how many (k,), and their numbers, each edge's in order."""
        loop = np.repeat(np.arange(len(self.size)), self.size)
        start, end = self.number[edges].T
        rank, count, first = _ranks(self.fine, loop)
        coarse_rank, coarse_count, _ = _ranks(self.coarse, loop)
        of = loop[start]
        ahead = (coarse_rank[end] - coarse_rank[start]) % coarse_count[of] == 1
        sign = np.where(ahead, 1, -1)
        inserted = (sign * (rank[end] - rank[start])) % count[of] - 1
        edge = np.repeat(np.arange(len(edges)), inserted)
        step = np.arange(len(edge)) - np.repeat(np.cumsum(inserted) - inserted, inserted) + 1
        place = (rank[start[edge]] + sign[edge] * step) % count[of[edge]]
        return inserted, np.flatnonzero(self.fine)[first[of[edge]] + place]


def _ranks(kept: np.ndarray, loop: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Among the kept points of each loop: the place of each point (n,), how many there are, and before them (m,)."""
    count = np.bincount(loop, kept).astype(np.int64)
    first = np.cumsum(count) - count
    return np.cumsum(kept) - 1 - first[loop], count, first
