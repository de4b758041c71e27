"""The paper's own decoding of NN2's scores (section 2.4, Fig. 8; section 3.2.2), in the transformed plane.

The grid point of lowest score is taken, those outside the contour or too close to it left out; the scores around it are
interpolated, and their minimum is the vertex; the grid points around it are excluded, and so on, N_I times.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from .cavity import even_lengths, signed_distances
from .roles import Arrays

GRID = 20  # points along the grid
HALF_WIDTH = 1.2  # of the box that it covers
PATCH = 2  # points along a patch
MARGIN = 0.1  # of l_s: grid points closer to the contour are left out
# Of the even edge length: grid points closer to a vertex are excluded. The paper's 0.1 l_s is less than the grid's
# spacing, so that the next vertex would be the same again.
EXCLUSION = 0.6


def grid_points(resolution: int) -> np.ndarray:
    """(R², 2) points of the square grid over all transformed contours, row by row."""
    steps = np.linspace(-HALF_WIDTH, HALF_WIDTH, resolution)
    return np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)


def patches(resolution: int) -> np.ndarray:
    """(P, 4) numbers of the grid points of each patch of 2×2."""
    number = np.arange(resolution**2).reshape(resolution // PATCH, PATCH, resolution // PATCH, PATCH)
    return number.transpose(0, 2, 1, 3).reshape(-1, PATCH * PATCH)


def decode(
    scores: np.ndarray,
    contour: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    l_s: np.ndarray,
    exclusion: np.ndarray | None = None,
) -> Arrays:
    """Inner vertices (B, M, 2), distinct and inside, and how many each contour got (B,).

    scores: (B, R²); exclusion: (B,) lengths, `EXCLUSION` even edge lengths if not given. Fewer than n_inner (B,) are
    placed where no grid point is left.
    """
    resolution = round(scores.shape[1] ** 0.5)
    points = grid_points(resolution)
    if exclusion is None:
        exclusion = EXCLUSION * even_lengths(contour, n_contour, n_inner)
    cost = np.where(
        _is_clear(np.broadcast_to(points, (len(scores), *points.shape)), contour, n_contour, l_s), scores, np.inf
    )
    inner = np.zeros((len(scores), int(n_inner.max(initial=0)), 2))
    count = np.zeros(len(scores), dtype=np.int64)
    for k in range(inner.shape[1]):
        best = cost.argmin(axis=1)
        going = np.flatnonzero((n_inner > k) & np.isfinite(cost[np.arange(len(cost)), best]))
        if not len(going):
            break
        place = points[best[going]] + _offsets(scores[going], best[going], resolution)
        # Where interpolation leads out of the cavity or to a vertex that is there, the grid point stays.
        clear = _is_clear(place[:, None], contour[going], n_contour[going], l_s[going])[:, 0]
        away = np.linalg.norm(place[:, None] - inner[going, :k], axis=-1).min(axis=1, initial=np.inf)
        place = np.where((clear & (away > 0.5 * exclusion[going]))[:, None], place, points[best[going]])
        inner[going, k], count[going] = place, k + 1
        near = ((points - place[:, None]) ** 2).sum(axis=-1) < exclusion[going, None] ** 2
        near[np.arange(len(going)), best[going]] = True
        cost[going] = np.where(near, np.inf, cost[going])
    return inner, count


def _is_clear(points: np.ndarray, contour: np.ndarray, n_contour: np.ndarray, l_s: np.ndarray) -> np.ndarray:
    """(B, M) whether points (B, M, 2) are inside their contour and not too close to it."""
    away = signed_distances(points, contour, n_contour)
    return (away >= MARGIN * l_s[:, None]) & (away > 0)


def _offsets(scores: np.ndarray, best: np.ndarray, resolution: int) -> np.ndarray:
    """(B, 2) from grid points ``best`` (B,) to the minimum of the quadratic surface through the 3×3 scores around.

    At most half a spacing along each axis; 0 where the surface has no minimum.
    """
    spacing = 2 * HALF_WIDTH / (resolution - 1)
    row, column = (np.clip(index, 1, resolution - 2) for index in np.divmod(best, resolution))
    around = (row[:, None, None] + np.arange(-1, 2)[:, None]) * resolution + column[:, None, None] + np.arange(-1, 2)
    values = np.take_along_axis(scores, around.reshape(len(best), 9), axis=1)
    bx, by, xx, xy, yy = (values @ _fit().T)[:, 1:].T
    determinant = 4 * xx * yy - xy * xy
    hollow = (xx > 1e-9) & (determinant > 1e-12)
    safe = np.where(hollow, determinant, 1)
    offset = np.stack([xy * by - 2 * yy * bx, xy * bx - 2 * xx * by], axis=1) / safe[:, None]
    return np.where(hollow[:, None], np.clip(offset, -0.5, 0.5), 0) * spacing


@cache
def _fit() -> np.ndarray:
    """(6, 9) least squares: nine scores to the coefficients of 1, x, y, x², xy and y², in grid spacings."""
    y, x = (axis.ravel() for axis in np.mgrid[-1:2, -1:2].astype(float))
    return np.linalg.pinv(np.stack([np.ones(9), x, y, x * x, x * y, y * y], axis=1))
