"""From contours with holes to simple polygons: bridges between the loops, along which the domain is cut.

Each hole gets a bridge from its leftmost vertex to a vertex farther left, and one from its rightmost vertex to one
farther right, of any loop or of an earlier bridge. A bridge meets no loop and no other bridge but at its ends, and x
rises or falls strictly along it.

There always is one: a ray from a hole's leftmost vertex p to the left hits an edge or an earlier bridge first at a
point h; a is the end with the smaller x of the segment that it hits. Of the vertices in the triangle p, h, a, which all
are farther left than p, p sees the one whose direction is nearest to that of the ray (and of several, the closest):
what hid it would have an end nearer still, as it can neither meet ph nor cross ha.

The faces are simple polygons, because no vertex v holds a part of the domain's loops and bridges to the rest alone. Go
from a hole to the left: along the bridge from its leftmost vertex, and on to the left end of whatever bridge that one
ends on; from the loop there, which starts farther left, in the same way, until the outer contour is reached. Around a
loop there are two ways from where it is entered to where it is left, so all that this way cannot avoid is farther left
than the hole (or is its leftmost vertex), and all that the way to the right cannot avoid is farther right: v blocks one
of them at most. So it is for a vertex within a bridge, from where the bridge itself leads to the left and to the right.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from .chords import end_cost
from .contour import neighbours
from .division import Polygons
from .faces import find_faces
from .nearby import Boxes
from .predicates import segments_cross
from .spacing import Target, graded_spacing, natural_segments, points_between, wanted_along

# A bridge is looked for within so many spacings of its start at first; and so many of the closest vertices at a time.
_NEAR = 8.0
_AT_ONCE = 32


@dataclass(frozen=True)
class Net:
    """What bounds a domain, and bridges: points (n, 2), their spacing (n,), and segments from `start` to `end` (e,).

    A point by itself is a segment to itself.
    """

    points: np.ndarray
    spacing: np.ndarray
    start: np.ndarray
    end: np.ndarray

    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """The left and the right end (k,) of each segment that is not upright."""
        x = self.points[:, 0]
        rises = np.sign(x[self.end] - x[self.start])
        left, right = np.where(rises > 0, [self.start, self.end], [self.end, self.start])[:, rises != 0]
        return left, right


def bridge_holes(
    loops: Sequence[np.ndarray],
    region: np.ndarray,
    is_hole: np.ndarray,
    edge_length: float | np.ndarray,
    target: Target | None = None,
) -> tuple[np.ndarray, Polygons]:
    """Points (p, 2), the loops' first and in their order, and the polygons of them that tile the regions.

    loops: simple counter-clockwise polygons (k, 2) that do not meet; region (m,) int: loops of one number, one of them
    the outer contour and the others its holes, bound one region; is_hole: (m,) bool. The polygons' owner is their
    region; a contour without holes is a polygon itself. edge_length, one or one for each region (m,), and target: as of
    `division.divide`, and new vertices along a bridge are spaced as along its cuts. A loop over the holes, each of
    which takes array operations on what is near it, and one copy of all.
    """
    size = np.array([len(loop) for loop in loops], dtype=np.int64)
    first = np.cumsum(size) - size
    points = [np.concatenate(loops)]
    of = [np.repeat(region, size)]
    before, after = neighbours(size)
    # With the domain on the left, holes run clockwise.
    following = np.where(np.repeat(is_hole, size), before, after)
    tails, heads = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    n_points = len(points[0])
    edge_length = np.broadcast_to(np.asarray(edge_length, dtype=np.float64), len(loops))
    for number in np.unique(region[is_hole]):
        mine = np.flatnonzero(region == number)
        own = np.concatenate([np.arange(first[k], first[k] + size[k]) for k in mine])
        longest = float(edge_length[number])
        wanted = partial(wanted_between, target, number, longest)
        added, tail, head = _bridges(points[0][own], size[mine], is_hole[mine], longest, wanted)
        own = np.concatenate([own, n_points + np.arange(len(added))])
        points.append(added)
        of.append(np.full(len(added), number))
        tails.append(own[tail])
        heads.append(own[head])
        n_points += len(added)
    points, of = np.concatenate(points), np.concatenate(of)
    tail, head = np.concatenate(tails), np.concatenate(heads)
    n, s = len(following), len(tail)
    origin = np.concatenate([np.arange(n), tail, head])
    back = np.concatenate([np.full(n, -1), n + s + np.arange(s), n + np.arange(s)])
    walk, count = find_faces(points, origin, np.concatenate([following, head, tail]), back)
    corners = origin[walk]
    return points, Polygons(corners, count, of[corners[np.cumsum(count) - count]])


def wanted_between(target: Target | None, region: int, longest: float, turned: float, ends: np.ndarray) -> np.ndarray:
    """The target of a region along a cut from ends[0] to ends[1], times `turned` (1 or -1): (1, 1) or (1, steps)."""
    if target is None:
        return np.array([[longest]])
    return wanted_along(turned * ends[:1], turned * ends[1:], np.array([region]), target)


def _bridges(
    points: np.ndarray, size: np.ndarray, is_hole: np.ndarray, edge_length: float, wanted: Callable
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bridges of one region: the points to add (k, 2), and the bridges' segments by the numbers of their ends (s,)."""
    before, after = neighbours(size)
    lengths = np.linalg.norm(points[after] - points, axis=1)
    net = Net(points, 0.5 * (lengths + lengths[before]), np.arange(len(points)), after)
    loop = np.repeat(np.arange(len(size)), size)
    # The leftmost (then lowest) vertex of each hole, and the rightmost (then highest) one.
    tips = (np.lexsort((*side.T[::-1], loop))[(np.cumsum(size) - size)[is_hole]] for side in (points, -points))
    net = add_bridges(net, *tips, edge_length, wanted)
    return net.points[len(points) :], net.start[len(points) :], net.end[len(points) :]


def add_bridges(net: Net, left: np.ndarray, right: np.ndarray, edge_length: float, wanted: Callable) -> Net:
    """A net with bridges from some vertices to the left, and from some to the right, that have none.

    left, right (k,): they see a vertex farther left (or right), and nothing of the net goes there from them.
    edge_length: the longest target; wanted: 1 or -1 (what points must be multiplied by to be where they are) and the
    ends (2, 2) of a bridge -> the target along it, (1, 1) or (1, steps).
    """
    for tips, turned in ((left, 1.0), (right, -1.0)):
        boxes = Boxes(*_boxes(net.points, net.start, net.end))
        x, y = net.points[tips].T
        for tip in tips[np.lexsort((y, x))]:  # from left to right
            net = _with_bridge(net, boxes, tip, edge_length, partial(wanted, turned))
        # Half a turn, which is exact: what is to the right then lies to the left.
        net = Net(-net.points, net.spacing, net.start, net.end)
    return net


def _boxes(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The lower and upper corners (e, 2) of the segments' bounding boxes."""
    return np.minimum(points[start], points[end]), np.maximum(points[start], points[end])


def _with_bridge(net: Net, boxes: Boxes, tip: int, edge_length: float, wanted: Callable) -> Net:
    """The net with a bridge from vertex `tip` to the left, if it has none; boxes: of the segments, and then of more."""
    points, here = net.points, net.points[tip]
    reach, largest = _NEAR * max(net.spacing[tip], edge_length), 2 * boxes.extent
    while True:
        reach = min(reach, largest)
        around, near = _window(net, boxes, here - reach, here + [0, reach])
        joined = np.concatenate([around.end[around.start == tip], around.start[around.end == tip]])
        if (points[joined, 0] < here[0]).any():
            return net
        near = near[points[near, 0] < here[0]]
        seen = _visible(around, tip, near)
        if len(seen) and (reach >= largest or np.linalg.norm(points[seen[0]] - here) <= 0.5 * reach):
            break
        if reach >= largest:
            raise AssertionError("a hole's leftmost vertex sees one farther left")
        reach *= 2
    goal = seen[np.argmin(_costs(around, tip, seen, near, edge_length))]
    added = _points_on(around, tip, goal, near, wanted)
    numbers = np.concatenate([[tip], len(points) + np.arange(len(added)), [goal]])
    path = np.concatenate([points[[tip]], added, points[[goal]]])
    boxes.add(*_boxes(path, np.arange(len(path) - 1), np.arange(1, len(path))))
    length = np.linalg.norm(np.diff(path, axis=0), axis=1)
    return Net(
        np.concatenate([points, added]),
        np.concatenate([net.spacing, 0.5 * (length[1:] + length[:-1])]),
        np.concatenate([net.start, numbers[:-1]]),
        np.concatenate([net.end, numbers[1:]]),
    )


def _window(net: Net, boxes: Boxes, low: np.ndarray, high: np.ndarray) -> tuple[Net, np.ndarray]:
    """The net with only the segments that meet a box, and its vertices (k,) in the box."""
    segments = boxes.around(low, high)
    start, end = net.start[segments], net.end[segments]
    lowest, highest = _boxes(net.points, start, end)
    meets = np.all((highest >= low) & (lowest <= high), axis=1)
    start, end = start[meets], end[meets]
    near = np.unique(np.concatenate([start, end]))
    near = near[np.all((net.points[near] >= low) & (net.points[near] <= high), axis=1)]
    return Net(net.points, net.spacing, start, end), near


def _visible(net: Net, tip: int, near: np.ndarray) -> np.ndarray:
    """Vertices of `near` that `tip` sees, the closest first: those among the closest few, or the next few, ..."""
    here = net.points[tip]
    near = near[np.argsort(np.sum((net.points[near] - here) ** 2, axis=1), kind="stable")]
    start, end = net.points[net.start], net.points[net.end]
    for first in range(0, len(near), _AT_ONCE):
        part = near[first : first + _AT_ONCE]
        hidden = segments_cross(here, net.points[part, None], start, end).any(axis=1)
        if not hidden.all():
            return part[~hidden]
    return near[:0]


def _costs(net: Net, tip: int, seen: np.ndarray, near: np.ndarray, edge_length: float) -> np.ndarray:
    """Cost (k,) of bridges from `tip` to the vertices `seen`: long, stretched, sharp at their ends or near others."""
    here, there = net.points[tip], net.points[seen]
    along = there - here
    length = np.hypot(along[:, 0], along[:, 1])
    natural = natural_segments(length, net.spacing[tip], net.spacing[seen], edge_length)
    cost = 2 * np.log(length) + 2 * np.log(natural / np.maximum(np.rint(natural), 1)) ** 2
    for vertex, toward in ((np.full(len(seen), tip), along), (seen, -along)):
        for gap in _gaps(net, vertex, toward):
            cost += end_cost(gap)
    offset = net.points[near] - here
    forward = (offset @ along.T).T / length[:, None]
    aside = np.abs(np.outer(along[:, 0], offset[:, 1]) - np.outer(along[:, 1], offset[:, 0])) / length[:, None]
    beyond = np.maximum(np.maximum(-forward, forward - length[:, None]), 0)
    spacing = graded_spacing(
        np.clip(forward, 0, length[:, None]),
        length[:, None],
        net.spacing[tip],
        net.spacing[seen][:, None],
        edge_length,
    )
    relative = np.where(near == seen[:, None], np.inf, np.hypot(beyond, aside) / spacing).min(axis=1)
    narrow = np.maximum(0.6 - relative, 0) / 0.6
    return cost + 4 * narrow**2 + 2 * narrow


def _gaps(net: Net, vertex: np.ndarray, toward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles (k,) from a direction (k, 2) at a vertex (k,) to the next segments there, to its left and to its right."""
    heading = np.arctan2(toward[:, 1], toward[:, 0])[:, None]
    left, right = [], []
    for one, other in ((net.start, net.end), (net.end, net.start)):
        x, y = (net.points[other] - net.points[one]).T
        angle = (np.arctan2(y, x) - heading) % (2 * np.pi)
        at = (one == vertex[:, None]) & (net.start != net.end)
        left.append(np.where(at, angle, 2 * np.pi).min(axis=1))
        right.append(np.where(at, 2 * np.pi - angle, 2 * np.pi).min(axis=1))
    return np.minimum(*left), np.minimum(*right)


def _points_on(net: Net, tip: int, goal: int, near: np.ndarray, wanted: Callable) -> np.ndarray:
    """The new vertices (k, 2) of the bridge from `tip` to `goal`; none where, rounded, they could spoil it."""
    ends = net.points[[tip, goal]]
    spacing = net.spacing[[tip, goal]]
    most = np.array([np.iinfo(np.int64).max])
    _, added = points_between(ends[:1], ends[1:], spacing[:1], spacing[1:], most, wanted(ends))
    added[:, 1] = np.clip(added[:, 1], ends[:, 1].min(), ends[:, 1].max())
    path = np.concatenate([ends[:1], added, ends[1:]])
    monotonous = (np.diff(path[:, 0]) < 0).all()
    apart = not (added[:, None] == net.points[near]).all(axis=2).any()
    if not (monotonous and apart):
        return added[:0]
    start, end = net.points[net.start], net.points[net.end]
    low, high = _boxes(net.points, net.start, net.end)
    close = np.all((low <= path.max(axis=0)) & (high >= path.min(axis=0)), axis=1)
    crossed = segments_cross(path[:-1, None], path[1:, None], start[close], end[close])
    return added[:0] if crossed.any() else added
