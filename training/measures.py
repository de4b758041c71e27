"""Measures of small triangulations, compiled: what the teacher is chosen by, and what the evaluation reports."""

from __future__ import annotations

import numpy as np
from numba import njit

from tessera.quality import element_quality


def qualities(vertices: np.ndarray, triangles: np.ndarray) -> tuple[float, float]:
    """(q_worst, q_mean) of a mesh: vertices (n, 2) float64, triangles (m, 3) int."""
    q = element_quality(vertices, triangles)
    return float(q.min()), float(q.mean())


@njit(cache=True)
def deviation(vertices, triangles, n_contour, l_s):
    """Mean of |edge - l_s| / l_s over the edges that are not the contour's, 0 where there is none.

    vertices: (n, 2) float64, the contour's first; triangles: (m, 3) int64, counter-clockwise.
    """
    total, count = 0.0, 0
    for t in range(len(triangles)):
        for side in range(3):
            a, b = triangles[t, side], triangles[t, (side + 1) % 3]
            if a < n_contour and b == (a + 1) % n_contour:
                continue
            length = np.hypot(vertices[a, 0] - vertices[b, 0], vertices[a, 1] - vertices[b, 1])
            total += abs(length - l_s) / l_s
            count += 1
    # Inner edges are met twice, once from each side.
    return total / max(count, 1)
