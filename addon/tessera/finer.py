"""From a boundary of one level to the next finer one: which of its vertices lie between the ends of each edge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Arcs:
    """What a mesh's boundary edges, and those that must stay, are to be refined to.

    points: (n, 2); walk: (w,) their numbers along chains, one behind the other, of which a closed one ends with the
    point that it starts with; size: (m,) of the chains; coarse, fine: (n,) bool, which points the mesh has, among them
    the ends of all chains, and which it is to have; number: (v,) int, the point that each vertex of the mesh is, or -1.
    """

    points: np.ndarray
    walk: np.ndarray
    size: np.ndarray
    coarse: np.ndarray
    fine: np.ndarray
    number: np.ndarray

    def between(self, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points between the ends of edges (k, 2): how many (k,), and their numbers, each edge's in order."""
        kept = self.fine[self.walk]
        walk, chain = self.walk[kept], np.repeat(np.arange(len(self.size)), self.size)[kept]
        ends = np.flatnonzero(self.coarse[walk])
        same = np.diff(chain[ends]) == 0
        first, last = ends[:-1][same], ends[1:][same]
        key, (start, end) = self._keys(walk[first], walk[last]), self.number[edges].T
        order = np.argsort(key, kind="stable")
        of = order[np.searchsorted(key[order], self._keys(start, end))]
        inserted = last[of] - first[of] - 1
        edge = np.repeat(np.arange(len(edges)), inserted)
        step = np.arange(len(edge)) - np.repeat(np.cumsum(inserted) - inserted, inserted) + 1
        ahead = (walk[first[of]] == start)[edge]
        return inserted, walk[np.where(ahead, first[of][edge] + step, last[of][edge] - step)]

    def _keys(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return np.minimum(one, other) * len(self.points) + np.maximum(one, other)
