"""Where to cut polygons in two: the choice of one chord between two vertices for each polygon of a batch."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from .diagonals import balanced_diagonal
from .spacing import graded_spacing, natural_segments

# Polygons up to this size consider all pairs of vertices; larger ones all pairs with so many of them.
_ALL_PAIRS = 64
_ENDS = 32
# How many of the pairs with the best first cost are looked at closely, and how many if none of them is possible.
_SHORTLISTS = (24, 600)
# Values of one kind at a time, so that they stay in the processor's cache.
_BLOCK = 1 << 15
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
    """Polygons in local coordinates, with what the costs of many chords have in common.

    All of slots are (P, W + 1): a polygon's vertices, then the first again, as often as there is room.
    """

    x: np.ndarray  # relative to the first vertex
    y: np.ndarray
    size: np.ndarray  # (P, 1)
    edge_length: np.ndarray  # (P, 1)
    safe: np.ndarray  # (P, 1) distance
    spacing: np.ndarray  # mean length of the two edges at each vertex
    onward: np.ndarray  # direction of the edge that leaves the vertex
    interior: np.ndarray  # interior angle
    swept: np.ndarray  # twice the area swept from the first vertex up to this one

    def rows(self, rows: slice | np.ndarray) -> "_Batch":
        """Some of the polygons."""
        return _Batch(*(getattr(self, name)[rows] for name in _Batch.__dataclass_fields__))

    def flat(self, slots: np.ndarray) -> np.ndarray:
        """Slots (P, C) as places in the arrays of slots."""
        return slots + self.x.shape[1] * np.arange(len(self.x))[:, None]


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
        first, second = _best_of_many(batch.rows(open_rows), shortlist)
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
    size = size[:, None]
    inside = np.arange(width + 1) < size
    x, y = np.zeros((n_rows, width + 1)), np.zeros((n_rows, width + 1))
    for axis, own in enumerate((x, y)):
        own[:, :width] = corners[..., axis] - corners[:, :1, axis]
        own[~inside] = 0.0
    last = (np.arange(n_rows), size[:, 0] - 1)
    after_x, after_y, before_x, before_y = (np.roll(own, shift, axis=1) for shift in (-1, 1) for own in (x, y))
    before_x[:, 0], before_y[:, 0] = x[last], y[last]
    leaves_x, leaves_y, comes_x, comes_y = after_x - x, after_y - y, before_x - x, before_y - y
    onward = np.arctan2(leaves_y, leaves_x)
    interior = _around(np.arctan2(comes_y, comes_x) - onward)
    # Padding slots get any positive spacing.
    spacing = np.where(inside, 0.5 * (np.hypot(leaves_x, leaves_y) + np.hypot(comes_x, comes_y)), 1.0)
    swept = np.zeros((n_rows, width + 1))
    np.cumsum((x * after_y - y * after_x)[:, :-1], axis=1, out=swept[:, 1:])
    largest = np.maximum(np.abs(x), np.abs(y)).max(axis=1)
    safe = _SAFE * largest + 64 * np.spacing(np.abs(corners).max(axis=(1, 2)))
    return _Batch(x, y, size, edge_length[:, None], safe[:, None], spacing, onward, interior, swept)


def _around(angle: np.ndarray) -> np.ndarray:
    """Angles from 0 to a full turn."""
    return angle - 2 * np.pi * np.floor(angle / (2 * np.pi))


def _best_of_many(batch: _Batch, shortlist: int) -> tuple[np.ndarray, np.ndarray]:
    """The best chord (P,), (P,) of each polygon among the `shortlist` pairs of the lowest first cost, or -1, -1."""
    n_rows, width = len(batch.x), batch.x.shape[1] - 1
    n_pairs = width * (width - 1) // 2 if width <= _ALL_PAIRS else width * _ENDS
    first, second = np.empty(n_rows, dtype=np.int64), np.empty(n_rows, dtype=np.int64)
    at_a_time = max(1, _BLOCK // n_pairs)
    for rows in (slice(k, k + at_a_time) for k in range(0, n_rows, at_a_time)):
        block = batch.rows(rows)
        start, end = _pairs(block)
        most = max(4 * shortlist, start.shape[1] // 5)
        start, end, cost = _keep_best(most, start, end, _cut_cost(block, start, end))
        start, end, cost = _keep_best(shortlist, start, end, _first_cost(block, start, end, cost))
        cost = cost + _close_cost(block, start, end, cost)
        row, best = np.arange(len(cost)), np.argmin(cost, axis=1)
        possible = np.isfinite(cost[row, best])
        first[rows], second[rows] = (np.where(possible, slots[row, best], -1) for slots in (start, end))
    return first, second


@cache
def _all_pairs(width: int) -> tuple[np.ndarray, np.ndarray]:
    return np.triu_indices(width, 1)


def _pairs(batch: _Batch) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of vertex slots to consider, (P, C) and (P, C); padding slots among them."""
    n_rows, width = len(batch.x), batch.x.shape[1] - 1
    if width <= _ALL_PAIRS:
        start, end = _all_pairs(width)
        return np.broadcast_to(start, (n_rows, len(start))), np.broadcast_to(end, (n_rows, len(end)))
    # Half of the ends where the polygon turns inwards most, half evenly spaced.
    half = _ENDS // 2
    inside = np.arange(width) < batch.size
    reflex = np.argsort(np.where(inside, -batch.interior[:, :width], 0.0), axis=1, kind="stable")[:, :half]
    even = np.arange(half) * batch.size // half
    ends = np.concatenate([reflex, even], axis=1)
    start = np.repeat(ends, width, axis=1)
    end = np.broadcast_to(np.tile(np.arange(width), 2 * half), start.shape)
    return np.minimum(start, end), np.maximum(start, end)


def _keep_best(n: int, start: np.ndarray, end: np.ndarray, cost: np.ndarray):
    """The n columns of lowest cost in each row of (P, C) arrays."""
    if cost.shape[1] <= n:
        return start, end, cost
    best = np.argpartition(cost, n, axis=1)[:, :n]
    row = np.arange(len(cost))[:, None]
    return start[row, best], end[row, best], cost[row, best]


def _cut_cost(batch: _Batch, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Cost (P, C) of cuts: low for short ones between large parts and at reflex corners; infinite if impossible."""
    first, second = batch.flat(start), batch.flat(end)
    ax, ay, bx, by = (own.take(at) for at in (first, second) for own in (batch.x, batch.y))
    squared = (bx - ax) ** 2 + (by - ay) ** 2
    swept = batch.swept.take(second) - batch.swept.take(first) + (bx * ay - by * ax)
    smaller = 0.5 * np.minimum(swept, batch.swept[:, -1:] - swept)
    n_edges = end - start
    possible = (smaller > 0) & (squared > 16 * batch.safe**2) & (end < batch.size)
    possible &= (n_edges >= 2) & (batch.size - n_edges >= 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        cost = np.log(squared / smaller)
    reflex = _reflex(batch.interior)
    return np.where(possible, cost - reflex.take(first) - reflex.take(second), np.inf)


def _first_cost(batch: _Batch, start: np.ndarray, end: np.ndarray, cut_cost: np.ndarray) -> np.ndarray:
    """Cost (P, C) of cuts as chords, but for vertices near them; infinite where they leave the polygon at an end."""
    first, second = batch.flat(start), batch.flat(end)
    along_x, along_y = (own.take(second) - own.take(first) for own in (batch.x, batch.y))
    length = np.hypot(along_x, along_y)
    natural = natural_segments(length, batch.spacing.take(first), batch.spacing.take(second), batch.edge_length)
    n_edges = end - start
    most = np.maximum(np.minimum(n_edges, batch.size - n_edges) - 1, 1)
    with np.errstate(divide="ignore"):
        stretch = np.log(natural / np.minimum(np.maximum(np.rint(natural), 1), most))
        cost = cut_cost + 2.0 * stretch**2
    direction = np.arctan2(along_y, along_x)
    for slot, heading in ((first, direction), (second, direction + np.pi)):
        before = _around(heading - batch.onward.take(slot))
        behind = batch.interior.take(slot) - before
        leaves_inside = (before > 1e-4) & (behind > 1e-4)
        cost = np.where(leaves_inside, cost + end_cost(before) + end_cost(behind), np.inf)
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
    at_a_time = max(1, _BLOCK // batch.x.shape[1])
    for part in (slice(k, k + at_a_time) for k in range(0, len(row), at_a_time)):
        r, c = row[part], column[part]
        result[r, c] = _clearance_cost(batch, r, start[r, c], end[r, c])
    return result


def _clearance_cost(batch: _Batch, row: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """`_close_cost` of chords (k,) in the polygons `row` (k,).

    In floating point, but with a margin far above its errors: what passes is certainly inside.
    """
    x, y, size, safe = batch.x[row], batch.y[row], batch.size[row], batch.safe[row]
    k = np.arange(len(row))
    x, y = x - x[k, start][:, None], y - y[k, start][:, None]
    unit_x, unit_y = x[k, end][:, None], y[k, end][:, None]
    length = np.hypot(unit_x, unit_y)
    unit_x, unit_y = unit_x / length, unit_y / length
    forward, aside = x * unit_x + y * unit_y, y * unit_x - x * unit_y
    nearest = np.minimum(np.maximum(forward, 0.0), length)
    squared = (forward - nearest) ** 2 + aside * aside
    away = np.arange(x.shape[1]) < size  # neither an end of the chord nor padding
    away[k, start] = away[k, end] = False
    squared[~away] = np.inf
    at_start, at_end = (batch.spacing[row, slot][:, None] for slot in (start, end))
    spacing = graded_spacing(nearest, length, at_start, at_end, batch.edge_length[row])
    relative = np.sqrt(np.min(squared / (spacing * spacing), axis=1))
    safe_from_vertices = squared.min(axis=1) > safe[:, 0] ** 2

    # Edges, from each slot to the next, that are not next to an end of the chord.
    apart = away.copy()
    apart[k, np.where(start > 0, start, size[:, 0]) - 1] = apart[k, end - 1] = False
    apart, before, behind = apart[:, :-1], slice(0, -1), slice(1, None)
    crosses = (aside[:, before] > 0) != (aside[:, behind] > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = aside[:, before] / (aside[:, before] - aside[:, behind])
        meets = forward[:, before] + share * (forward[:, behind] - forward[:, before])
    crosses &= (meets >= -safe) & (meets <= length + safe)
    flat = np.abs(aside) <= safe
    along_it = flat[:, before] & flat[:, behind]
    along_it &= np.minimum(forward[:, before], forward[:, behind]) <= length
    along_it &= np.maximum(forward[:, before], forward[:, behind]) >= 0
    blocked = (apart & (crosses | along_it)).any(axis=1)
    narrow = np.maximum(0.6 - relative, 0) / 0.6
    return np.where(safe_from_vertices & ~blocked, 4.0 * narrow**2 + 2.0 * narrow, np.inf)
