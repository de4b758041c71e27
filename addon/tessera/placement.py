"""From scores to inner vertices (paper, section 2.4): NN2's scores are decoded, then NN2 moves what was placed.

All in the transformed plane, contours padded to (B, N, 2). Whatever the networks say, the vertices that come out are
distinct and strictly inside their contours.
"""

from __future__ import annotations

import numpy as np

from . import networks
from .cavity import distances_to_contour, even_lengths, is_inside

MOST_INNER = 32
PASSES = 3  # of NN2 over all placed vertices

# Grid points along the longer side of a contour's bounding box: the paper's 20, fewer where four to an even edge length
# are enough, and more where that leaves too few in a thin cavity.
_GRIDS = np.array([8, 12, 16, 20])
_POINTS_AN_EDGE = 4
_FINE_GRID = 48

# In even edge lengths:
_MARGIN = 0.2  # grid points closer to the contour are left out
_CLOSEST = 0.3  # to another vertex that a vertex may be placed
_CROWDED = 0.65  # closer than this to another vertex costs
_MOVED_MARGIN = 0.08  # to the contour and each other that moved vertices must keep


def place_inner_vertices(
    contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, l_s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Place N_I vertices in each cavity.

    contour: (B, N, 2) float64; n_contour, n_inner: (B,) int64; l_s: (B,). Returns inner vertices (B, M, 2) and how many
    each contour has, (B,): fewer than asked for where the cavity is too thin to hold them apart.
    """
    inner, count = place_by_scores(contour, n_contour, n_inner, l_s)
    for _ in range(PASSES):
        inner = _move(contour, n_contour, inner, count)
    return inner, count


def place_by_scores(
    contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, l_s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The first pass of `place_inner_vertices` alone, from the scores."""
    inner = np.zeros((len(contour), int(n_inner.max(initial=0)), 2))
    count = np.zeros_like(n_inner)
    low, high = _bounding_boxes(contour, n_contour)
    wanted = _POINTS_AN_EDGE * (high - low).max(axis=1) / even_lengths(contour, n_contour, n_inner)
    grid = _GRIDS[np.minimum(np.searchsorted(_GRIDS, wanted), len(_GRIDS) - 1)]
    for resolution in (*_GRIDS, _FINE_GRID):
        rows = np.flatnonzero((count < n_inner) & ((grid == resolution) | (resolution == _FINE_GRID)))
        if len(rows):
            placed, found = _decode(contour[rows], n_contour[rows], n_inner[rows], l_s[rows], resolution)
            better = found > count[rows]
            inner[rows[better], : placed.shape[1]] = placed[better]
            count[rows[better]] = found[better]
    return inner, count


def _decode(
    contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, l_s: np.ndarray, resolution: int
) -> tuple[np.ndarray, np.ndarray]:
    """Score the admissible grid points, refine each between its neighbours, and choose among them."""
    even = even_lengths(contour, n_contour, n_inner)
    grid, spacing = _grid(contour, n_contour, resolution)
    admissible = is_inside(grid, contour, n_contour)
    admissible &= distances_to_contour(grid, contour, n_contour) > (_MARGIN * even)[:, None]
    n_grid = admissible.sum(axis=1)
    order = np.argsort(~admissible, axis=1, kind="stable")[:, : n_grid.max(initial=1)]
    packed = np.take_along_axis(grid, order[..., None], axis=1)
    found = np.round(networks.score_grid(contour, n_contour, n_inner, l_s, packed, n_grid), 4)
    scores = np.full(grid.shape[:2], np.inf)
    np.put_along_axis(scores, order, found, axis=1)
    offsets = np.take_along_axis(_refinement(scores, resolution), order[..., None], axis=1)
    return _choose(packed + offsets * spacing[:, None, None], found, n_inner, even)


def _choose(
    places: np.ndarray, scores: np.ndarray, n_inner: np.ndarray, even: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Take the places (B, M, 2) of lowest score (B, M), one after the other and apart: (B, n, 2), and how many (B,)."""
    # Contours that want many come first, so that those still choosing are a slice.
    rows = np.argsort(-n_inner, kind="stable")
    (x, y), cost, unit = np.moveaxis(places[rows], -1, 0), scores[rows], even[rows, None]
    inner, count = np.zeros((len(rows), int(n_inner.max()), 2)), np.zeros_like(n_inner)
    for k in range(inner.shape[1]):
        m = np.count_nonzero(n_inner > k)
        going, best = np.arange(m), cost[:m].argmin(axis=1)
        fits = np.isfinite(cost[going, best])
        at_x, at_y = x[going, best], y[going, best]
        inner[rows[:m][fits], k] = np.stack([at_x, at_y], axis=1)[fits]
        count[rows[:m][fits]] += 1
        away = np.hypot(x[:m] - at_x[:, None], y[:m] - at_y[:, None]) / unit[:m]
        cost[:m] += np.where(away < _CLOSEST, np.inf, 2 * np.maximum(0, 1 - away / _CROWDED))
    return inner, count


def _grid(contour: np.ndarray, n_contour: np.ndarray, resolution: int) -> tuple[np.ndarray, np.ndarray]:
    """Square grids over the bounding boxes: (B, resolution², 2), row by row, and their spacings (B,)."""
    low, high = _bounding_boxes(contour, n_contour)
    spacing = (high - low).max(axis=1) / resolution
    steps = np.arange(resolution) - (resolution - 1) / 2
    cells = np.stack(np.meshgrid(steps, steps, indexing="xy"), axis=-1).reshape(-1, 2)
    return (low + high)[:, None] / 2 + cells * spacing[:, None, None], spacing


def _bounding_boxes(contour: np.ndarray, n_contour: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest coordinates (B, 2) of each contour."""
    real = (np.arange(contour.shape[1]) < n_contour[:, None])[..., None]
    return np.where(real, contour, np.inf).min(axis=1), np.where(real, contour, -np.inf).max(axis=1)


def _refinement(scores: np.ndarray, resolution: int) -> np.ndarray:
    """Offsets, in grid spacings, from grid points to the lowest point of the parabola through their neighbours."""
    surface = scores.reshape(-1, resolution, resolution)
    padded = np.pad(surface, ((0, 0), (1, 1), (1, 1)), constant_values=np.inf)
    offsets = np.zeros((*surface.shape, 2))
    for axis, (before, after) in enumerate(
        ((padded[:, 1:-1, :-2], padded[:, 1:-1, 2:]), (padded[:, :-2, 1:-1], padded[:, 2:, 1:-1]))
    ):
        known = np.isfinite(before) & np.isfinite(after) & np.isfinite(surface)
        b, c, a = (np.where(known, value, 0) for value in (before, surface, after))
        bend = b - 2 * c + a
        hollow = known & (bend > 1e-6)
        offsets[..., axis] = np.where(hollow, np.clip(0.5 * (b - a) / np.where(hollow, bend, 1), -0.5, 0.5), 0)
    return offsets.reshape(len(scores), -1, 2)


def _move(contour: np.ndarray, n_contour: np.ndarray, inner: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """One pass of NN2 over all placed vertices; a vertex stays where its new place would not be valid."""
    if not inner.shape[1]:
        return inner
    moved = networks.move_inner_vertices(contour, n_contour, inner, n_inner)
    margin = _MOVED_MARGIN * even_lengths(contour, n_contour, n_inner)[:, None]
    real = np.arange(inner.shape[1]) < n_inner[:, None]
    allowed = is_inside(moved, contour, n_contour) & (distances_to_contour(moved, contour, n_contour) > margin)
    moved = np.where(allowed[..., None], moved, inner)
    apart = np.linalg.norm(moved[:, :, None] - moved[:, None], axis=-1)
    apart[~(real[:, :, None] & real[:, None])] = np.inf
    apart[:, np.arange(inner.shape[1]), np.arange(inner.shape[1])] = np.inf
    crowded = (apart < margin[..., None]).any(axis=(1, 2))
    return np.where(crowded[:, None, None], inner, moved)
