"""Refinement of a coarse mesh by the scheme itself (paper, Algorithms 5 and 6).

Every edge off the boundary that is longer than the sizing function wants is split into at most five segments, each as
long as it is wanted there; every element with a split edge becomes a sub-contour, meshed by the scheme at its own mean
edge length, or four elements where all three are halved; NN2 recomputes the places of the inner vertices; until no edge
is split. (The listing's condition to split, ``|l_e - l_s| < eps``, is a misprint.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .assembly import mean_edge_lengths, mesh_cells
from .cavity import areas
from .contour import neighbours
from .crossings import crossing_pairs
from .edges import among, inner_edges, off_boundary, sides
from .finer import Arcs
from .halving import find_halved, four_elements
from .quality import element_quality
from .relaxation import relax
from .roles import THOROUGH, Roles
from .scheme import LARGEST_CONTOUR
from .steps import Steps, within
from .stopwatch import Stopwatch

MOST_SEGMENTS = 5
# An element flatter than this, or than so many times the rounding of its coordinates over its longest edge, keeps its
# edges: its sub-contour could cross itself by the rounding of inserted vertices.
_SLIVER, _ROUNDINGS = 1e-6, 64
# Where along an edge the sizing function is asked.
_STATIONS = np.arange(0.1, 1.0, 0.2)
# Edges no longer than this, times the length that is wanted in the middle, are one segment: it does not change so fast.
_SURELY_ONE = 1.1
_MOST_ROUNDS = 20  # five to the power of it is more than any ratio of lengths

Sizing = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Refined:
    """A finer mesh: vertices (n, 2), the old ones first; triangles (t, 3); the old triangle that each is part of (t,).

    fallbacks: (m,) of each old triangle; number: (n,) the point of the boundary that each vertex is, or -1; failed:
    domains whose boundary does not fit the mesh: their triangles are the old ones; fixed: (f, 2) the finer edges.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    parent: np.ndarray
    fallbacks: np.ndarray
    number: np.ndarray
    failed: np.ndarray
    fixed: np.ndarray | None


def refine(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    sizing: Sizing,
    watch: Stopwatch,
    arcs: Arcs | None = None,
    fixed: np.ndarray | None = None,
    roles: Roles = THOROUGH,
) -> Steps[Refined]:
    """Refine a mesh until its inner edges follow the sizing function, and boundary and fixed ones the arcs, if any.

    vertices: (n, 2); triangles: (m, 3); domain: (m,) int of each triangle; sizing: (k, 2) points and the domains (k,)
    that they are in -> (k,) wanted edge lengths; fixed: (f, 2) edges that are split by arcs alone, as the boundary is;
    roles: the networks that are asked.
    """
    parent = np.arange(len(triangles))
    fallbacks = np.zeros(len(triangles), dtype=np.int64)
    number = np.full(len(vertices), -1) if arcs is None else arcs.number
    failed = np.zeros(0, dtype=np.int64)
    for turn in range(_MOST_ROUNDS):
        start, end = 1 - 0.25**turn, 1 - 0.25 ** (turn + 1)
        edges, inner = inner_edges(triangles)
        home = np.zeros(len(vertices), dtype=np.int64)
        home[triangles] = domain[parent][:, None]
        home = home[edges[:, 0]]
        stays = among(edges, fixed)
        inner &= ~stays
        may_split = inner & ~_beside_slivers(vertices, triangles, edges) & ~np.isin(home, failed)
        with watch("sizing"):
            segments, wanted = _segments(vertices[edges], may_split, home, sizing)
        if turn and segments.max(initial=1) > 1:
            # Again, once the vertices have better places; only in domains that are not done, as if each were alone.
            unfinished = np.isin(home, home[segments > 1])
            rows = np.isin(domain[parent], home[unfinished])
            free = off_boundary(triangles, len(vertices), fixed)
            relaxation = relax(vertices, triangles[rows], domain[parent[rows]], free, 1, watch)
            vertices = yield from within(relaxation, start, start)
            with watch("sizing"):
                segments, wanted = _segments(vertices[edges], may_split & unfinished, home, sizing)
        points, places = _inserted(vertices[edges], segments, wanted), np.full((segments - 1).sum(), -1)
        if arcs is not None:
            segments, points, places = _with_arcs(arcs, edges, ~inner, segments, points)
            fixed = _split_fixed(fixed, edges, stays, segments, len(vertices))
        if segments.max(initial=1) == 1:
            break
        points = np.concatenate([vertices, points])
        cells = _sub_contours(len(vertices), triangles, edges, segments)
        split = (cells[:, 3:] >= 0).any(axis=1)
        if arcs is not None:
            arcs, bad = None, _unfit(points, cells, np.append(number, places))
            failed = np.unique(domain[parent[bad]])
            split &= ~np.isin(domain[parent], failed)
        meshing = _mesh_split(points, cells, split, len(vertices), watch, roles)
        vertices, new, row, fell = yield from within(meshing, start, end)
        number = np.concatenate([number, places, np.full(len(vertices) - len(points), -1)])
        np.add.at(fallbacks, parent, fell)
        triangles = np.concatenate([triangles[~split], new])
        parent = np.concatenate([parent[~split], parent[row]])
    return Refined(vertices, triangles, parent, fallbacks, number, failed, fixed)


def _with_arcs(
    arcs: Arcs, edges: np.ndarray, on_boundary: np.ndarray, segments: np.ndarray, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Segments (e,), and inserted points and the boundary's points that they are, where boundary edges are split, too.

    segments, points: without these.
    """
    inserted, between = arcs.between(edges[on_boundary])
    old, segments = segments, segments.copy()
    segments[on_boundary] = inserted + 1
    of_arc = np.repeat(on_boundary, segments - 1)
    all_points, places = np.zeros((len(of_arc), 2)), np.full(len(of_arc), -1)
    all_points[of_arc], places[of_arc] = arcs.points[between], between
    all_points[~of_arc] = points[np.repeat(~on_boundary, old - 1)]
    return segments, all_points, places


def _split_fixed(
    fixed: np.ndarray | None, edges: np.ndarray, stays: np.ndarray, segments: np.ndarray, n: int
) -> np.ndarray | None:
    """The fixed edges (f, 2), once edges (e, 2), of which they are some (e,), have come to segments (e,).

    n: from which inserted vertices count, each edge's from its start to its end. Points by themselves stay.
    """
    if fixed is None:
        return None
    edge = np.repeat(np.flatnonzero(stays), segments[stays])
    step = np.arange(len(edge)) - np.repeat(np.cumsum(segments[stays]) - segments[stays], segments[stays])
    first = (np.cumsum(segments - 1) - (segments - 1))[edge] + n
    start = np.where(step == 0, edges[edge, 0], first + step - 1)
    end = np.where(step == segments[edge] - 1, edges[edge, 1], first + step)
    return np.concatenate([np.column_stack([start, end]), fixed[fixed[:, 0] == fixed[:, 1]]])


def _unfit(points: np.ndarray, cells: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Rows of cells (m, N) that the scheme cannot mesh: of over 16 vertices, or no simple counter-clockwise polygons.

    number: (p,) of the boundary's points, or -1; without two of them a cell is the triangle that it was.
    """
    rows = np.flatnonzero(((number[cells] >= 0) & (cells >= 0)).sum(axis=1) > 1)
    count = (cells[rows] >= 0).sum(axis=1)
    corners, row = cells[rows][cells[rows] >= 0], np.repeat(rows, count)
    _, after = neighbours(count)
    pairs = crossing_pairs(points[corners], points[corners[after]], row)
    reversed_ = areas(points[cells[rows]], count) <= 0
    return np.concatenate([row[pairs[:, 0]], rows[reversed_ | (count > LARGEST_CONTOUR)]])


def _mesh_split(
    points: np.ndarray, cells: np.ndarray, split: np.ndarray, first: int, watch: Stopwatch, roles: Roles
) -> Steps[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Mesh the split ones (m,) of the sub-contours (m, N); first: from which points are counted that were inserted.

    Returns vertices (n, 2), the points first; triangles (t, 3); the row of each (t,); fallbacks of each row (m,).
    """
    halved = split & find_halved(points, cells, first)
    rest = np.flatnonzero(split & ~halved)
    contours, fallbacks = cells[rest, :LARGEST_CONTOUR], np.zeros(len(cells), dtype=np.int64)
    lengths = mean_edge_lengths(points, contours)
    vertices, triangles, owner, fallbacks[rest] = yield from mesh_cells(points, contours, lengths, watch, roles=roles)
    triangles = np.concatenate([four_elements(cells[halved]), triangles])
    return vertices, triangles, np.concatenate([np.repeat(np.flatnonzero(halved), 4), rest[owner]]), fallbacks


def _segments(
    ends: np.ndarray, may_split: np.ndarray, domain: np.ndarray, sizing: Sizing
) -> tuple[np.ndarray, np.ndarray]:
    """How many segments edges (e, 2, 2) come to (e,), and the lengths wanted at their stations (e, 5) if it is several.

    may_split: (e,) bool; domain: (e,).
    """
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    segments, wanted = np.ones(len(ends), dtype=np.int64), np.ones((len(ends), len(_STATIONS)))
    rows = np.flatnonzero(may_split)
    rows = rows[length[rows] > _SURELY_ONE * sizing(ends[rows].mean(axis=1), domain[rows])]
    along = ends[rows, :1] + _STATIONS[:, None] * (ends[rows, 1:] - ends[rows, :1])
    wanted[rows] = sizing(along.reshape(-1, 2), np.repeat(domain[rows], len(_STATIONS))).reshape(-1, len(_STATIONS))
    segments[rows] = np.clip(np.rint(length[rows] * (1 / wanted[rows]).mean(axis=1)), 1, MOST_SEGMENTS)
    return segments, wanted


def _beside_slivers(vertices: np.ndarray, triangles: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(e,) which edges belong to an element that is too flat to be split."""
    x, y = vertices[:, 0][triangles.T], vertices[:, 1][triangles.T]
    longest = np.sqrt(((x - np.roll(x, 1, axis=0)) ** 2 + (y - np.roll(y, 1, axis=0)) ** 2).max(axis=0))
    rounding = _ROUNDINGS * np.spacing(np.abs(vertices).max(axis=1))[triangles.T].max(axis=0)
    flat = element_quality(vertices, triangles) * longest < np.maximum(_SLIVER * longest, rounding)
    return among(edges, sides(triangles[flat]))


def _inserted(ends: np.ndarray, segments: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Vertices (k, 2) that divide edges (e, 2, 2) into segments (e,), each edge's from its start to its end.

    wanted: (e, 5) lengths at `_STATIONS`.
    """
    edge = np.repeat(np.arange(len(ends)), segments - 1)
    step = np.arange(len(edge)) - (np.cumsum(segments - 1) - (segments - 1))[edge] + 1
    start, end = ends[edge, 0], ends[edge, 1]
    passed = np.concatenate([np.zeros((len(ends), 1)), np.cumsum(1 / wanted, axis=1)], axis=1)
    reached = passed[edge, -1] * (step / segments[edge])
    part = np.minimum(np.sum(passed[edge] <= reached[:, None], axis=1) - 1, len(_STATIONS) - 1)
    share = (part + (reached - passed[edge, part]) * wanted[edge, part]) / len(_STATIONS)
    return start + share[:, None] * (end - start)


def _sub_contours(n: int, triangles: np.ndarray, edges: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Each triangle's contour (m, N), N at least 15, padded with -1, when its edges are split.

    n: from which inserted vertices count; segments: (e,) how many each edge comes to.
    """
    first = np.cumsum(segments - 1) - (segments - 1)
    stride = int(triangles.max()) + 1
    key = edges[:, 0] * stride + edges[:, 1]
    start, end = triangles.astype(np.int64), np.roll(triangles, -1, axis=1).astype(np.int64)
    of = np.searchsorted(key, np.minimum(start, end) * stride + np.maximum(start, end))
    count = segments[of]
    place = np.cumsum(count, axis=1) - count
    cells = np.full((len(triangles), max(3 * MOST_SEGMENTS, int(count.sum(axis=1).max()))), -1, dtype=np.int64)
    np.put_along_axis(cells, place, start, axis=1)
    for k in range(1, int(segments.max())):
        row, side = np.nonzero(count > k)
        ahead = start[row, side] < end[row, side]
        along = np.where(ahead, k - 1, count[row, side] - 1 - k)
        cells[row, place[row, side] + k] = n + first[of[row, side]] + along
    return cells
