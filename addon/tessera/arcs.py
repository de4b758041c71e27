"""New vertices on the edges of a graph at the target edge length: every arc once, whatever regions are beside it.

An arc is a chain of edges between two vertices that stay, or a closed one without such a vertex. It is resampled as a
contour is (`boundary.py`). Then no edges may meet, and each side of each arc must be in the same face as before: where
it is not so, given vertices are inserted until it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .boundary import PATIENCE, knots_of, resampled_places, vertices_as_knots
from .crossings import crossing_pairs
from .faces import find_cycles
from .graph import Graph, graph_faces, half_edges


@dataclass(frozen=True)
class Arc:
    """vertices (k + 1,) by number, the last of a closed one is the first again; sides: of its edges; free: no end."""

    vertices: np.ndarray
    sides: np.ndarray
    free: bool


@dataclass(frozen=True)
class _Sampled:
    """A graph whose edges are pieces of arcs: arc (e,), and where along it they start and end (e,), in given edges."""

    graph: Graph
    arc: np.ndarray
    start: np.ndarray
    end: np.ndarray


def resample_graph(graph: Graph, edge_length: float | Callable[[np.ndarray], np.ndarray], corner_angle: float) -> Graph:
    """The graph with new vertices on its edges; those that are `kept`, and corners, stay.

    edge_length: one, or a function of points (n, 2); corner_angle: in radians. Loops over the arcs.
    """
    arcs = [from_a_corner(graph, arc, corner_angle) for arc in find_arcs(graph)]
    if not arcs:
        return graph
    points = [graph.points[arc.vertices] for arc, _ in arcs]
    length = np.array([len(part) - 1 for part in points])
    if callable(edge_length):
        start, end = (np.concatenate(ends) for ends in zip(*((p[:-1], p[1:]) for p in points), strict=True))
        knots = knots_of(start, end, length, np.zeros(len(arcs), dtype=np.int64), lambda at, _: edge_length(at))
    else:
        knots = [vertices_as_knots(part, edge_length) for part in points]
    places = [
        resampled_places(breaks, *knot, fewest=3 if arc.vertices[0] == arc.vertices[-1] else 1)
        for (arc, breaks), knot in zip(arcs, knots, strict=True)
    ]
    arcs = [arc for arc, _ in arcs]
    given = _sampled(graph, arcs, [np.arange(n, dtype=float) for n in length])
    faces = faces_beside(given.graph, given.arc)
    rounds = 0
    while True:
        sampled = _sampled(graph, arcs, places)
        bad = bad_edges(sampled.graph, sampled.arc, faces)
        if not bad.any():
            return sampled.graph
        inserted = _given_between(graph, arcs, sampled, np.flatnonzero(bad), rounds < PATIENCE)
        if not inserted:
            places = [np.arange(n, dtype=float) for n in length]
        for arc, more in inserted:
            places[arc] = np.union1d(places[arc], more)
        rounds += 1


def find_arcs(graph: Graph) -> list[Arc]:
    """The arcs of a graph, each in the direction of its first edge."""
    tails, heads, back = half_edges(graph.edges)
    n = len(graph.edges)
    # A vertex that does not stay has two edges: what leaves it is what came, reversed, or the other one.
    both = np.bincount(tails, np.arange(2 * n), minlength=len(graph.points)).astype(np.int64)
    after = np.where(graph.kept[heads], back, both[heads] - back)
    walk, size = find_cycles(after)
    arcs = []
    for path in np.split(walk, np.cumsum(size)[:-1]) if n else ():
        starts = np.flatnonzero(graph.kept[tails[path]])
        if len(starts):  # there, and back again
            begin, end = starts if starts[0] == 0 else (starts[1], starts[0] + len(path))
            path = np.take(path, np.arange(begin, end), mode="wrap")
        elif path[np.argmin(path % n)] >= n:
            continue
        edge, turned = np.divmod(path[0], n)[::-1]
        sides = graph.sides[edge][:: -1 if turned else 1]
        arcs.append(Arc(np.append(tails[path], heads[path[-1]]), sides, len(starts) == 0))
    return arcs


def from_a_corner(graph: Graph, arc: Arc, corner_angle: float) -> tuple[Arc, np.ndarray]:
    """The arc, a free one turned to start at a corner or at its leftmost vertex; which vertices but the last stay."""
    points = graph.points[arc.vertices]
    goes = np.diff(points, axis=0)
    came = np.roll(goes, 1, axis=0)
    turning = np.arctan2(came[:, 0] * goes[:, 1] - came[:, 1] * goes[:, 0], np.sum(came * goes, axis=1))
    corner = np.abs(turning) > corner_angle
    if arc.free:
        first = np.lexsort((points[:-1, 1], points[:-1, 0], ~corner))[0]
        around = np.roll(arc.vertices[:-1], -first)
        arc, corner = Arc(np.append(around, around[0]), arc.sides, True), np.roll(corner, -first)
    corner[0] = True
    return arc, corner


def _sampled(graph: Graph, arcs: list[Arc], places: list[np.ndarray]) -> _Sampled:
    """The graph with vertices at some places of each arc: first the vertices that stay, then those of the arcs."""
    (stay,) = np.nonzero(graph.kept)
    number = np.full(len(graph.points), -1)
    number[stay] = np.arange(len(stay))
    points, edges, total = [graph.points[stay]], [], len(stay)
    for arc, at in zip(arcs, places, strict=True):
        edge = at.astype(np.int64)
        share = (at - edge)[:, None]
        start, end = graph.points[arc.vertices[edge]], graph.points[arc.vertices[edge + 1]]
        new = np.where(share == 0, start, (1 - share) * start + share * end)
        skip = 0 if arc.free else 1
        own = total + np.arange(len(new) - skip)
        ends = [own[:1]] if arc.free else [number[arc.vertices[-1:]]]
        path = np.concatenate([own[:0] if arc.free else number[arc.vertices[:1]], own, *ends])
        points.append(new[skip:])
        edges.append(np.column_stack([path[:-1], path[1:]]))
        total += len(own)
    count = [len(part) for part in edges]
    sides = np.repeat(np.array([arc.sides for arc in arcs]), count, axis=0)
    finish = [np.append(at[1:], len(arc.vertices) - 1) for arc, at in zip(arcs, places, strict=True)]
    home, kept = np.full(total, -1), np.zeros(total, dtype=bool)
    home[: len(stay)], kept[: len(stay)] = graph.home[stay], True
    new = Graph(np.concatenate(points), np.concatenate(edges), sides, home, kept)
    return _Sampled(new, np.repeat(np.arange(len(arcs)), count), np.concatenate(places), np.concatenate(finish))


def faces_beside(graph: Graph, arc: np.ndarray) -> np.ndarray:
    """Which face is to the left and to the right of each arc, and around each vertex that stays and has no edges.

    arc: (e,) that each of the graph's edges is part of. Faces are named by the first arc's side that they have, the
    unbounded one is -1.
    """
    faces = graph_faces(graph.points, graph.edges)
    _, first = np.unique(arc, return_index=True)
    beside = faces.of_half_edge[np.concatenate([first, first + len(arc)])]
    name = np.full(faces.count, len(beside))
    np.minimum.at(name, beside, np.arange(len(beside)))
    name[-1] = -1
    stay = faces.of_point[graph.kept]
    return np.concatenate([name[beside], np.where(stay < 0, -2, name[stay])])


def bad_edges(graph: Graph, arc: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(e,) which edges meet others; if none do, those of arcs that have other faces beside them than before."""
    alone = np.setdiff1d(np.flatnonzero(graph.kept), graph.edges)
    ends = np.concatenate([graph.edges, np.column_stack([alone, alone])])
    pairs = crossing_pairs(graph.points[ends[:, 0]], graph.points[ends[:, 1]], np.zeros(len(ends), dtype=np.int64))
    bad = np.zeros(len(ends), dtype=bool)
    bad[pairs.ravel()] = True
    bad = bad[: len(graph.edges)]
    if bad.any():
        return bad
    changed = faces_beside(graph, arc) != faces
    arcs = changed[: 2 * (int(arc.max()) + 1)].reshape(2, -1).any(axis=0)
    return arcs[arc] if arcs.any() else np.full(len(bad), changed.any())


def _given_between(
    graph: Graph, arcs: list[Arc], sampled: _Sampled, edges: np.ndarray, farthest: bool
) -> list[tuple[int, np.ndarray]]:
    """Given vertices that some edges pass by: the arc, and places on it; only the farthest of each edge, or all."""
    found = []
    for edge in edges:
        low, high = np.floor(sampled.start[edge]) + 1, np.ceil(sampled.end[edge]) - 1
        given = np.arange(low, high + 1)
        if farthest and len(given) > 1:
            a, b = sampled.graph.points[sampled.graph.edges[edge]]
            offset = graph.points[arcs[sampled.arc[edge]].vertices[given.astype(np.int64)]] - a
            away = np.abs(offset[:, 0] * (b - a)[1] - offset[:, 1] * (b - a)[0])
            given = given[[np.argmax(away)]]
        if len(given):
            found.append((int(sampled.arc[edge]), given))
    return found
