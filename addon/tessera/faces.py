"""The faces of a plane graph, given by its half-edges."""

from __future__ import annotations

import numpy as np

from .predicates import orientation


def find_faces(
    points: np.ndarray, tails: np.ndarray, heads: np.ndarray, back: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The faces on the left of half-edges: their half-edges, one face behind the other, and how many each has.

    tails, heads: (h,) the ends of the half-edges by number; back: (h,) the number of the half-edge the other way, or
    -1 where there is no face on that side.
    """
    (one_sided,) = np.nonzero(back < 0)
    none = np.full(len(one_sided), -1)
    # Spokes: what leaves a vertex, and what comes the same way.
    leaves, comes = np.concatenate([np.arange(len(tails)), none]), np.concatenate([back, one_sided])
    spoke_at, spoke_to = np.concatenate([tails, heads[one_sided]]), np.concatenate([heads, tails[one_sided]])
    order = counter_clockwise(points, spoke_at, spoke_to)
    leaves, comes, spoke_at = leaves[order], comes[order], spoke_at[order]
    # With the face on the left, the next half-edge is the first one clockwise of the way back.
    count = np.bincount(spoke_at, minlength=len(points))
    first = np.cumsum(count) - count
    place = np.arange(len(order))
    previous = np.where(place == first[spoke_at], first[spoke_at] + count[spoke_at], place) - 1
    after = np.empty(len(tails), dtype=np.int64)
    after[comes[comes >= 0]] = leaves[previous[comes >= 0]]
    return find_cycles(after)


def counter_clockwise(points: np.ndarray, at: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Spokes by the vertex (k,) that they are at, and counter-clockwise around it, exactly: their order (k,)."""
    order = np.argsort(at, kind="stable")
    count = np.bincount(at)
    count, first = count[at[order]], (np.cumsum(count) - count)[at[order]]
    # Two spokes are in any order; of more, each is compared with all others, by the side of the first that it is on.
    (many,) = np.nonzero(count > 2)
    one = np.repeat(many, count[many])
    other = first[one] + np.arange(len(one)) - np.repeat(np.cumsum(count[many]) - count[many], count[many])
    centre, reference = points[at[order]], points[to[order[first]]]
    here = points[to[order]]
    side = np.zeros(len(order), dtype=np.int64)
    side[many] = 2 - orientation(centre[many], reference[many], here[many])
    side[first] = 0
    earlier = side[other] < side[one]
    same = np.flatnonzero((side[other] == side[one]) & (one != other))
    earlier[same] = orientation(centre[one[same]], here[other[same]], here[one[same]]) > 0
    rank = np.bincount(one, earlier, minlength=len(order))
    return order[np.lexsort((rank, at[order]))]


def find_cycles(after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cycles of a permutation (n,), each from its smallest number, one behind the other, and their lengths."""
    following = after.tolist()
    seen = bytearray(len(following))
    walk, size = [], []
    for start in range(len(following)):
        if seen[start]:
            continue
        before, here = len(walk), start
        while not seen[here]:
            seen[here] = 1
            walk.append(here)
            here = following[here]
        size.append(len(walk) - before)
    return np.array(walk, dtype=np.int64), np.array(size, dtype=np.int64)
