"""Connection tables (section 2.5.1): what becomes of the mesh if a contour edge is connected to a vertex."""

from __future__ import annotations

import numpy as np
from numba import njit

from .meshing import area2, crosses, delaunay, force_edge, is_within, legalise, qualities


@njit(cache=True)
def is_element(points, n_contour, n, a, b, v):
    """Whether (a, b, v) can be an element: positive area, nothing in it or on it, its edges cross no contour edge."""
    if area2(points, a, b, v) <= 1e-10:
        return False
    for u in range(n):
        if u not in (a, b, v) and is_within(points, a, b, v, u):
            return False
    for k in range(n_contour):
        m = (k + 1) % n_contour
        if crosses(points, a, v, k, m) or crosses(points, b, v, k, m):
            return False
    return True


@njit(cache=True)
def connection_table(points, n_contour, n, table):
    """Fill ``table`` (N_C, n, 2) with (q_worst, q_mean), 0 where the element is not possible. Returns success.

    points: (n, 2) float64, the contour's vertices first. The element is forced and the rest of the cavity is meshed
    by the constrained Delaunay triangulation of the same vertices.
    """
    table[:] = 0.0
    base = np.empty((n, n), np.int64)
    if not delaunay(points, n_contour, n, base):
        return False
    own = qualities(points, base, n)
    fixed = np.zeros((n, n), np.bool_)
    for i in range(n_contour):
        a, b = i, (i + 1) % n_contour
        for v in range(n):
            if v in (a, b) or not is_element(points, n_contour, n, a, b, v):
                continue
            if base[a, b] == v:
                table[i, v, 0], table[i, v, 1] = own
                continue
            mesh = base.copy()
            if not (force_edge(points, mesh, n, a, v) and force_edge(points, mesh, n, b, v)):
                continue
            fixed[a, v] = fixed[v, a] = fixed[b, v] = fixed[v, b] = True
            legalise(points, mesh, n, fixed)
            fixed[a, v] = fixed[v, a] = fixed[b, v] = fixed[v, b] = False
            table[i, v, 0], table[i, v, 1] = qualities(points, mesh, n)
    return True


def connection_tables(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """Calculated tables of a batch, in the shape of NN3's answer.

    points: (B, V, 2) float64; n_contour, n_inner: (B,). Returns (B, max N_C, V, 2) float64.
    """
    tables = np.zeros((len(points), int(n_contour.max()), points.shape[1], 2))
    for row, (n, m) in enumerate(zip(n_contour, n_inner, strict=True)):
        connection_table(np.ascontiguousarray(points[row, : n + m]), n, n + m, tables[row, :n, : n + m])
    return tables
