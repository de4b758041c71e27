"""From scores to inner vertices (paper, section 2.4): NN2's scores are decoded, then NN2 moves what was placed.

All in the transformed plane, contours padded to (B, N, 2). Whatever the networks say, the vertices that come out are
distinct and strictly inside their contours.
"""

from __future__ import annotations

import numpy as np

from . import networks
from .cavity import even_lengths, signed_distances
from .grid import bounding_boxes, make_grids, steps
from .stopwatch import Stopwatch

MOST_INNER = 32

# Grid points along the longer side of a contour's bounding box: so many to an even edge length, not more than the
# paper's 20, and a finer grid where that leaves too few in a thin cavity.
_GRIDS = np.array([6, 8, 10, 12, 14, 16, 20])
_POINTS_AN_EDGE = 2.25
_FINE_GRID = 48
_CHECKED = 256  # contours that are checked at a time

# In even edge lengths:
_MARGIN = 0.2  # grid points closer to the contour are left out
_CLOSEST = 0.3  # to another vertex that a vertex may be placed
_CROWDED = 0.65  # closer than this to another vertex costs
_MOVED_MARGIN = 0.08  # to the contour and each other that moved vertices must keep


def place_inner_vertices(
    contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, watch: Stopwatch, times: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Place N_I vertices in each cavity.

    contour: (B, N, 2) float64; n_contour, n_inner: (B,) int64; times: that NN2's further passes, three in a call, go
    over what was placed. Returns inner vertices (B, M, 2) and how many each contour has, (B,): fewer than asked for
    where the cavity is too thin to hold them apart.
    """
    inner, count = place_by_scores(contour, n_contour, n_inner, watch)
    moved = inner
    with watch("NN2"):
        for _ in range(times):
            moved = networks.move_inner_vertices(contour, n_contour, moved, count)
    with watch("decoding"):
        return _keep_valid(moved, inner, contour, n_contour, count), count


def place_by_scores(
    contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, watch: Stopwatch
) -> tuple[np.ndarray, np.ndarray]:
    """The places that NN2's scores alone give, as `place_inner_vertices` returns them."""
    inner = np.zeros((len(contour), int(n_inner.max(initial=0)), 2))
    count = np.zeros_like(n_inner)
    even = even_lengths(contour, n_contour, n_inner)
    low, high = bounding_boxes(contour, n_contour)
    wanted = _POINTS_AN_EDGE * (high - low).max(axis=1) / even
    grid = _GRIDS[np.abs(np.log(_GRIDS) - np.log(wanted)[:, None]).argmin(axis=1)]
    for resolution in (*_GRIDS, _FINE_GRID):
        rows = np.flatnonzero((count < n_inner) & ((grid == resolution) | (resolution == _FINE_GRID)))
        if len(rows):
            placed, found = _decode(contour[rows], n_contour[rows], n_inner[rows], even[rows], resolution, watch)
            better = found > count[rows]
            inner[rows[better], : placed.shape[1]] = placed[better]
            count[rows[better]] = found[better]
    return inner, count


def _decode(
    contour: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    even: np.ndarray,
    resolution: int,
    watch: Stopwatch,
) -> tuple[np.ndarray, np.ndarray]:
    """Score the admissible grid points, refine each between its neighbours, and choose among them."""
    with watch("decoding"):
        grids = make_grids(contour, n_contour, _MARGIN * even, resolution)
        n_grid = np.count_nonzero(grids.admissible, axis=1)
        # Admissible points first, in their order.
        order = np.argsort(~grids.admissible, axis=1, kind="stable")[:, : n_grid.max(initial=1)]
        row, column = np.divmod(order, resolution)
        points = np.stack([steps(resolution)[column], steps(resolution)[row]], axis=1)
    with watch("NN2"):
        found = networks.score_grid(contour, n_contour, n_inner, grids.places(points), n_grid)
    with watch("decoding"):
        offsets = _refinement(found, row, column, resolution)
        # No farther than leaves the margin of moved vertices, whatever the scores are.
        farthest = ((_MARGIN - _MOVED_MARGIN) * even / grids.spacing).astype(np.float32)[:, None, None]
        way = np.sqrt((offsets * offsets).sum(axis=1, keepdims=True))
        points += offsets * np.minimum(1, farthest / np.maximum(way, np.float32(1e-9)))
        inner, count = _choose(points, found, n_inner, (even / grids.spacing).astype(np.float32))
        return np.swapaxes(grids.places(np.swapaxes(inner, 1, 2)), 1, 2), count


def _refinement(scores: np.ndarray, row: np.ndarray, column: np.ndarray, resolution: int) -> np.ndarray:
    """Offsets (B, 2, M), in grid spacings, from grid points to the lowest point of the parabola through neighbours.

    scores: (B, M) of the grid points in these rows and columns, inf where there is none; a point with an unknown
    neighbour stays where it is.
    """
    # With an unknown column behind each row, and unknown rows below and above.
    width = resolution + 1
    surface = np.full((len(scores), width * (resolution + 2)), np.inf, dtype=np.float32)
    place = (row + 1) * width + column + surface.shape[1] * np.arange(len(scores))[:, None]
    surface.put(place, scores)
    offsets = np.empty((len(scores), 2, scores.shape[1]), dtype=np.float32)
    for axis, step in enumerate((1, width)):
        before, after = surface.take(place - step), surface.take(place + step)
        with np.errstate(invalid="ignore", divide="ignore"):
            bend = before + after - 2 * scores
            offset = np.minimum(np.maximum((before - after) / (2 * bend), -0.5), 0.5)
            offsets[:, axis] = np.where((bend > 1e-6) & (bend < np.inf), offset, 0)
    return offsets


def _choose(
    places: np.ndarray, scores: np.ndarray, n_inner: np.ndarray, even: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Take the places (B, 2, M) of lowest score (B, M), one after the other and apart: (B, n, 2), and how many (B,)."""
    # Contours that want many come first, so that those still choosing are a slice.
    rows = np.argsort(-n_inner, kind="stable")
    x, y = np.moveaxis(places[rows] / (_CROWDED * even[rows, None, None]), 1, 0)
    cost = scores[rows]
    chosen = np.zeros((int(n_inner.max()), len(rows)), dtype=np.int64)
    found = np.full(chosen.shape, np.inf)
    for k in range(len(chosen)):
        m = np.count_nonzero(n_inner > k)
        going, best = np.arange(m), cost[:m].argmin(axis=1)
        chosen[k, :m], found[k, :m] = best, cost[going, best]
        dx, dy = x[:m] - x[going, best][:, None], y[:m] - y[going, best][:, None]
        dx *= dx
        dy *= dy
        dx += dy
        # Twice what is missing to the crowding distance, squared.
        cost[:m] += np.maximum(2 - 2 * dx, 0)
        cost[:m][dx < (_CLOSEST / _CROWDED) ** 2] = np.inf
    # Where nothing was left, nothing is placed from then on.
    fits = np.isfinite(found)
    inner, count = np.zeros((len(rows), len(chosen), 2)), np.zeros_like(n_inner)
    inner[rows] = np.where(fits[..., None], places[rows, :, chosen], 0).swapaxes(0, 1)
    count[rows] = np.count_nonzero(fits, axis=0)
    return inner, count


def _keep_valid(
    moved: np.ndarray, placed: np.ndarray, contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray
) -> np.ndarray:
    """The moved vertices (B, M, 2) of contours where all are valid, else those that had been placed."""
    kept = placed.copy()
    # Contours of like numbers together, and few, so that the distances of all pairs stay in the processor's cache.
    order = np.argsort(n_inner, kind="stable")
    for rows in np.array_split(order, -(-len(order) // _CHECKED)) if len(order) else []:
        m = int(n_inner[rows].max())
        valid = rows[_is_valid(moved[rows, :m], contour[rows], n_contour[rows], n_inner[rows])]
        kept[valid, :m] = moved[valid, :m]
    return kept


@np.errstate(over="ignore", invalid="ignore")  # what is so far away is outside
def _is_valid(inner: np.ndarray, contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """(B,) whether all inner vertices (B, M, 2) keep their margin to the contour, inside, and to each other.

    Single precision tells, as the margin is far wider than its rounding for edges of a millionth of the contour's size.
    """
    m = inner.shape[1]
    margin = (_MOVED_MARGIN * even_lengths(contour, n_contour, n_inner)[:, None]).astype(np.float32)
    inner, contour = inner.astype(np.float32), contour.astype(np.float32)
    padding = np.arange(m) >= n_inner[:, None]
    clear = signed_distances(inner, contour, n_contour) > margin
    x, y = np.moveaxis(inner, -1, 0)
    apart = (x[:, :, None] - x[:, None]) ** 2 + (y[:, :, None] - y[:, None]) ** 2 > (margin**2)[..., None]
    apart |= padding[:, :, None] | padding[:, None] | np.eye(m, dtype=bool)
    return (clear | padding).all(axis=1) & apart.all(axis=(1, 2))
