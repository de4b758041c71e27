"""Measures of cavities: what is inside a contour, how far from it, and how long an even mesh's edges would be.

Contours are padded: (B, N, 2) float64, counter-clockwise, with ``n_contour`` (B,) vertices each.
"""

from __future__ import annotations

import numpy as np


def next_vertices(contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, N, 2) the end of the edge that starts at each contour vertex."""
    index = np.arange(contour.shape[1])
    after = np.where(index + 1 < n_contour[:, None], index + 1, 0)
    return np.take_along_axis(contour, after[..., None], axis=1)


def areas(contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B,) signed area of each cavity."""
    origin = contour[:, :1]
    a, b = contour - origin, next_vertices(contour, n_contour) - origin
    real = np.arange(contour.shape[1]) < n_contour[:, None]
    return 0.5 * ((a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) * real).sum(axis=1)


def even_lengths(contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """(B,) edge length of the equilateral elements, 2 N_I + N_C - 2 of them, that would fill each cavity."""
    return np.sqrt(np.maximum(areas(contour, n_contour), 1e-300) * 4 / np.sqrt(3) / (2 * n_inner + n_contour - 2))


def is_inside(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, M) whether points (B, M, 2) are inside their contour, by the even-odd rule, in floating point."""
    after = next_vertices(contour, n_contour)
    inside = np.zeros(points.shape[:2], dtype=bool)
    x, y = points[..., 0], points[..., 1]
    for k in range(contour.shape[1]):
        (ax, ay), (bx, by) = contour[:, k, :, None].swapaxes(0, 1), after[:, k, :, None].swapaxes(0, 1)
        straddles = ((ay > y) != (by > y)) & (k < n_contour)[:, None]
        side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
        inside ^= straddles & ((side > 0) == (by > ay))
    return inside


def distances_to_contour(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, M) distance of points (B, M, 2) to the closest edge of their contour."""
    edges = next_vertices(contour, n_contour) - contour
    x, y = points[..., 0], points[..., 1]
    closest = np.full(points.shape[:2], np.inf)
    for k in range(contour.shape[1]):
        (ax, ay), (ex, ey) = contour[:, k, :, None].swapaxes(0, 1), edges[:, k, :, None].swapaxes(0, 1)
        px, py = x - ax, y - ay
        along = np.clip((px * ex + py * ey) / np.maximum(ex * ex + ey * ey, 1e-300), 0, 1)
        px -= along * ex
        py -= along * ey
        square = px * px + py * py
        square[k >= n_contour] = np.inf
        np.minimum(closest, square, out=closest)
    return np.sqrt(closest)
