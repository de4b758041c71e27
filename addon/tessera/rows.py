"""Many points in a face: rows of bridges through them, all at once, so that few are left to be looked for one by one.

The face is taken in strips from left to right, as high as points are apart. The points of a strip, by x and then y,
make a path that meets no other strip's; what of it meets an edge of the face is left out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .bridges import Net
from .crossings import crossing_pairs
from .spacing import Target, points_between, wanted_along

# Times the mean distance of points: a row's bridges are about as long as rows are apart.
_HEIGHT = 1.0


def with_rows(net: Net, alone: np.ndarray, owner: int, longest: float, target: Target | None) -> Net:
    """A net with bridges between points (k,) by number, that no other segment has.

    owner: of the face; longest, target: as of `bridges.add_bridges` and `division.divide`.
    """
    low, high = net.points[alone].min(axis=0), net.points[alone].max(axis=0)
    height = _HEIGHT * float(np.sqrt(np.prod(np.maximum(high - low, 1e-3 * (high - low).max())) / len(alone)))
    strip = np.floor((net.points[alone, 1] - low[1]) / height)
    order = alone[np.lexsort((net.points[alone, 1], net.points[alone, 0], strip))]
    strip = np.sort(strip)
    ends = np.column_stack([order[:-1], order[1:]])[strip[1:] == strip[:-1]]
    ends = ends[~_meeting(net, net.points, ends)]
    start, end = net.points[ends[:, 0]], net.points[ends[:, 1]]
    of = np.full(len(ends), owner)
    wanted = np.full((len(ends), 1), longest) if target is None else wanted_along(start, end, of, target)
    most = np.full(len(ends), np.iinfo(np.int64).max)
    count, added = points_between(start, end, net.spacing[ends[:, 0]], net.spacing[ends[:, 1]], most, wanted)
    points, parts, bridge = _divided(net.points, ends, count, added)
    # Rounded, new vertices could be where they must not.
    x, y = (points[parts[:, 1]] - points[parts[:, 0]]).T
    spoiled = np.zeros(len(ends), dtype=bool)
    spoiled[bridge[_meeting(net, points, parts) | (x < 0) | ((x == 0) & (y <= 0))]] = True
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


def _meeting(net: Net, points: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """(s,) which segments (s, 2) meet the net's, or each other, but at common ends."""
    ends = np.concatenate([np.column_stack([net.start, net.end]), parts])
    # What has a length comes first, as `crossing_pairs` wants it.
    order = np.argsort(ends[:, 0] == ends[:, 1], kind="stable")
    start, end = points[ends[order, 0]], points[ends[order, 1]]
    pairs = order[crossing_pairs(start, end, np.zeros(len(ends), dtype=np.int64))]
    bad = np.zeros(len(ends), dtype=bool)
    bad[pairs.ravel()] = True
    return bad[len(net.start) :]
