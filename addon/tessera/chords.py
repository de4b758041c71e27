"""Where to cut polygons in two: the choice of one chord between two vertices for each polygon of a batch."""

from dataclasses import dataclass

import numpy as np

from .diagonals import balanced_diagonal
from .spacing import graded_spacing, natural_segments

# Polygons up to this size consider all pairs of vertices; larger ones all pairs with so many of them.
_ALL_PAIRS = 64
_ENDS = 32
# How many of the pairs with the best first cost are looked at closely, and how many if none of them is possible.
_SHORTLISTS = (24, 600)
_BLOCK = 400_000
# A chord is safe from rounding if everything else is farther away than this share of the polygon's size.
_SAFE = 1e-9
_SIXTY, _THIRTY = np.pi / 3, np.pi / 6


@dataclass(frozen=True)
class Chords:
    """A chord for each of P polygons, from vertex slot `start` to `end` > start, in at most `most` parts; all (P,)."""

    start: np.ndarray
    end: np.ndarray
    most: np.ndarray


@dataclass(frozen=True)
class _Batch:
    """Polygons in local coordinates, with what the costs of many chords have in common; (P, W) unless noted."""

    points: np.ndarray  # (P, W, 2) relative to the first vertex; padding repeats it
    size: np.ndarray  # (P,)
    edge_length: np.ndarray  # (P,)
    safe: np.ndarray  # (P,) distance
    spacing: np.ndarray  # mean length of the two edges at each vertex
    onward: np.ndarray  # direction of the edge that leaves the vertex
    interior: np.ndarray  # interior angle
    swept: np.ndarray  # twice the area swept from the first vertex up to this one


def choose_chords(corners: np.ndarray, size: np.ndarray, edge_length: np.ndarray) -> Chords:
    """The chord that cuts each simple counter-clockwise polygon best.

    corners (P, W, 2), of which each row's first size (P,) >= 4 count; edge_length (P,). The chord lies strictly inside:
    it meets no vertex and no edge but at its ends, which at least two edges separate on both sides.
    """
    batch = _prepare(corners, size, edge_length)
    start, end = np.full(len(size), -1), np.full(len(size), -1)
    open_rows = np.arange(len(size))
    for shortlist in _SHORTLISTS:
        if len(open_rows) == 0:
            break
        first, second = _best_of_many(_rows(batch, open_rows), shortlist)
        start[open_rows], end[open_rows] = first, second
        open_rows = open_rows[first < 0]
    for row in open_rows:  # no Python loop in ordinary cases
        start[row], end[row] = balanced_diagonal(corners[row, : size[row]])
    start, end = np.minimum(start, end), np.maximum(start, end)
    # Fewer than either arc, so that both parts have fewer edges than the polygon.
    most = np.minimum(end - start, size - end + start) - 1
    # The last resort may pass next to other vertices, where rounded new points could be on the wrong side.
    most[open_rows] = 1
    return Chords(start, end, most)


def _prepare(corners: np.ndarray, size: np.ndarray, edge_length: np.ndarray) -> _Batch:
    n_rows, width = corners.shape[:2]
    slot = np.arange(width)
    inside = slot < size[:, None]
    points = np.where(inside[..., None], corners - corners[:, :1], 0.0)
    row = np.arange(n_rows)[:, None]
    after = points[row, np.where(slot + 1 < size[:, None], slot + 1, 0)]
    before = points[row, np.where(slot > 0, slot - 1, size[:, None] - 1)]
    leaves, comes = after - points, before - points
    onward = np.arctan2(leaves[..., 1], leaves[..., 0])
    interior = (np.arctan2(comes[..., 1], comes[..., 0]) - onward) % (2 * np.pi)
    spacing = 0.5 * (np.hypot(leaves[..., 0], leaves[..., 1]) + np.hypot(comes[..., 0], comes[..., 1]))
    # Padding slots get any positive spacing.
    spacing = np.where(inside, spacing, 1.0)
    sweep = np.where(inside, points[..., 0] * after[..., 1] - points[..., 1] * after[..., 0], 0.0)
    swept = np.concatenate([np.zeros((n_rows, 1)), np.cumsum(sweep, axis=1)[:, :-1]], axis=1)
    largest = np.abs(points).max(axis=(1, 2))
    safe = _SAFE * largest + 64 * np.spacing(np.abs(corners).max(axis=(1, 2)))
    return _Batch(points, size, edge_length, safe, spacing, onward, interior, swept)


def _rows(batch: _Batch, rows: np.ndarray) -> _Batch:
    return _Batch(*(getattr(batch, name)[rows] for name in _Batch.__dataclass_fields__))


def _best_of_many(batch: _Batch, shortlist: int) -> tuple[np.ndarray, np.ndarray]:
    """The best chord (P,), (P,) of each polygon among the `shortlist` pairs of the lowest first cost, or -1, -1."""
    width = batch.points.shape[1]
    n_pairs = width * (width - 1) // 2 if width <= _ALL_PAIRS else width * _ENDS
    found = []
    for rows in np.array_split(np.arange(len(batch.size)), 1 + len(batch.size) * n_pairs // _BLOCK):
        block = _rows(batch, rows)
        start, end = _pairs(block)
        most = max(4 * shortlist, start.shape[1] // 5)
        start, end, cost = _keep_best(most, start, end, _cut_cost(block, start, end))
        start, end, cost = _keep_best(shortlist, start, end, _first_cost(block, start, end, cost))
        cost = cost + _close_cost(block, start, end, cost)
        best = np.argmin(cost, axis=1)[:, None]
        possible = np.isfinite(np.take_along_axis(cost, best, axis=1))
        found.append([np.where(possible, np.take_along_axis(a, best, axis=1), -1)[:, 0] for a in (start, end)])
    first, second = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return first, second


def _pairs(batch: _Batch) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of vertex slots to consider, (P, C) and (P, C); padding slots among them."""
    n_rows, width = batch.points.shape[:2]
    if width <= _ALL_PAIRS:
        start, end = np.triu_indices(width, 1)
        return np.broadcast_to(start, (n_rows, len(start))), np.broadcast_to(end, (n_rows, len(end)))
    # Half of the ends where the polygon turns inwards most, half evenly spaced.
    half = _ENDS // 2
    inside = np.arange(width) < batch.size[:, None]
    reflex = np.argsort(np.where(inside, -batch.interior, 0.0), axis=1, kind="stable")[:, :half]
    even = np.arange(half) * batch.size[:, None] // half
    ends = np.concatenate([reflex, even], axis=1)
    start = np.repeat(ends, width, axis=1)
    end = np.broadcast_to(np.tile(np.arange(width), 2 * half), start.shape)
    return np.minimum(start, end), np.maximum(start, end)


def _keep_best(n: int, start: np.ndarray, end: np.ndarray, cost: np.ndarray):
    """The n columns of lowest cost in each row of (P, C) arrays."""
    if cost.shape[1] <= n:
        return start, end, cost
    best = np.argpartition(cost, n, axis=1)[:, :n]
    return tuple(np.take_along_axis(a, best, axis=1) for a in (start, end, cost))


def _cut_cost(batch: _Batch, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Cost (P, C) of cuts: low for short ones between large parts and at reflex corners; infinite if impossible."""
    row = np.arange(len(start))[:, None]
    ax, ay = batch.points[row, start, 0], batch.points[row, start, 1]
    bx, by = batch.points[row, end, 0], batch.points[row, end, 1]
    squared = (bx - ax) ** 2 + (by - ay) ** 2
    swept = batch.swept[row, end] - batch.swept[row, start] + bx * ay - by * ax
    total = batch.swept[np.arange(len(start)), batch.size - 1][:, None]
    smaller = 0.5 * np.minimum(swept, total - swept)
    n_edges = end - start
    possible = (smaller > 0) & (squared > 16 * batch.safe[:, None] ** 2) & (end < batch.size[:, None])
    possible &= (n_edges >= 2) & (batch.size[:, None] - n_edges >= 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        cost = np.log(squared / smaller)
    reflex = _reflex(batch.interior)
    return np.where(possible, cost - reflex[row, start] - reflex[row, end], np.inf)


def _first_cost(batch: _Batch, start: np.ndarray, end: np.ndarray, cut_cost: np.ndarray) -> np.ndarray:
    """Cost (P, C) of cuts as chords, but for vertices near them; infinite where they leave the polygon at an end."""
    row = np.arange(len(start))[:, None]
    along = batch.points[row, end] - batch.points[row, start]
    length = np.hypot(along[..., 0], along[..., 1])
    natural = natural_segments(length, batch.spacing[row, start], batch.spacing[row, end], batch.edge_length[:, None])
    n_edges = end - start
    most = np.maximum(np.minimum(n_edges, batch.size[:, None] - n_edges) - 1, 1)
    with np.errstate(divide="ignore"):
        stretch = np.log(natural / np.clip(np.rint(natural), 1, most))
        cost = cut_cost + 2.0 * stretch**2
    direction = np.arctan2(along[..., 1], along[..., 0])
    for slot, heading in ((start, direction), (end, direction + np.pi)):
        first = (heading - batch.onward[row, slot]) % (2 * np.pi)
        second = batch.interior[row, slot] - first
        leaves_inside = (first > 1e-4) & (second > 1e-4)
        cost = np.where(leaves_inside, cost + end_cost(first) + end_cost(second), np.inf)
    return cost


def end_cost(angle: np.ndarray) -> np.ndarray:
    """Cost of an angle at the end of a chord: sharp below 60 degrees, much too sharp below 30, or reflex."""
    sharp = np.maximum(_SIXTY - angle, 0) / _THIRTY
    return sharp**2 + 4.0 * (angle < _THIRTY) + _reflex(angle)


def _reflex(angle: np.ndarray) -> np.ndarray:
    return np.maximum(angle - np.pi, 0) / (0.5 * np.pi)


def _close_cost(batch: _Batch, start: np.ndarray, end: np.ndarray, first_cost: np.ndarray) -> np.ndarray:
    """Further cost (P, C): vertices near the chord; infinite if it is not safely inside the polygon."""
    result = np.full(start.shape, np.inf)
    row, column = np.nonzero(np.isfinite(first_cost))
    for part in np.array_split(np.arange(len(row)), 1 + len(row) * batch.points.shape[1] // _BLOCK):
        r, c = row[part], column[part]
        result[r, c] = _clearance_cost(batch, r, start[r, c], end[r, c])
    return result


def _clearance_cost(batch: _Batch, row: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """`_close_cost` of chords (k,) in the polygons `row` (k,).

    In floating point, but with a margin far above its errors: what passes is certainly inside.
    """
    points, size, safe = batch.points[row], batch.size[row][:, None], batch.safe[row][:, None]
    slot = np.arange(points.shape[1])
    k = np.arange(len(row))
    a = points[k, start]
    along = points[k, end] - a
    length = np.hypot(along[:, 0], along[:, 1])[:, None]
    unit = along / length
    offset = points - a[:, None]
    forward = offset[..., 0] * unit[:, :1] + offset[..., 1] * unit[:, 1:]
    aside = offset[..., 1] * unit[:, :1] - offset[..., 0] * unit[:, 1:]
    beyond = np.maximum(np.maximum(-forward, forward - length), 0.0)
    distance = np.hypot(beyond, aside)
    other = (slot < size) & (slot != start[:, None]) & (slot != end[:, None])
    spacing = graded_spacing(
        np.clip(forward, 0, length),
        length,
        batch.spacing[row, start][:, None],
        batch.spacing[row, end][:, None],
        batch.edge_length[row][:, None],
    )
    relative = np.min(np.where(other, distance / spacing, np.inf), axis=1)
    safe_from_vertices = np.min(np.where(other, distance, np.inf), axis=1) > safe[:, 0]

    following = np.where(slot + 1 < size, slot + 1, 0)
    aside_next, forward_next, other_next = (v[k[:, None], following] for v in (aside, forward, other))
    apart = other & other_next
    opposite = (aside > 0) != (aside_next > 0)
    flat = (np.abs(aside) <= safe) & (np.abs(aside_next) <= safe)
    with np.errstate(divide="ignore", invalid="ignore"):
        meets = forward + aside / (aside - aside_next) * (forward_next - forward)
    crossing = opposite & (meets >= -safe) & (meets <= length + safe)
    along_it = flat & (np.minimum(forward, forward_next) <= length) & (np.maximum(forward, forward_next) >= 0)
    blocked = np.any(apart & (crossing | along_it), axis=1)
    narrow = np.maximum(0.6 - relative, 0) / 0.6
    return np.where(safe_from_vertices & ~blocked, 4.0 * narrow**2 + 2.0 * narrow, np.inf)
