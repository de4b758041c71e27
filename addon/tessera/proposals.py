"""The bridge that each of many vertices would take next, by itself: to the best of the closest vertices that it sees.

All of them are looked for at once. A vertex's window is as large as the vertices around it are sparse, and is doubled
until it sees something in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .chords import end_cost
from .nearby import Boxes, along_curve, build_boxes, meeting, runs
from .predicates import segments_cross
from .spacing import GRADING, Target, graded_spacing, natural_segments, points_between, wanted_along

# So many of the closest vertices are looked at, or if none of them is seen, of the next ones.
_AT_ONCE = 32
# Bridges should not come as near to vertices as so many spacings.
_NARROW = 0.6
# Vertices whose windows are looked at together, and pairs in them: bounds the memory.
_BLOCK, _PAIRS = 1 << 10, 1 << 22


@dataclass(frozen=True)
class Net:
    """What bounds domains, and bridges: points (n, 2), their spacing (n,) and group (n,), and segments (e,).

    Segments run from `start` to `end`, by number of point; a point by itself is one to itself. Groups are numbered from
    0, and each is a domain of its own.
    """

    points: np.ndarray
    spacing: np.ndarray
    group: np.ndarray
    start: np.ndarray
    end: np.ndarray

    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """The left and the right end (k,) of each segment that is not upright."""
        x = self.points[:, 0]
        rises = np.sign(x[self.end] - x[self.start])
        left, right = np.where(rises > 0, [self.start, self.end], [self.end, self.start])[:, rises != 0]
        return left, right


@dataclass(frozen=True)
class Wanted:
    """The edge length that groups want: the longest (g,), and the target of the region (g,) of each, if there is one.

    turned: 1 or -1, what points must be multiplied by to be where they are.
    """

    longest: np.ndarray
    region: np.ndarray
    target: Target | None
    turned: float = 1.0

    def along(self, start: np.ndarray, end: np.ndarray, group: np.ndarray) -> np.ndarray:
        """The target along cuts from start to end (k, 2) of groups (k,): (k, 1) or (k, steps)."""
        if self.target is None:
            return self.longest[group][:, None]
        return wanted_along(self.turned * start, self.turned * end, self.region[group], self.target)


@dataclass(frozen=True)
class Proposals:
    """Bridges from `tip` to `goal` (k,), in `count` (k,) segments, with the new vertices of one after the other."""

    tip: np.ndarray
    goal: np.ndarray
    count: np.ndarray
    added: np.ndarray


@dataclass(frozen=True)
class _Place:
    """A net with its boxes and, for each point, the directions of the segments there: `first` and `count` of `angle`.

    extent: (g,) the longer side of each group's box.
    """

    net: Net
    boxes: Boxes
    extent: np.ndarray
    angle: np.ndarray
    first: np.ndarray
    count: np.ndarray


def propose(net: Net, tips: np.ndarray, wanted: Wanted) -> Proposals:
    """The bridge to the left of each of `tips` (k,), which see a vertex farther left."""
    place = _prepare(net)
    reach = _first_reach(net, tips)
    goal = np.full(len(tips), -1)
    (open_,) = np.nonzero(goal < 0)
    while len(open_):
        for part in np.array_split(open_, 1 + len(open_) // _BLOCK):
            goal[part] = _goals(place, tips[part], reach[part], wanted.longest)
        open_ = open_[goal[open_] < 0]
        if (reach[open_] >= 4 * place.extent[net.group[tips[open_]]]).any():
            raise AssertionError("a hole's leftmost vertex sees one farther left")
        reach[open_] *= 2
    return _with_points(place, tips, goal, wanted)


def _prepare(net: Net) -> _Place:
    low, high = segment_boxes(net.points, net.start, net.end)
    left = np.lexsort((net.points[:, 0], net.group))
    count = np.bincount(net.group)
    ends = np.cumsum(count)
    corners = [p[left] for p in net.points.T]
    extent = [np.maximum.reduceat(p, ends - count) - np.minimum.reduceat(p, ends - count) for p in corners]
    real = net.start != net.end
    one = np.concatenate([net.start[real], net.end[real]])
    other = np.concatenate([net.end[real], net.start[real]])
    order = np.argsort(one, kind="stable")
    x, y = (net.points[other] - net.points[one])[order].T
    count = np.bincount(one, minlength=len(net.points))
    boxes = build_boxes(low, high, net.group[net.start])
    return _Place(net, boxes, np.maximum(*extent), np.arctan2(y, x), np.cumsum(count) - count, count)


def segment_boxes(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lower and upper corners (e, 2) of the segments' bounding boxes."""
    return np.minimum(points[start], points[end]), np.maximum(points[start], points[end])


def _first_reach(net: Net, tips: np.ndarray) -> np.ndarray:
    """(k,) twice as far from each tip as `_AT_ONCE` vertices of its group are, or a little farther."""
    order = along_curve(net.points, net.group)
    position = np.empty(len(order), dtype=np.int64)
    position[order] = np.arange(len(order))
    count = np.bincount(net.group)
    last = np.cumsum(count)[net.group[tips]] - 1
    near = position[tips][:, None] + np.arange(-2 * _AT_ONCE, 2 * _AT_ONCE + 1)
    near = order[np.clip(near, (last - count[net.group[tips]] + 1)[:, None], last[:, None])]
    away = np.hypot(*np.moveaxis(net.points[near] - net.points[tips][:, None], -1, 0))
    return 2 * np.maximum(np.partition(away, _AT_ONCE, axis=1)[:, _AT_ONCE], net.spacing[tips])


def _goals(place: _Place, tips: np.ndarray, reach: np.ndarray, longest: np.ndarray) -> np.ndarray:
    """(k,) what each tip's best bridge of its window leads to, or -1 where the window must be larger."""
    net, here = place.net, place.net.points[tips]
    r = reach[:, None]
    of, segment = meeting(place.boxes, here - r, here + r * [0, 1], net.group[tips])
    near_of, near, away = _vertices(net, tips, of, segment, reach)
    # What is as close to a bridge as its half is in the window, too.
    (close,) = np.nonzero(away <= 0.5 * reach[near_of])
    order = close[np.lexsort((near[close], away[close], near_of[close]))]
    count = np.bincount(near_of[order], minlength=len(tips))
    rank = np.arange(len(order)) - (np.cumsum(count) - count)[near_of[order]]
    seen, open_, chunk = [], count > 0, 0
    while open_.any():
        rows = order[(rank // _AT_ONCE == chunk) & open_[near_of[order]]]
        rows = rows[~_hidden(net, tips[near_of[rows]], near[rows], near_of[rows], of, segment, len(tips))]
        seen.append(rows)
        chunk += 1
        open_ &= count > chunk * _AT_ONCE
        open_[near_of[rows]] = False
    seen = np.concatenate([np.zeros(0, dtype=np.int64), *seen])
    seen = seen[np.lexsort((near[seen], away[seen], near_of[seen]))]
    goal = np.full(len(tips), -1)
    if len(seen):
        cost = _costs(place, tips, near_of[seen], near[seen], near_of, near, longest)
        best = np.lexsort((np.arange(len(seen)), cost, near_of[seen]))
        best = best[np.flatnonzero(np.diff(near_of[seen[best]], prepend=-1))]
        goal[near_of[seen[best]]] = near[seen[best]]
        # With few to choose from, a little farther there may be better ones.
        closest = seen[np.flatnonzero(np.diff(near_of[seen], prepend=-1))]
        few = (count[near_of[closest]] < _AT_ONCE) & (away[closest] > 0.25 * reach[near_of[closest]])
        few &= reach[near_of[closest]] < 4 * place.extent[net.group[tips[near_of[closest]]]]
        goal[near_of[closest[few]]] = -1
    return goal


def _vertices(net: Net, tips: np.ndarray, of: np.ndarray, segment: np.ndarray, reach: np.ndarray):
    """The vertices of tips' windows that are farther left: the tip (k,), the vertex (k,) and its distance (k,)."""
    n = len(net.points)
    ends = np.concatenate([net.start[segment], net.end[segment]])
    of, near = np.divmod(np.unique(np.concatenate([of, of]) * n + ends), n)
    away = net.points[near] - net.points[tips[of]]
    inside = (away[:, 0] < 0) & (np.abs(away).max(axis=1) <= reach[of])
    return of[inside], near[inside], np.hypot(*away[inside].T)


def _hidden(net: Net, tip, vertex, of, segment_of, segment, n_tips: int) -> np.ndarray:
    """(k,) whether vertices (k,) are hidden from tips (k,), by the segments of the tips' windows."""
    points, hidden = net.points, np.zeros(len(tip), dtype=bool)
    low, high = segment_boxes(points, tip, vertex)
    lowest, highest = segment_boxes(points, net.start[segment], net.end[segment])
    for one, other in _with_all_of(of, segment_of, n_tips):
        meet = np.ones(len(one), dtype=bool)
        for axis in (0, 1):
            meet &= lowest[other, axis] <= high[one, axis]
            meet &= highest[other, axis] >= low[one, axis]
        one, other = one[meet], segment[other[meet]]
        ends = points[tip[one]], points[vertex[one]], points[net.start[other]], points[net.end[other]]
        hidden[one[segments_cross(*ends)]] = True
    return hidden


def _with_all_of(of: np.ndarray, other_of: np.ndarray, n: int) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Pairs of each row of `of` (k,) with all rows of `other_of`, sorted, that have the same number of n; in blocks."""
    count = np.bincount(other_of, minlength=n)
    first, count = (np.cumsum(count) - count)[of], count[of]
    block = (np.cumsum(count) - count) // _PAIRS
    for rows in np.split(np.arange(len(of)), np.flatnonzero(np.diff(block)) + 1):
        run, other = runs(first[rows], count[rows])
        yield rows[run], other


def _costs(place: _Place, tips, of, seen, near_of, near, longest: np.ndarray) -> np.ndarray:
    """Cost (k,) of bridges from tips[of] to the vertices `seen`: long, stretched, sharp at their ends or near others.

    near_of, near: the vertices in each tip's window, sorted by tip.
    """
    net, tip = place.net, tips[of]
    edge_length = longest[net.group[tip]]
    along = net.points[seen] - net.points[tip]
    length = np.hypot(along[:, 0], along[:, 1])
    natural = natural_segments(length, net.spacing[tip], net.spacing[seen], edge_length)
    cost = 2 * np.log(length) + 2 * np.log(natural / np.maximum(np.rint(natural), 1)) ** 2
    for vertex, toward in ((tip, along), (seen, -along)):
        for gap in _gaps(place, vertex, toward):
            cost += end_cost(gap)
    relative = np.full(len(seen), np.inf)
    # The spacing along a bridge is nowhere more than this.
    most = np.maximum(net.spacing[tip], net.spacing[seen]) + 0.5 * GRADING * length
    low, high = segment_boxes(net.points, tip, seen)
    low, high = low - _NARROW * most[:, None], high + _NARROW * most[:, None]
    for one, other in _with_all_of(of, near_of, len(tips)):
        other = near[other]
        close = other != seen[one]
        for axis in (0, 1):
            place = net.points[other, axis]
            close &= (place >= low[one, axis]) & (place <= high[one, axis])
        one, other = one[close], other[close]
        offset = net.points[other] - net.points[tip[one]]
        unit, whole = along[one] / length[one, None], length[one]
        forward = offset[:, 0] * unit[:, 0] + offset[:, 1] * unit[:, 1]
        aside = np.abs(unit[:, 0] * offset[:, 1] - unit[:, 1] * offset[:, 0])
        beyond = np.maximum(np.maximum(-forward, forward - whole), 0)
        ends = net.spacing[tip[one]], net.spacing[seen[one]]
        spacing = graded_spacing(np.clip(forward, 0, whole), whole, *ends, edge_length[one])
        np.minimum.at(relative, one, np.hypot(beyond, aside) / spacing)
    narrow = np.maximum(_NARROW - relative, 0) / _NARROW
    return cost + 4 * narrow**2 + 2 * narrow


def _gaps(place: _Place, vertex: np.ndarray, toward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles (k,) from a direction (k, 2) at a vertex (k,) to the next segments there, to its left and to its right."""
    heading = np.arctan2(toward[:, 1], toward[:, 0])
    of, spoke = runs(place.first[vertex], place.count[vertex])
    angle = (place.angle[spoke] - heading[of]) % (2 * np.pi)
    left, right = np.full((2, len(vertex)), 2 * np.pi)
    np.minimum.at(left, of, angle)
    np.minimum.at(right, of, 2 * np.pi - angle)
    return left, right


def _with_points(place: _Place, tip: np.ndarray, goal: np.ndarray, wanted: Wanted) -> Proposals:
    """Bridges with their new vertices; without any where, rounded, they could spoil them."""
    net = place.net
    start, end = net.points[tip], net.points[goal]
    most = np.full(len(tip), np.iinfo(np.int64).max)
    along = wanted.along(start, end, net.group[tip])
    count, added = points_between(start, end, net.spacing[tip], net.spacing[goal], most, along)
    of = np.repeat(np.arange(len(tip)), count - 1)
    low, high = np.minimum(start, end)[of, 1], np.maximum(start, end)[of, 1]
    added[:, 1] = np.clip(added[:, 1], low, high)
    bridges = Proposals(tip, goal, count, added)
    bridge, a, b = pieces(net, bridges)
    spoiled = np.zeros(len(tip), dtype=bool)
    spoiled[bridge[b[:, 0] >= a[:, 0]]] = True
    piece, segment = meeting(place.boxes, np.minimum(a, b), np.maximum(a, b), net.group[tip[bridge]])
    c, d = net.points[net.start[segment]], net.points[net.end[segment]]
    a, b = a[piece], b[piece]
    distinct = (a != b).any(axis=1)
    crossed = np.zeros(len(piece), dtype=bool)
    crossed[distinct] = segments_cross(a[distinct], b[distinct], c[distinct], d[distinct])
    last = np.append(np.diff(bridge), 1)[piece] > 0
    there = ~last & ((b == c).all(axis=1) | (b == d).all(axis=1))
    spoiled[bridge[piece[crossed | there]]] = True
    return Proposals(tip, goal, np.where(spoiled, 1, count), added[~spoiled[of]])


def pieces(net: Net, bridges: Proposals) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The segments of bridges: whose they are (s,), and from where to where (s, 2), (s, 2), from each tip on."""
    count = bridges.count
    of, step = runs(np.zeros(len(count), dtype=np.int64), count)
    first = np.cumsum(count - 1) - (count - 1)
    inner = first[of] + step
    points = np.concatenate([bridges.added, np.zeros((1, 2))])
    begin = np.where((step == 0)[:, None], net.points[bridges.tip[of]], points[np.where(step > 0, inner - 1, -1)])
    last = step == count[of] - 1
    end = np.where(last[:, None], net.points[bridges.goal[of]], points[np.where(last, -1, inner)])
    return of, begin, end
