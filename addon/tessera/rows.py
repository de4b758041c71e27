"""Many points in faces: rows of bridges through them, all at once, so that few are left to be looked for one by one.

A face is taken in strips from left to right, as high as points are apart. The points of a strip, by x and then y,
make a path that meets no other strip's; what of it meets an edge of the face is left out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .crossings import crossing_pairs
from .proposals import Net, Wanted
from .spacing import points_between

# Times the mean distance of points: a row's bridges are about as long as rows are apart.
_HEIGHT = 1.0


def with_rows(net: Net, alone: np.ndarray, wanted: Wanted) -> Net:
    """A net with bridges between points (k,) by number, that no other segment has."""
    if not len(alone):
        return net
    _, of, count = np.unique(net.group[alone], return_inverse=True, return_counts=True)
    low, high = np.full((len(count), 2), np.inf), np.full((len(count), 2), -np.inf)
    np.minimum.at(low, of, net.points[alone])
    np.maximum.at(high, of, net.points[alone])
    size = np.maximum(high - low, 1e-3 * (high - low).max(axis=1, keepdims=True))
    height = _HEIGHT * np.sqrt(np.prod(size, axis=1) / count)
    x, y = net.points[alone].T
    strip = np.floor((y - low[of, 1]) / height[of])
    order = np.lexsort((y, x, strip, of))
    together = (np.diff(strip[order]) == 0) & (np.diff(of[order]) == 0)
    ends = np.column_stack([alone[order[:-1]], alone[order[1:]]])[together]
    ends = ends[~_meeting(net, net.points, ends, net.group[ends[:, 0]])]
    start, end, group = net.points[ends[:, 0]], net.points[ends[:, 1]], net.group[ends[:, 0]]
    most = np.full(len(ends), np.iinfo(np.int64).max)
    along = wanted.along(start, end, group)
    count, added = points_between(start, end, net.spacing[ends[:, 0]], net.spacing[ends[:, 1]], most, along)
    points, parts, bridge = _divided(net.points, ends, count, added)
    # Rounded, new vertices could be where they must not.
    x, y = (points[parts[:, 1]] - points[parts[:, 0]]).T
    spoiled = np.zeros(len(ends), dtype=bool)
    spoiled[bridge[_meeting(net, points, parts, group[bridge]) | (x < 0) | ((x == 0) & (y <= 0))]] = True
    kept = np.repeat(~spoiled, count - 1)
    points, parts, _ = _divided(net.points, ends, np.where(spoiled, 1, count), added[kept])
    length = np.linalg.norm(points[parts[:, 1]] - points[parts[:, 0]], axis=1)
    n = len(points)
    spacing = np.bincount(parts.ravel(), np.repeat(length, 2), minlength=n)
    spacing = 0.5 * spacing[len(net.points) :]
    return replace(
        net,
        points=points,
        spacing=np.concatenate([net.spacing, spacing]),
        group=np.concatenate([net.group, np.repeat(group, np.where(spoiled, 1, count) - 1)]),
        start=np.concatenate([net.start, parts[:, 0]]),
        end=np.concatenate([net.end, parts[:, 1]]),
    )


def _divided(
    points: np.ndarray, ends: np.ndarray, count: np.ndarray, added: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points with those added, segments (s, 2) of bridges (k, 2), `count` (k,) of each, and their bridge (s,)."""
    bridge = np.repeat(np.arange(len(ends)), count)
    step = np.arange(len(bridge)) - np.repeat(np.cumsum(count) - count, count)
    first = len(points) + np.cumsum(count - 1) - (count - 1)
    start = np.where(step == 0, ends[bridge, 0], first[bridge] + step - 1)
    end = np.where(step == count[bridge] - 1, ends[bridge, 1], first[bridge] + step)
    return np.concatenate([points, added]), np.column_stack([start, end]), bridge


def _meeting(net: Net, points: np.ndarray, parts: np.ndarray, group: np.ndarray) -> np.ndarray:
    """(s,) which segments (s, 2) of groups (s,) meet the net's, or each other, but at common ends."""
    ends = np.concatenate([np.column_stack([net.start, net.end]), parts])
    group = np.concatenate([net.group[net.start], group])
    # What has a length comes first, as `crossing_pairs` wants it.
    order = np.argsort(ends[:, 0] == ends[:, 1], kind="stable")
    start, end = points[ends[order, 0]], points[ends[order, 1]]
    pairs = order[crossing_pairs(start, end, group[order])]
    bad = np.zeros(len(ends), dtype=bool)
    bad[pairs.ravel()] = True
    return bad[len(net.start) :]
