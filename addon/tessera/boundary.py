"""Vertices on contours at the target edge length: corners kept, even spacing between them, the polygon simple again."""

from collections.abc import Callable, Sequence

import numpy as np

from .contour import neighbours, points_inside
from .crossings import crossing_pairs
from .predicates import orientation
from .sampling import cut

# A vertex is a corner where the contour turns by more than this; a regular polygon of 12 sides, which turns by 30
# degrees at its vertices, is still a coarse circle.
CORNER_ANGLE = np.radians(32.0)
# Corners that are nearer to each other than this share of an edge, and of the whole polyline, are one.
_ONE_CORNER, _OF_ALL = 0.05, 1e-3
_HALVED = 24  # edges from which it is worth while that a loop's boundary can be halved
# Numbers of edges that are as close to two whole numbers are rounded down, whatever the last bit says.
_TIE = 1e-9
# With a sizing function, edges are looked at in pieces of at most this share of the length that is wanted there, and
# of a loop's size.
_PIECE, _LONGEST_PIECE = 0.5, 1 / 64
# After so many rounds of single insertions all the given vertices between two neighbours are inserted at once.
PATIENCE = 12


def resample(loop: np.ndarray, edge_length: float) -> np.ndarray:
    """`resample_loops` for one simple counter-clockwise polygon (k, 2) -> (n, 2)."""
    return resample_loops([loop], edge_length)[0]


def resample_loops(
    loops: Sequence[np.ndarray],
    edge_length: float | np.ndarray | Callable[[np.ndarray, np.ndarray], np.ndarray],
    domain: np.ndarray | None = None,
    corner_angle: float = CORNER_ANGLE,
) -> list[np.ndarray]:
    """New vertices for simple counter-clockwise polygons (k, 2); they are simple and counter-clockwise again.

    edge_length: one, or one for each loop (m,), or a function of points (n, 2) and the domain of each (n,). domain (m,)
    int: loops of one domain, which do not meet, do not meet afterwards either, and lie inside each other as before;
    without it each loop is a domain of its own. corner_angle: in radians.

    The vertices lie on the given polyline. Corners (turning by more than the corner angle) stay, but of those that are
    closer to each other than a twentieth of an edge, and a thousandth of the polyline, only one: elements there could
    be nothing but thin. Between two of them are as many edges as come near `edge_length`, a number that is easily
    halved if there are many, equally long along the polyline, or as long as it is there. A loop without corners starts
    at its leftmost vertex, wherever its list starts. Where such spacing would make polygons meet, or put one inside
    another or out of it that was not, given vertices are inserted until it does not.
    """
    length = np.array([len(loop) for loop in loops])
    group = np.arange(len(loops)) if domain is None else np.asarray(domain)
    points, breaks = _from_a_corner(np.concatenate(loops), length, corner_angle)
    # One loop after the other: running sums must not depend on what else is in the batch.
    ends = np.cumsum(length)[:-1]
    if callable(edge_length):
        knots = knots_of(points, points[neighbours(length)[1]], length, group, edge_length)
    else:
        edge_length = np.broadcast_to(np.asarray(edge_length, dtype=np.float64), len(loops))
        closed = (np.concatenate([part, part[:1]]) for part in np.split(points, ends))
        knots = [vertices_as_knots(*one) for one in zip(closed, edge_length, strict=True)]
    positions = [resampled_places(*one) for one in zip(np.split(breaks, ends), *zip(*knots, strict=True), strict=True)]
    loop, position = np.repeat(np.arange(len(loops)), [len(p) for p in positions]), np.concatenate(positions)
    samples, loop, _ = until_simple(points, length, loop, position, group)
    return np.split(samples, np.cumsum(np.bincount(loop))[:-1])


def until_simple(
    points: np.ndarray, length: np.ndarray, loop: np.ndarray, position: np.ndarray, group: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """New vertices for simple loops, and as many of the given ones as it takes for them to be simple and nested again.

    points (n, 2): of loops of `length` (m,), one behind the other; loop, position: (v,) the new vertices, by the number
    of the edge that each lies on plus the share of it before them, ascending; group: (m,) loops of one domain. Returns
    the vertices (w, 2) and their loops and positions (w,).
    """
    rounds = 0
    while True:
        samples = _points_at(points, length, loop, position)
        extra_loop, extra_position, hopeless = _insertions(samples, points, length, loop, position, group, rounds)
        if len(hopeless):
            # New vertices are rounded off the polyline, and it nearly touches there: only the given ones are sure.
            kept = ~np.isin(loop, hopeless)
            loop, position = loop[kept], position[kept]
            extra_loop = np.repeat(hopeless, length[hopeless])
            extra_position = np.concatenate([np.arange(n, dtype=float) for n in length[hopeless]])
        elif len(extra_loop) == 0:
            return samples, loop, position
        loop, position = np.concatenate([loop, extra_loop]), np.concatenate([position, extra_position])
        order = np.lexsort((position, loop))
        loop, position = loop[order], position[order]
        rounds += 1


def _from_a_corner(points: np.ndarray, length: np.ndarray, corner_angle: float) -> tuple[np.ndarray, np.ndarray]:
    """The loops' points turned to start at a corner, or at the leftmost vertex; and which of them end an arc."""
    before, after = neighbours(length)
    corner = np.abs(turning_angles(points, before, after)) > corner_angle
    loop = np.repeat(np.arange(len(length)), length)
    first = np.cumsum(length) - length
    start = np.lexsort((points[:, 1], points[:, 0], ~corner, loop))[first] - first
    turned = (np.arange(len(points)) - first[loop] + start[loop]) % length[loop] + first[loop]
    points, corner = points[turned], corner[turned]
    corner[first] = True
    return points, corner


def turning_angles(points: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """By how much loops turn at each of their points (n, 2), in radians, to the left: (n,)."""
    came, goes = points - points[before], points[after] - points
    return np.arctan2(came[:, 0] * goes[:, 1] - came[:, 1] * goes[:, 0], np.sum(came * goes, axis=1))


def vertices_as_knots(points: np.ndarray, edge_length: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Positions along a polyline (k + 1, 2), its vertices' numbers; length up to each (k + 1,); that of an edge."""
    length = np.linalg.norm(points[1:] - points[:-1], axis=1)
    return np.arange(len(points) + 0.0), np.concatenate([[0.0], np.cumsum(length)]), edge_length


def knots_of(
    start: np.ndarray, end: np.ndarray, length: np.ndarray, group: np.ndarray, wanted: Callable
) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """`vertices_as_knots` for a function of points and domains: the integral of 1 / wanted along polylines.

    start, end: (n, 2) of all edges, length (m,) of which each polyline has; group: (m,) its domain.
    """
    first = np.cumsum(length) - length
    loop = np.repeat(np.arange(len(length)), length)
    position = np.arange(len(start)) - first[loop] + 0.0
    away = np.maximum(*(np.abs(ends - start[first][loop]).max(axis=1) for ends in (start, end)))
    size = np.maximum.reduceat(away, first)
    share = np.ones(len(start))
    parts = np.ceil(np.linalg.norm(end - start, axis=1) / (_LONGEST_PIECE * size[loop]))
    found = []
    while len(start):
        parts = np.clip(parts, 1, 8).astype(np.int64)
        of = np.repeat(np.arange(len(parts)), parts)
        step = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
        start, end = cut(start, end, parts)
        loop, share = loop[of], (share / parts)[of]
        position = position[of] + step * share
        piece = np.linalg.norm(end - start, axis=1)
        edges = piece / wanted(0.5 * (start + end), group[loop])
        fine = edges <= _PIECE
        found.append((loop[fine], position[fine], edges[fine]))
        start, end, loop, share, position = (a[~fine] for a in (start, end, loop, share, position))
        parts = np.ceil(edges[~fine] / _PIECE)
    loop, position, edges = map(np.concatenate, zip(*found, strict=True))
    order = np.lexsort((position, loop))
    ends = np.cumsum(np.bincount(loop))[:-1]
    return [
        (np.append(at, n), np.concatenate([[0.0], np.cumsum(passed)]), 1.0)
        for at, passed, n in zip(np.split(position[order], ends), np.split(edges[order], ends), length, strict=True)
    ]


def count_edges(passed: np.ndarray, fewest: int = 3) -> np.ndarray:
    """How many edges each arc comes to (a,), at least so many together; passed: (a,) wanted edges it is long."""
    n_edges = np.maximum(np.rint(passed * (1 - _TIE)), 1).astype(np.int64)
    n_edges[np.argmax(passed)] += max(fewest - n_edges.sum(), 0)
    return n_edges


def halvable(n_edges: np.ndarray) -> np.ndarray:
    """Numbers of edges near these (a,), by at most a tenth, that can be halved a few times (`coarsening.py`)."""
    found = n_edges
    for parts in (2, 4, 8):
        near = parts * ((n_edges + parts // 2) // parts)
        found = np.where(10 * np.abs(near - n_edges) <= n_edges, near, found)
    return found


def even_spacing(arc_start: np.ndarray, position: np.ndarray, passed: np.ndarray, n_edges: np.ndarray) -> np.ndarray:
    """Places (n,) of a polyline's new vertices: the number of the edge they lie on plus the share of it before them.

    arc_start: (a,) which vertices but the last stay, the first among them; n_edges: (a,) from each to the next;
    position, passed: as of `vertices_as_knots`.
    """
    knot = np.searchsorted(position, arc_start)
    arc_length = np.diff(passed[knot], append=passed[-1])
    arc = np.repeat(np.arange(len(arc_start)), n_edges)
    step = np.arange(len(arc)) - np.repeat(np.cumsum(n_edges) - n_edges, n_edges)
    target = passed[knot[arc]] + step / n_edges[arc] * arc_length[arc]
    before = np.where(step == 0, knot[arc], np.searchsorted(passed[:-1], target, side="right") - 1)
    share = (target - passed[before]) / (passed[before + 1] - passed[before])
    # Below 1, also after the number of the edge is added.
    share = np.where(step == 0, 0.0, np.clip(share, 0.0, 1.0 - 2.0**-30))
    places = position[before] + share * (position[before + 1] - position[before])
    return np.minimum(places, np.nextafter(position[-1], 0))


def resampled_places(
    breaks: np.ndarray, position: np.ndarray, passed: np.ndarray, an_edge: float, fewest: int = 3
) -> np.ndarray:
    """`even_spacing` at the target edge length; vertices that stay and are nearer to each other than `_ONE_CORNER` are
    one.

    breaks: (k,) bool, which vertices but the last stay, the first among them; position, passed, an_edge: as of
    `vertices_as_knots`; fewest: edges that there are at least.
    """
    arc_start = np.flatnonzero(breaks)
    at = passed[np.searchsorted(position, arc_start)]
    nearest = min(_ONE_CORNER * an_edge, _OF_ALL * passed[-1])
    if (np.diff(at, append=passed[-1]) < nearest).any():
        distinct = _distinct_corners(at, passed[-1], nearest)
        arc_start, at = arc_start[distinct], at[distinct]
    n_edges = count_edges(np.diff(at, append=passed[-1]) / an_edge, fewest)
    return even_spacing(arc_start, position, passed, halvable(n_edges) if n_edges.sum() >= _HALVED else n_edges)


def _distinct_corners(at: np.ndarray, end: float, nearest: float) -> list[int]:
    """Those of corners (a,) that are no nearer to each other than this; the first stays, and so does the end.

    at, end: how far along the polyline they are, and it is.
    """
    stay = [0]
    for number in range(1, len(at)):
        if at[number] - at[stay[-1]] >= nearest:
            stay.append(number)
    if len(stay) > 1 and end - at[stay[-1]] < nearest:
        stay.pop()
    return stay


def _points_at(points: np.ndarray, length: np.ndarray, loop: np.ndarray, position: np.ndarray) -> np.ndarray:
    _, after = neighbours(length)
    edge = np.floor(position).astype(np.int64)
    part = (position - edge)[:, None]
    start = edge + (np.cumsum(length) - length)[loop]
    return np.where(part == 0, points[start], (1 - part) * points[start] + part * points[after[start]])


def _insertions(samples, points, length, loop, position, group, rounds):
    """Given vertices to insert where polygons meet or change sides, by loop and position; loops where none is left."""
    count = np.bincount(loop, minlength=len(length))
    _, after = neighbours(count)
    pairs = crossing_pairs(samples, samples[after], group[loop])
    bad = np.zeros(len(samples), dtype=bool)
    bad[pairs.ravel()] = True
    bad |= (_clockwise(samples, count) & (np.bincount(loop, bad, minlength=len(length)) == 0))[loop]
    skipped = _skipped(length, loop, position)
    bad |= _swallowing(samples, points, length, loop, skipped, np.where(np.isin(group, group[loop[bad]]), -1, group))
    edges = np.nonzero(bad)[0]
    low, between = (part[edges] for part in skipped)
    edge = np.repeat(np.arange(len(edges)), between)
    vertex = np.arange(len(edge)) - np.repeat(np.cumsum(between) - between, between) + low[edge]
    if rounds < PATIENCE and len(edge):
        a, b = samples[edges][edge], samples[after[edges]][edge]
        offset, along = points[vertex] - a, b - a
        distance = np.abs(along[:, 0] * offset[:, 1] - along[:, 1] * offset[:, 0])
        farthest = np.lexsort((distance, edge))[np.cumsum(between[between > 0]) - 1]
        edge, vertex = edge[farthest], vertex[farthest]
    helped = np.zeros(len(length), dtype=bool)
    helped[loop[edges[edge]]] = True
    # Loops that meet help each other: only where nobody can insert anything is it hopeless.
    helped_group = np.isin(group, group[helped])
    to = loop[edges[edge]]
    position = (vertex - (np.cumsum(length) - length)[to]).astype(float)
    return to, position, np.setdiff1d(loop[edges], np.nonzero(helped_group)[0])


def _skipped(length: np.ndarray, loop: np.ndarray, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Given vertices between the ends of each edge: the number of the first (n,), and how many there are (n,)."""
    _, after = neighbours(np.bincount(loop, minlength=len(length)))
    low = np.floor(position).astype(np.int64) + 1
    end = np.where(after > np.arange(len(loop)), position[after], length[loop])
    between = np.maximum(np.ceil(end).astype(np.int64) - low, 0)
    return low + (np.cumsum(length) - length)[loop], between


def _swallowing(samples, points, length, loop, skipped, group) -> np.ndarray:
    """Which edges (n,) pass another loop of their group on another side than the given vertices that they skip.

    That loop would be inside where it was outside, or outside where it was inside. Groups below 0 are left out.
    """
    bad = np.zeros(len(samples), dtype=bool)
    first_sample = np.searchsorted(loop, np.arange(len(length)))
    first = np.cumsum(length) - length
    low, high = (extreme.reduceat(points, first) for extreme in (np.minimum, np.maximum))
    places = samples[first_sample]  # a given vertex of each loop
    shared = np.isin(group, np.flatnonzero(np.bincount(group[group >= 0]) > 1))
    shared[shared] = np.add.reduceat(skipped[1], first_sample)[shared] > 0
    for k in np.flatnonzero(shared):
        others = np.flatnonzero((group == group[k]) & (np.arange(len(group)) != k))
        others = others[np.all((places[others] > low[k]) & (places[others] < high[k]), axis=1)]
        if len(others) == 0:
            continue
        mine = np.arange(first_sample[k], np.searchsorted(loop, k, side="right"))
        before = points_inside(places[others], points[first[k] : first[k] + length[k]])
        passed = places[others[before != points_inside(places[others], samples[mine])]]
        if len(passed):
            # Each is in an odd number of the pieces that edges cut off the given polygon, or add to it.
            for edge, vertex, n, end in zip(mine, skipped[0][mine], skipped[1][mine], np.roll(mine, -1), strict=True):
                piece = np.concatenate([samples[[end, edge]], points[vertex : vertex + n]])
                bad[edge] = n > 0 and points_inside(passed, piece).any()
            if not bad[mine].any():  # by rounding: so close to it is the other one
                bad[mine] = True
    return bad


def _clockwise(points: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Which of the simple polygons, one behind the other, run clockwise; exact, at their leftmost vertices."""
    before, after = neighbours(count)
    loop = np.repeat(np.arange(len(count)), count)
    corner = np.lexsort((points[:, 1], points[:, 0], loop))[np.cumsum(count) - count]
    return orientation(points[before[corner]], points[corner], points[after[corner]]) <= 0
