"""Measures of cavities: what is inside a contour, how far from it, and how long an even mesh's edges would be.

Contours are padded: (B, N, 2) float64, counter-clockwise, with ``n_contour`` (B,) vertices each.
"""

from __future__ import annotations

import numpy as np


def next_vertices(contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, N, 2) the end of the edge that starts at each contour vertex."""
    index = np.arange(contour.shape[1])
    after = np.where(index + 1 < n_contour[:, None], index + 1, 0)
    return contour[np.arange(len(contour))[:, None], after]


def areas(contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B,) signed area of each cavity."""
    origin = contour[:, :1]
    a, b = contour - origin, next_vertices(contour, n_contour) - origin
    real = np.arange(contour.shape[1]) < n_contour[:, None]
    return 0.5 * ((a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) * real).sum(axis=1)


def even_lengths(contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """(B,) edge length of the equilateral elements, 2 N_I + N_C - 2 of them, that would fill each cavity."""
    return even_lengths_of(np.maximum(areas(contour, n_contour), 1e-300), n_contour, n_inner)


def even_lengths_of(area: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """`even_lengths` of cavities of known areas (B,), above 0."""
    return np.sqrt(area * 4 / np.sqrt(3) / (2 * n_inner + n_contour - 2))


def is_inside(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, M) whether points (B, M, 2) are inside their contour, by the even-odd rule, in floating point."""
    x, y, (ax, ay), (bx, by) = _points_and_edges(points, contour, n_contour)
    straddles = ((ay > y) != (by > y)) & (np.arange(contour.shape[1]) < n_contour[:, None])[:, None]
    side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    return np.bitwise_xor.reduce(straddles & ((side > 0) == (by > ay)), axis=-1)


def distances_to_contour(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, M) distance of points (B, M, 2) to the closest edge of their contour."""
    x, y, (ax, ay), (bx, by) = _points_and_edges(points, contour, n_contour)
    ex, ey, px, py = bx - ax, by - ay, x - ax, y - ay
    along = np.clip((px * ex + py * ey) / np.maximum(ex * ex + ey * ey, np.finfo(ex.dtype).tiny), 0, 1)
    px -= along * ex
    py -= along * ey
    square = px * px + py * py
    square[np.broadcast_to((np.arange(contour.shape[1]) >= n_contour[:, None])[:, None], square.shape)] = np.inf
    return np.sqrt(square.min(axis=-1))


def _points_and_edges(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> tuple[np.ndarray, ...]:
    """x and y of points (B, M, 1), of edges' starts (2, B, 1, N) and of their ends."""
    x, y = np.moveaxis(points, -1, 0)[..., None]
    start, end = (np.moveaxis(ends, -1, 0)[:, :, None] for ends in (contour, next_vertices(contour, n_contour)))
    return x, y, start, end
