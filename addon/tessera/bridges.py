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

Whatever bridges there are already, that holds for the next one. So they are found in rounds: in each, every vertex that
still needs one looks for it by itself (`proposals.py`), and of those that meet or come near each other, the shortest
are taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .contour import neighbours
from .division import Polygons
from .faces import find_faces
from .nearby import build_boxes, meeting, runs
from .predicates import segments_cross
from .proposals import Net, Proposals, Wanted, pieces, propose
from .spacing import Target

# Bridges of one round keep so many spacings apart, in the first few rounds; then it is enough that they do not meet.
_APART, _GENTLE = 0.6, 6


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
    `division.divide`, and new vertices along a bridge are spaced as along its cuts.
    """
    size = np.array([len(loop) for loop in loops], dtype=np.int64)
    points, of = np.concatenate(loops), np.repeat(region, size)
    before, after = neighbours(size)
    tail, head = np.zeros((2, 0), dtype=np.int64)
    numbers = np.unique(region[is_hole])
    (own,) = np.nonzero(np.isin(of, numbers))
    if len(own):
        longest = np.broadcast_to(np.asarray(edge_length, dtype=np.float64), len(loops))[numbers]
        local = np.cumsum(np.isin(of, numbers)) - 1
        lengths = np.linalg.norm(points[after] - points, axis=1)
        spacing = 0.5 * (lengths + lengths[before])
        net = Net(points[own], spacing[own], np.searchsorted(numbers, of[own]), np.arange(len(own)), local[after[own]])
        loop = np.repeat(np.arange(len(size)), size)
        # The leftmost (then lowest) vertex of each hole, and the rightmost (then highest) one.
        first = (np.cumsum(size) - size)[is_hole]
        tips = (local[np.lexsort((*side.T[::-1], loop))[first]] for side in (points, -points))
        net = add_bridges(net, *tips, Wanted(longest, numbers, target))
        number = np.concatenate([own, len(points) + np.arange(len(net.points) - len(own))])
        tail, head = number[net.start[len(own) :]], number[net.end[len(own) :]]
        points = np.concatenate([points, net.points[len(own) :]])
        of = np.concatenate([of, numbers[net.group[len(own) :]]])
    # With the domain on the left, holes run clockwise.
    following = np.where(np.repeat(is_hole, size), before, after)
    n, s = len(following), len(tail)
    origin = np.concatenate([np.arange(n), tail, head])
    back = np.concatenate([np.full(n, -1), n + s + np.arange(s), n + np.arange(s)])
    walk, count = find_faces(points, origin, np.concatenate([following, head, tail]), back)
    corners = origin[walk]
    return points, Polygons(corners, count, of[corners[np.cumsum(count) - count]])


def add_bridges(net: Net, left: np.ndarray, right: np.ndarray, wanted: Wanted) -> Net:
    """A net with bridges from some vertices to the left, and from some to the right, that have none.

    left, right (k,): they see a vertex farther left (or right), and nothing of the net goes there from them.
    """
    for tips, turned in ((left, 1.0), (right, -1.0)):
        tips = np.setdiff1d(tips, net.ends()[1])
        tips = tips[np.lexsort((*net.points[tips].T[::-1], net.group[tips]))]
        number = 0
        while len(tips):
            bridges = propose(net, tips, replace(wanted, turned=turned))
            taken = _apart(net, bridges, number < _GENTLE)
            net = _with_bridges(net, bridges, taken)
            tips = tips[~taken]
            number += 1
        # Half a turn, which is exact: what is to the right then lies to the left.
        net = replace(net, points=-net.points)
    return net


def _apart(net: Net, bridges: Proposals, gently: bool) -> np.ndarray:
    """(k,) which bridges to take: the shortest, and then each that is away from all that are taken.

    gently: near ones are not taken either.
    """
    start, end = net.points[bridges.tip], net.points[bridges.goal]
    away = _APART * np.maximum(net.spacing[bridges.tip], net.spacing[bridges.goal]) if gently else np.zeros(len(start))
    group = net.group[bridges.tip]
    low, high = np.minimum(start, end), np.maximum(start, end)
    # Far above any rounding of new vertices: bridges that are farther apart than this do not meet.
    away = np.maximum(away, 1e-12 * (np.abs(low) + np.abs(high)).max(axis=1))
    one, other = meeting(build_boxes(low, high, group), low - away[:, None], high + away[:, None], group)
    one, other = one[one != other], other[one != other]
    near = segment_distances(start[one], end[one], start[other], end[other]) <= away[one]
    # One bridge may lead to where another one starts.
    near &= (bridges.goal[one] != bridges.tip[other]) & (bridges.tip[one] != bridges.goal[other])
    shared = bridges.goal[one] == bridges.goal[other]
    if not gently:
        near[shared] = _meeting(net, bridges, one[shared], other[shared])
    one, other = one[near], other[near]
    rank = np.empty(len(start), dtype=np.int64)
    rank[np.lexsort((np.arange(len(start)), np.linalg.norm(end - start, axis=1)))] = np.arange(len(start))
    swap = rank[one] > rank[other]
    one, other = np.where(swap, other, one), np.where(swap, one, other)  # the shorter first
    taken, open_ = np.zeros((2, len(start)), dtype=bool)
    open_[:] = True
    while open_.any():
        waits = np.zeros(len(start), dtype=bool)
        waits[other[open_[one]]] = True
        taken |= open_ & ~waits
        open_ &= waits
        open_[other[taken[one]]] = False
    return taken


def segment_distances(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(k,) the distance of segments ab and cd, (k, 2) each, a != b and c != d; 0 where they meet."""
    away = np.minimum.reduce([_away(a, c, d), _away(b, c, d), _away(c, a, b), _away(d, a, b)])
    away[segments_cross(a, b, c, d)] = 0
    return away


def _away(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(k,) the distance of points (k, 2) to segments."""
    along, offset = end - start, point - start
    share = np.clip(np.sum(offset * along, axis=1) / np.sum(along * along, axis=1), 0, 1)
    return np.hypot(*(offset - share[:, None] * along).T)


def _meeting(net: Net, bridges: Proposals, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(p,) whether pairs of bridges to the same goal meet before it."""
    bridge, start, end = pieces(net, bridges)
    count = bridges.count
    first = np.cumsum(count) - count
    pair, a = runs(first[one], count[one])
    row, b = runs(first[other[pair]], count[other[pair]])
    pair, a = pair[row], a[row]
    last = (a == (first + count - 1)[bridge[a]]) & (b == (first + count - 1)[bridge[b]])
    met = segments_cross(start[a], end[a], start[b], end[b]) | (~last & (end[a] == end[b]).all(axis=1))
    return np.bincount(pair, met, minlength=len(one)) > 0


def _with_bridges(net: Net, bridges: Proposals, taken: np.ndarray) -> Net:
    """The net with the bridges that are taken (k,)."""
    bridge, start, end = pieces(net, bridges)
    length = np.linalg.norm(end - start, axis=1)
    kept = taken[bridge]
    inner = np.diff(bridge, append=-1) == 0  # of pieces: not the last one
    added = end[kept & inner]
    spacing = 0.5 * (length + np.append(length[1:], 0))[kept & inner]
    number = np.cumsum(kept & inner) + len(net.points) - 1
    head = np.where(inner, number, bridges.goal[bridge])[kept]
    tail = np.where(np.diff(bridge, prepend=-1) == 0, np.append(0, number[:-1]), bridges.tip[bridge])[kept]
    return Net(
        np.concatenate([net.points, added]),
        np.concatenate([net.spacing, spacing]),
        np.concatenate([net.group, net.group[bridges.tip[bridge[kept & inner]]]]),
        np.concatenate([net.start, tail]),
        np.concatenate([net.end, head]),
    )
