"""A domain with points and lines in it, or of several regions, as a plane graph; and what is wrong with one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .contour import checked_curves, checked_points, edges_of, meeting_error, signed_area, without_repeats
from .crossings import close_pairs, gaps
from .errors import ContourError
from .graph import Graph, graph_faces
from .noding import TOLERANCE, Crossing, Noded, node_curves
from .regions import face_regions

_SHARE = 0.1  # of the shorter of two edges: a larger gap is a part of the outlines' shape


@dataclass(frozen=True)
class Domain:
    """What a user asks for: contours, the region that each is part of (l,), points (k, 2) or None, lines (k, 2).

    Without regions, there is one for each outer contour, by the number of that.
    """

    loops: Sequence[ArrayLike]
    region: Sequence[int] | None
    points: ArrayLike | None
    lines: Sequence[ArrayLike]


@dataclass(frozen=True)
class PlanarDomain:
    """A domain as it is meshed: its cleaned loops, their graph with lines and points, and what to warn of."""

    loops: list[np.ndarray]
    graph: Graph
    warnings: tuple[str, ...]


def planar_domains(
    domains: Sequence[Sequence[ArrayLike] | Domain], cleaned: list[list[np.ndarray] | ContourError]
) -> tuple[list[list[np.ndarray] | ContourError], dict[int, PlanarDomain]]:
    """`planar_domain` for those of a batch that need it, by number; and `cleaned` with the errors that they have.

    cleaned: of the others, what `clean_domains` gives; one whose contours meet, or all but do, may be told apart with
    common vertices.
    """
    planar, results = {}, list(cleaned)
    near = _nearly_meeting(cleaned)
    for number, domain in enumerate(domains):
        error = cleaned[number]
        meets = isinstance(error, ContourError) and error.reason in ("crossing", "self-intersection")
        if not (meets or number in near or isinstance(domain, Domain)):
            continue
        try:
            planar[number] = planar_domain(domain if isinstance(domain, Domain) else Domain(domain, None, None, ()))
            results[number] = planar[number].loops
        except ContourError as wrong:
            if number not in near:  # else there is a gap, however narrow, and it can be meshed
                results[number] = wrong
    return results, planar


def _nearly_meeting(cleaned: list[list[np.ndarray] | ContourError]) -> set[int]:
    """The domains whose contours come as near to each other as noding takes for a common place, and do not meet.

    Not those whose edges there are hardly longer than that gap: fine outlines are told apart.
    """
    several = {n: loops for n, loops in enumerate(cleaned) if not isinstance(loops, ContourError) and len(loops) > 1}
    if not several:
        return set()
    numbers = [number for number, loops in several.items() for _ in loops]
    start, end = edges_of([loop for loops in several.values() for loop in loops])
    loop = np.repeat(np.arange(len(numbers)), [len(loop) for loops in several.values() for loop in loops])
    domain = np.array(numbers)[loop]
    tolerance = np.zeros(len(cleaned))
    for number, loops in several.items():
        tolerance[number] = TOLERANCE * float(np.ptp(np.concatenate(loops), axis=0).max())
    unit, near = tolerance[domain, None], [domain[:0]]
    for pairs in close_pairs(start / unit, end / unit, domain, 1.0):
        pairs = pairs[loop[pairs[:, 0]] != loop[pairs[:, 1]]]
        shorter = np.hypot(*(end - start)[pairs].T).min(axis=0)
        most = np.minimum(tolerance[domain[pairs[:, 0]]], _SHARE * shorter)
        near.append(domain[pairs[gaps(start, end, pairs)[0] <= most, 0]])
    return set(np.concatenate(near).tolist())


def planar_domain(domain: Domain) -> PlanarDomain:
    """The graph of a domain. Raises ContourError.

    Its reason is that of a contour alone, or "crossing" (contours or lines), "self-intersection", "overlap" (of two
    regions), "outside" (a point or a line), or "on-contour" (a point on one, or a line along one).
    """
    loops = [_turned(without_repeats(loop)) for loop in checked_curves(domain.loops, "contour")]
    if not loops:
        raise ContourError("too-few-points", "The domain has no contour. Give at least one closed loop of points.")
    low, high = (extreme(np.concatenate(loops), axis=0) for extreme in (np.min, np.max))
    tolerance = TOLERANCE * float((high - low).max())
    points = _checked_points(domain.points)
    given = checked_curves(domain.lines, "line")
    lines = [_checked_line(line) for line in given]
    for what, places in (("Point", points), *(("Line", line) for line in lines)):
        beyond = np.flatnonzero(((places < low - tolerance) | (places > high + tolerance)).any(axis=1))
        if len(beyond):
            raise _outside(what, places[beyond[0]])
    curves = [*loops, *lines, *points[:, None]]
    closed = [True] * len(loops) + [bool(np.array_equal(line[0], line[-1])) for line in lines] + [False] * len(points)
    noded = node_curves([_open(c) if k >= len(loops) else c for k, c in enumerate(curves)], closed, tolerance)
    if isinstance(noded, Crossing):
        raise _crossing(noded, len(loops), len(loops) + len(lines))
    places = noded.point_of[len(noded.point_of) - len(points) :]
    graph, touching = _graph(noded, len(loops), len(lines), domain.region, places)
    repeated = len(points) - len(np.unique(places)), sum(map(len, given)) - sum(map(len, lines))
    return PlanarDomain(loops, graph, _touching_warnings(noded.points[touching]) + _repeated_warnings(*repeated))


def _turned(loop: np.ndarray) -> np.ndarray:
    return loop if signed_area(loop) > 0 else loop[::-1].copy()


def _open(line: np.ndarray) -> np.ndarray:
    """A line's vertices without the last one, if that is the first again."""
    return line[:-1] if len(line) > 1 and np.array_equal(line[0], line[-1]) else line


def _checked_points(points: ArrayLike | None) -> np.ndarray:
    return np.zeros((0, 2)) if points is None else checked_points(points, "points")


def _checked_line(line: np.ndarray) -> np.ndarray:
    """A line's points (k, 2) that are not at the place of the one before; raises if it has no edge."""
    line = line[np.append(True, (line[1:] != line[:-1]).any(axis=1))] if len(line) else line
    if len(line) < 2 or (len(line) == 3 and np.array_equal(line[0], line[2])):
        place = tuple(map(float, line[0])) if len(line) else None
        message = "A line has fewer than two distinct points. Add points, or leave it out."
        raise ContourError("too-few-points", message, place)
    return line


def _graph(
    noded: Noded, n_loops: int, n_lines: int, region: Sequence[int] | None, places: np.ndarray
) -> tuple[Graph, np.ndarray]:
    """The graph with its regions, and the points (k,) where contours touch; raises if a line or point is misplaced.

    Its curves are contours, then lines, then points that must be vertices: `places` (v,) by number.
    """
    faces = graph_faces(noded.points, noded.edges)
    of_face, touching = face_regions(noded, faces, n_loops, None if region is None else np.asarray(region))
    sides = of_face[faces.of_half_edge].reshape(2, -1).T
    home = np.where(faces.of_point >= 0, of_face[faces.of_point], -1)
    on_line = (noded.curve >= n_loops) & (noded.curve < n_loops + n_lines)
    line_edges = noded.edge[on_line]
    along = np.intersect1d(line_edges, noded.edge[noded.curve < n_loops])
    if len(along):
        raise _on_contour("A line runs along a contour", noded.points[noded.edges[along[0]]].mean(axis=0))
    out = line_edges[(sides[line_edges] < 0).any(axis=1)]
    if len(out):
        raise _outside("Line", noded.points[noded.edges[out[0]]].mean(axis=0))
    on = np.intersect1d(places, noded.edges[noded.edge[noded.curve < n_loops]])
    if len(on):
        raise _on_contour("A point lies on a contour", noded.points[on[0]])
    alone = places[faces.of_point[places] >= 0]
    out = alone[home[alone] < 0]
    if len(out):
        raise _outside("Point", noded.points[out[0]])
    kept = np.bincount(noded.edges.ravel(), minlength=len(noded.points)) != 2
    kept[places] = True
    kept[_line_ends(noded, line_edges, noded.curve[on_line])] = True
    return Graph(noded.points, noded.edges, sides, home, kept), touching


def _line_ends(noded: Noded, edges: np.ndarray, line: np.ndarray) -> np.ndarray:
    """The points at which lines end: each line's edges have them once, or three times."""
    at = np.column_stack([noded.edges[edges].ravel(), np.repeat(line, 2)])
    ends, count = np.unique(at, axis=0, return_counts=True)
    return ends[count % 2 == 1, 0]


def _crossing(found: Crossing, n_loops: int, n_curves: int) -> ContourError:
    one, other = found.curves
    place = np.array(found.place)
    if max(one, other) >= n_curves:
        return _on_contour("A point lies on a contour or a line", place)
    if max(one, other) < n_loops:
        return meeting_error(one == other, found.place)
    x, y = found.place
    where = f"near ({x:.9g}, {y:.9g})"
    if min(one, other) < n_loops:
        message = f"A line crosses a contour {where}. Let it end there, or move it."
    else:
        with_ = "itself" if one == other else "another line"
        message = f"A line crosses {with_} {where}. Give both a vertex at that place, or move it."
    return ContourError("crossing", message, found.place)


def _outside(what: str, place: np.ndarray) -> ContourError:
    x, y = map(float, place)
    message = f"{what} outside the domain, at ({x:.9g}, {y:.9g}). Move it inside, or leave it out."
    return ContourError("outside", message, (x, y))


def _on_contour(what: str, place: np.ndarray) -> ContourError:
    x, y = map(float, place)
    message = f"{what}, at ({x:.9g}, {y:.9g}). Move it inside, or make it a part of the contour."
    return ContourError("on-contour", message, (x, y))


def _touching_warnings(places: np.ndarray) -> tuple[str, ...]:
    if not len(places):
        return ()
    x, y = places[0]
    more = f" and {len(places) - 1} more places" if len(places) > 1 else ""
    return (f"contours touch at ({x:.9g}, {y:.9g}){more}: they are meshed as they are, with a common vertex there",)


def _repeated_warnings(points: int, of_lines: int) -> tuple[str, ...]:
    """Warnings of points that must be vertices, and of points of lines, that are given again: how many."""
    twice = (f"{points} points that must be vertices are given more than once",) if points else ()
    return twice + ((f"{of_lines} repeated points of lines are left out",) if of_lines else ())
