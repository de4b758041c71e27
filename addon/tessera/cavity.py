"""Measures of cavities: what is inside a contour, how far from it, and how long an even mesh's edges would be.

Contours are padded: (B, N, 2) float64, counter-clockwise, with ``n_contour`` (B,) vertices each.
"""

from __future__ import annotations

import numpy as np


def next_vertices(contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, N, 2) the end of the edge that starts at each contour vertex; of padding, any vertex."""
    after = np.roll(contour, -1, axis=1)
    after[np.arange(len(contour)), n_contour - 1] = contour[:, 0]
    return after


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
    return _is_inside(*_points_and_edges(points, contour, n_contour)).T


def signed_distances(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B, M) distance of points (B, M, 2) to the closest edge of their contour, negative where they are not inside."""
    (x, y), (ax, ay), (bx, by) = place = _points_and_edges(points, contour, n_contour)
    ex, ey, px, py = bx - ax, by - ay, x - ax, y - ay
    along = (px * ex + py * ey) / np.maximum(ex * ex + ey * ey, np.finfo(ex.dtype).tiny)
    np.minimum(np.maximum(along, 0, out=along), 1, out=along)
    px -= along * ex
    py -= along * ey
    away = np.sqrt((px * px + py * py).min(axis=0))
    return np.where(_is_inside(*place), away, -away).T


def _points_and_edges(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray) -> tuple[np.ndarray, ...]:
    """x and y of points (2, M, B), of edges' starts (2, N, 1, B) and of their ends; long rows are fast.

    Padding is from the first vertex to itself.
    """
    real = (np.arange(contour.shape[1]) < n_contour[:, None])[..., None]
    ends = contour, next_vertices(contour, n_contour)
    start, end = (np.ascontiguousarray(np.where(real, of, contour[:, :1]).T)[:, :, None] for of in ends)
    return np.ascontiguousarray(points.T), start, end


def _is_inside(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(M, B) by the even-odd rule; of `_points_and_edges`."""
    (x, y), (ax, ay), (bx, by) = points, start, end
    side = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    return np.bitwise_xor.reduce(((ay > y) != (by > y)) & ((side > 0) == (by > ay)), axis=0)
