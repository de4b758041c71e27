"""Which of many segments meet: candidates by halving the plane again and again, then exact predicates."""

from collections.abc import Iterator

import numpy as np

from .predicates import segments_cross

# Below this many segments, testing all pairs is cheaper than dividing further.
_LEAF = 32
# Segments that keep being cut into pieces cannot be separated (a scribble): test all pairs instead.
_MOST_PIECES = 16
_BLOCK = 1_000_000
# A scribble has billions of crossings, and nobody wants them all.
MOST_PAIRS = 100_000


def crossing_pairs(start: np.ndarray, end: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Pairs of segments of one group that have a point in common other than a shared, identical end point.

    start, end (n, 2) float64, group (n,) int -> (k, 2) int64, first < second, sorted. Exact; all the pairs, unless
    there are more than MOST_PAIRS. About O(n log n). A segment without length is a point, which meets what it lies on.
    """
    found, total = [np.zeros((0, 2), dtype=np.int64)], 0
    for pairs in close_pairs(start, end, group):
        first, second = pairs.T
        found.append(pairs[segments_cross(start[first], end[first], start[second], end[second])])
        total += len(found[-1])
        if total > MOST_PAIRS:
            break
    return np.unique(np.concatenate(found), axis=0) if total else found[0]


def crossing_place(start: np.ndarray, end: np.ndarray, pair: np.ndarray) -> tuple[float, float]:
    """A point of the first segment where, to rounding, the pair (2,) of segments meets."""
    (a, c), (b, d) = start[pair], end[pair]
    along, across = b - a, d - c
    denominator = along[0] * across[1] - along[1] * across[0]
    offset = c - a
    if abs(denominator) > 1e-14 * np.linalg.norm(along) * np.linalg.norm(across):
        share = (offset[0] * across[1] - offset[1] * across[0]) / denominator
    else:  # along one line: the end of the second one that is nearest to the middle of the first
        share = min((np.dot(p - a, along) / np.dot(along, along) for p in (c, d)), key=lambda s: abs(s - 0.5))
    x, y = a + np.clip(share, 0.0, 1.0) * along
    return float(x), float(y)


def gaps(start: np.ndarray, end: np.ndarray, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far each of two segments' ends (pairs (k, 2) of segments (n, 2)) are from the other one at least.

    (k,) the distance, and (k, 2) the end that is as near as that. Of segments that do not cross, that is the gap.
    A point is a segment from itself to itself.
    """
    (a, c), (b, d) = start[pairs.T], end[pairs.T]
    ends, others = np.stack([a, b, c, d]), np.stack([c, c, a, a])
    along = np.stack([d - c, d - c, b - a, b - a])
    share = np.clip(((ends - others) * along).sum(-1) / np.maximum((along**2).sum(-1), np.finfo(float).tiny), 0, 1)
    apart = np.linalg.norm(ends - others - share[..., None] * along, axis=-1)
    nearest, row = apart.argmin(axis=0), np.arange(len(pairs))
    return apart[nearest, row], ends[nearest, row]


def close_pairs(start: np.ndarray, end: np.ndarray, group: np.ndarray, distance: float = 0.0) -> Iterator[np.ndarray]:
    """Blocks (k, 2) of pairs of segments of one group that may be as near as `distance`; a pair can come twice.

    Each group is halved by a line at its median, and a segment across the line is cut there. The line runs along x,
    along y, or as most of the group's segments do, whichever separates them best. Pieces that come nearer to the line
    than the padding, which is far above any rounding, count for both sides, so that no common point is lost.
    """
    segment = np.arange(len(start))
    padding = distance
    if len(start):
        padding += 1e-12 * np.ptp(np.concatenate([start, end]), axis=0).max(initial=0.0)
    origin = start[:1]
    start, end = start - origin, end - origin
    while len(segment):
        _, group, count = np.unique(group, return_inverse=True, return_counts=True)
        small = (count <= _LEAF)[group]
        if small.any():
            yield from _pairs_within(segment[small], group[small], start[small], end[small], padding)
            segment, group, start, end = (part[~small] for part in (segment, group, start, end))
            continue
        normal, split = _median_line(start, end, group, count)
        from_, to = (np.sum(p * normal[group], axis=1) - split[group] for p in (start, end))
        left, right = np.minimum(from_, to) <= padding, np.maximum(from_, to) >= -padding
        larger = np.maximum(np.bincount(group, left), np.bincount(group, right))
        crowded = len(segment) > _MOST_PIECES * (segment.max() + 100)
        leaf = ((larger > 0.9 * count) | crowded)[group]
        yield from _pairs_within(segment[leaf], group[leaf], start[leaf], end[leaf], padding)
        with np.errstate(divide="ignore", invalid="ignore"):
            cut = start + (from_ / (from_ - to))[:, None] * (end - start)
        crosses = (from_ * to < 0)[:, None]
        parts = []
        for side, here in ((-1, left & ~leaf), (1, right & ~leaf)):
            new_start = np.where(crosses & (side * from_ < 0)[:, None], cut, start)
            new_end = np.where(crosses & (side * to < 0)[:, None], cut, end)
            parts.append((segment[here], 2 * group[here] + (side > 0), new_start[here], new_end[here]))
        segment, group, start, end = (np.concatenate(both) for both in zip(*parts, strict=True))


def _median_line(start: np.ndarray, end: np.ndarray, group: np.ndarray, count: np.ndarray):
    """For each group the normal (g, 2) of the line that separates its segments best, and the line's offset (g,)."""
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    order = np.argsort(group, kind="stable")
    along, centre = (end - start)[order], (0.5 * (start + end))[order]
    # Directions are means of doubled angles, weighted by squared length: a segment and its reverse are the same.
    x, y = along.T
    twice = np.add.reduceat(np.column_stack([x**2 - y**2, 2 * x * y]), first)
    angle = 0.5 * np.arctan2(twice[:, 1], twice[:, 0]) + 0.5 * np.pi
    zero, one = np.zeros(len(count)), np.ones(len(count))
    normals = np.stack([np.column_stack(n) for n in ((one, zero), (zero, one), (np.cos(angle), np.sin(angle)))])
    best = np.full(len(count), -1.0)
    normal = normals[0].copy()
    for candidate in normals:
        n = candidate[group[order]]
        position, size = np.sum(centre * n, axis=1), np.abs(np.sum(along * n, axis=1))
        spread = np.maximum.reduceat(position, first) - np.minimum.reduceat(position, first)
        mean = np.add.reduceat(size, first) / count
        separation = spread / (spread + mean + 1e-300)
        normal = np.where((separation > best)[:, None], candidate, normal)
        best = np.maximum(best, separation)
    position = np.sum(centre * normal[group[order]], axis=1)
    return normal, position[np.lexsort((position, group[order]))[first + count // 2]]


def _pairs_within(segment, group, start, end, padding) -> Iterator[np.ndarray]:
    """All pairs of each group whose pieces' boxes meet, in blocks."""
    order = np.lexsort((segment, group))
    segment, group, start, end = segment[order], group[order], start[order], end[order]
    low, high = np.minimum(start, end) - padding, np.maximum(start, end) + padding
    later = np.searchsorted(group, group, side="right") - np.arange(len(group)) - 1
    block = (np.cumsum(later) - later) // _BLOCK
    for rows in np.split(np.arange(len(group)), np.nonzero(np.diff(block))[0] + 1):
        i = np.repeat(rows, later[rows])
        j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(later[rows]) - later[rows], later[rows])
        meet = np.all((high[i] >= low[j]) & (high[j] >= low[i]), axis=1)
        i, j = segment[i[meet]], segment[j[meet]]
        yield np.column_stack([np.minimum(i, j), np.maximum(i, j)])[i != j]
