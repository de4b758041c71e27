"""The edges of a mesh: each once, which lie between two elements, and which vertices they leave free."""

from __future__ import annotations

import numpy as np


def sides(triangles: np.ndarray) -> np.ndarray:
    """The three edges of each of the triangles (m, 3), smaller vertex first: (3 m, 2) int64."""
    start = triangles.astype(np.int64)
    end = np.roll(start, -1, axis=1)
    return np.stack([np.minimum(start, end).ravel(), np.maximum(start, end).ravel()], axis=1)


def unique_edges(triangles: np.ndarray) -> np.ndarray:
    """Each edge of triangles (m, 3) once, its smaller vertex first: (e, 2)."""
    return inner_edges(triangles)[0]


def inner_edges(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The edges (e, 2), smaller vertex first, and whether each lies between two triangles (e,)."""
    edges, n = sides(triangles), int(triangles.max(initial=0)) + 1
    keys, count = np.unique(edges[:, 0] * n + edges[:, 1], return_counts=True)
    return np.stack(np.divmod(keys, n), axis=1), count == 2


def off_boundary(triangles: np.ndarray, n_vertices: int, fixed: np.ndarray | None = None) -> np.ndarray:
    """(n,) which vertices no boundary edge has, and none of the fixed edges (f, 2)."""
    edges, inner = inner_edges(triangles)
    free = np.ones(n_vertices, dtype=bool)
    free[edges[~inner]] = False
    if fixed is not None:
        free[fixed] = False
    return free


def among(edges: np.ndarray, fixed: np.ndarray | None) -> np.ndarray:
    """(e,) which of the edges (e, 2) are among the fixed ones (f, 2), in either direction."""
    if fixed is None or not len(fixed) or not len(edges):
        return np.zeros(len(edges), dtype=bool)
    stride = int(max(edges.max(), fixed.max())) + 1
    key, wanted = (np.min(e, axis=1).astype(np.int64) * stride + np.max(e, axis=1) for e in (edges, fixed))
    return np.isin(key, wanted)
