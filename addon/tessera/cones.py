"""The lower envelope of cones: the smallest of value + slope · distance over many places, exact, without asking all.

The places are points and segments, in a balanced tree of boxes. Questions go down the tree in groups of near ones, all
groups together, a level at a time; a box is left where even its nearest corner gives none of them anything smaller than
what is known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_LEAF = 8
_GROUP = 8  # points that go down the tree as one
_LEAP = 3.0  # times the mean distance of points beside each other: farther apart, they are in two groups
# Groups that go down the tree together: bounds the memory.
_BLOCK = 1 << 10
# Rounding must not leave out a box, or the last bit would depend on the shape of the tree.
_MARGIN = 1 - 1e-12


@dataclass(frozen=True)
class Places:
    """Segments from `start` to `end` (k, 2), equal for points; the value, slope and domain (int) of each (k,)."""

    start: np.ndarray
    end: np.ndarray
    value: np.ndarray
    slope: np.ndarray
    domain: np.ndarray

    def rows(self, rows: np.ndarray) -> Places:
        """The chosen places."""
        return Places(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


@dataclass(frozen=True)
class Cones:
    """A tree over places, in leaves of `_LEAF`; of each level's nodes, from the root, the boxes and smallest numbers.

    places: as the leaves have them, with repeats of the last; number: of each among the given ones, -1 for repeats.
    levels: (low (n, 3), high (n, 3), value (n,), slope (n,), best (n,)): boxes in x, y and domain; best is the place of
    the smallest value.
    """

    places: Places
    number: np.ndarray
    levels: tuple[tuple[np.ndarray, ...], ...]


def join_places(parts: list[Places]) -> Places:
    """All places of several lists."""
    return Places(*(np.concatenate([getattr(part, name) for part in parts]) for name in Places.__dataclass_fields__))


def build_cones(places: Places) -> Cones | None:
    """The tree, or None of no places."""
    n = len(places.value)
    if n == 0:
        return None
    depth = max(0, int(np.ceil(np.log2(n / _LEAF))))
    width = _LEAF << depth
    # Padding repeats the last place, which changes no minimum.
    order = np.arange(width)[None]
    middle = np.column_stack([0.5 * (places.start + places.end), places.domain])
    middle = middle[np.minimum(order[0], n - 1)]
    for _ in range(depth):
        here = middle[order]
        extent = np.ptp(here, axis=1)
        axis = np.where(extent[:, 2] > 0, 2, np.argmax(extent[:, :2], axis=1))
        along = np.take_along_axis(here, axis[:, None, None], axis=2)[..., 0]
        order = np.take_along_axis(order, np.argsort(along, axis=1, kind="stable"), axis=1)
        order = order.reshape(2 * len(order), -1)
    number = np.where(order.ravel() < n, order.ravel(), -1)
    places = places.rows(number)
    low = np.column_stack([np.minimum(places.start, places.end), places.domain])
    high = np.column_stack([np.maximum(places.start, places.end), places.domain])
    levels = []
    for level in range(depth + 1):
        nodes = 1 << level
        value = places.value.reshape(nodes, -1)
        best = value.argmin(axis=1) + np.arange(nodes) * value.shape[1]
        levels.append(
            (
                low.reshape(nodes, -1, 3).min(axis=1),
                high.reshape(nodes, -1, 3).max(axis=1),
                value.min(axis=1),
                places.slope.reshape(nodes, -1).min(axis=1),
                best,
            )
        )
    return Cones(places, number, tuple(levels))


def lowest(cones: Cones | None, points: np.ndarray, domain: np.ndarray, most: np.ndarray) -> np.ndarray:
    """(n,) the smallest value + slope · distance of the places of each point's domain, or `most` where that is less.

    points: (n, 2); domain: (n,) int; most: (n,).
    """
    found = np.array(most, dtype=np.float64)
    if cones is None or not len(points):
        return found
    groups = _groups(points, domain)
    for first in range(0, len(groups), _BLOCK):
        rows = groups[first : first + _BLOCK]
        found[rows] = _descend(cones, points[rows], domain[rows[:, 0]], found[rows])
    return found


def _groups(points: np.ndarray, domain: np.ndarray) -> np.ndarray:
    """(G, `_GROUP`) rows of points near each other, of one domain; the last of a group again where it has fewer."""
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    cell = ((points - low) / np.where(extent > 0, extent, 1) * 65535).astype(np.uint64)
    # Along a curve that fills the plane: the bits of x and y in turn.
    for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
        cell = (cell | (cell << np.uint64(shift))) & np.uint64(mask)
    order = np.lexsort((cell[:, 0] | (cell[:, 1] << np.uint64(1)), domain))
    # The curve leaps here and there, and a group across a leap would have all of the tree before it.
    leap = np.hypot(*np.diff(points[order], axis=0).T)
    first = np.flatnonzero(np.append(True, (np.diff(domain[order]) != 0) | (leap * len(leap) > _LEAP * leap.sum())))
    count = np.diff(first, append=len(order))
    groups = -(-count // _GROUP)
    of = np.repeat(np.arange(len(groups)), groups)
    start = (np.arange(len(of)) - np.repeat(np.cumsum(groups) - groups, groups)) * _GROUP
    return order[np.minimum(first[of, None] + start[:, None] + np.arange(_GROUP), (first + count - 1)[of, None])]


def _descend(cones: Cones, points: np.ndarray, domain: np.ndarray, most: np.ndarray) -> np.ndarray:
    """`lowest` (G, K) of groups of points (G, K, 2) of domains (G,); pairs of group and node stay sorted by group."""
    left, right, limit = points.min(axis=1), points.max(axis=1), most.max(axis=1)
    group, node = np.arange(len(points)), np.zeros(len(points), dtype=np.int64)
    for level, (low, high, value, slope, best) in enumerate(cones.levels):
        if level:
            group, node = np.repeat(group, 2), np.repeat(2 * node, 2)
            node[1::2] += 1
        away = np.maximum(np.maximum(low[node, :2] - right[group], left[group] - high[node, :2]), 0)
        bound = value[node] + slope[node] * np.hypot(away[:, 0], away[:, 1])
        there = (domain[group] >= low[node, 2]) & (domain[group] <= high[node, 2])
        near = there & (_MARGIN * bound < limit[group])
        group, node = group[near], node[near]
        if not len(group):
            return most
        # No point of the group gets more than the best place gives to the farthest corner of its box.
        place = best[node]
        far = np.maximum(right[group] - cones.places.start[place], cones.places.start[place] - left[group])
        reach = cones.places.value[place] + cones.places.slope[place] * np.hypot(far[:, 0], far[:, 1])
        reach = np.where(cones.places.domain[place] == domain[group], reach, np.inf)
        first = np.flatnonzero(np.diff(group, prepend=-1))
        limit[group[first]] = np.minimum(limit[group[first]], np.minimum.reduceat(reach, first))
    place = node[:, None, None] * _LEAF + np.arange(_LEAF)
    found = _heights(cones.places, place, points[group][:, :, None], domain[group][:, None, None]).min(axis=2)
    first = np.flatnonzero(np.diff(group, prepend=-1))
    lowest_yet = most.copy()
    lowest_yet[group[first]] = np.minimum(most[group[first]], np.minimum.reduceat(found, first, axis=0))
    return lowest_yet


def _heights(places: Places, place: np.ndarray, points: np.ndarray, domain: np.ndarray) -> np.ndarray:
    """What places (...) give at points (..., 2), inf to those of other domains (...)."""
    start = places.start[place]
    along_x, along_y = np.moveaxis(places.end[place] - start, -1, 0)
    x, y = np.moveaxis(points, -1, 0)
    x, y = x - start[..., 0], y - start[..., 1]
    squared = along_x * along_x + along_y * along_y
    share = np.clip((x * along_x + y * along_y) / np.where(squared > 0, squared, 1), 0, 1)
    height = places.value[place] + places.slope[place] * np.hypot(x - share * along_x, y - share * along_y)
    return np.where(places.domain[place] == domain, height, np.inf)


def within(cones: Cones, points: np.ndarray, radius: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which places, all of them points, are within a radius (n,) of points (n, 2).

    Returns pairs, sorted by point: the point (p,), the number of the place (p,), their distance (p,).
    """
    query, node = np.arange(len(points)), np.zeros(len(points), dtype=np.int64)
    for level, (low, high, *_) in enumerate(cones.levels):
        if level:
            query, node = np.repeat(query, 2), np.repeat(2 * node, 2)
            node[1::2] += 1
        x = points[query]
        away = np.maximum(np.maximum(low[node, :2] - x, x - high[node, :2]), 0)
        near = np.hypot(away[:, 0], away[:, 1]) <= radius[query]
        query, node = query[near], node[near]
    place = (node[:, None] * _LEAF + np.arange(_LEAF)).ravel()
    query = np.repeat(query, _LEAF)
    away = np.hypot(*(points[query] - cones.places.start[place]).T)
    near = (away <= radius[query]) & (cones.number[place] >= 0)
    return query[near], cones.number[place[near]], away[near]
