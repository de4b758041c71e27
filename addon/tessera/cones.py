"""The lower envelope of cones: the smallest of value + slope · distance over many places, exact, without asking all.

The places are points and segments, in a balanced tree of boxes. All questions go down the tree together, a level at a
time; a box is left where even its nearest corner could give nothing smaller than what is known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_LEAF = 8
# Questions that go down the tree together: bounds the memory.
_BLOCK = 1 << 15
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
    lowest_yet = np.array(most, dtype=np.float64)
    if cones is None:
        return lowest_yet
    for first in range(0, len(points), _BLOCK):
        part = slice(first, first + _BLOCK)
        lowest_yet[part] = _descend(cones, points[part], domain[part], lowest_yet[part])
    return lowest_yet


def _descend(cones: Cones, points: np.ndarray, domain: np.ndarray, lowest_yet: np.ndarray) -> np.ndarray:
    """`lowest` for one block; the pairs of a point and a node stay sorted by point."""
    query, node = np.arange(len(points)), np.zeros(len(points), dtype=np.int64)
    for level, (low, high, value, slope, best) in enumerate(cones.levels):
        if level:
            query, node = np.repeat(query, 2), np.repeat(2 * node, 2)
            node[1::2] += 1
        x, z = points[query], domain[query]
        away = np.maximum(np.maximum(low[node, :2] - x, x - high[node, :2]), 0)
        bound = value[node] + slope[node] * np.hypot(away[:, 0], away[:, 1])
        near = (z >= low[node, 2]) & (z <= high[node, 2]) & (_MARGIN * bound < lowest_yet[query])
        query, node = query[near], node[near]
        lowest_yet = _lower(lowest_yet, query, cones.places, best[node], points, domain)
    place = (node[:, None] * _LEAF + np.arange(_LEAF)).ravel()
    return _lower(lowest_yet, np.repeat(query, _LEAF), cones.places, place, points, domain)


def _lower(lowest_yet, query, places: Places, place, points, domain) -> np.ndarray:
    """The smallest numbers after these pairs of a point and a place, sorted by point, have had their say."""
    if len(query) == 0:
        return lowest_yet
    start, along = places.start[place], places.end[place] - places.start[place]
    offset = points[query] - start
    squared = along[:, 0] ** 2 + along[:, 1] ** 2
    dot = offset[:, 0] * along[:, 0] + offset[:, 1] * along[:, 1]
    share = np.clip(dot / np.where(squared > 0, squared, 1), 0, 1)
    away = np.hypot(offset[:, 0] - share * along[:, 0], offset[:, 1] - share * along[:, 1])
    found = places.value[place] + places.slope[place] * away
    found = np.where(places.domain[place] == domain[query], found, np.inf)
    first = np.flatnonzero(np.diff(query, prepend=-1))
    lowest_yet = lowest_yet.copy()
    lowest_yet[query[first]] = np.minimum(lowest_yet[query[first]], np.minimum.reduceat(found, first))
    return lowest_yet


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
