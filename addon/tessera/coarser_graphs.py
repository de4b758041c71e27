"""Coarser graphs of the same faces, for a domain with lines, points or several regions (`coarsening.py`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .arcs import Arc, bad_edges, faces_beside, find_arcs, from_a_corner
from .graph import Graph


@dataclass(frozen=True)
class Chains:
    """A graph, its arcs, and which of its points (p,) all levels have: corners, ends of arcs, points by themselves."""

    graph: Graph
    arcs: list[Arc]
    corner: np.ndarray

    def at_level(self, kept: np.ndarray) -> tuple[Graph, np.ndarray]:
        """The graph of the points that are kept (p,), arc by arc, and the arc (e,) that each edge is part of."""
        number, graph = np.cumsum(kept) - 1, self.graph
        paths = [number[arc.vertices[kept[arc.vertices]]] for arc in self.arcs]
        of = np.repeat(np.arange(len(paths)), [len(path) - 1 for path in paths])
        edges = np.concatenate([np.zeros((0, 2), dtype=np.int64), *(_edges_along(path) for path in paths)])
        sides = np.array([arc.sides for arc in self.arcs], dtype=np.int64).reshape(-1, 2)[of]
        return Graph(graph.points[kept], edges, sides, graph.home[kept], graph.kept[kept]), of


def _edges_along(path: np.ndarray) -> np.ndarray:
    return np.column_stack([path[:-1], path[1:]])


def chains_of(graph: Graph, corner_angle: float) -> Chains:
    """The arcs of a graph, closed ones from a corner; corner_angle: in radians. A loop over the arcs."""
    arcs, corner = [], graph.kept.copy()
    for arc in find_arcs(graph):
        arc, breaks = from_a_corner(graph, arc, corner_angle)
        corner[arc.vertices[:-1][breaks]] = True
        arcs.append(arc)
    return Chains(graph, arcs, corner)


def levels_of_graph(
    chains: Chains,
    coarser: Callable[[np.ndarray, np.ndarray, int], np.ndarray],
    wanted: Callable[[int, np.ndarray], np.ndarray],
    most: int,
) -> np.ndarray:
    """The coarsest level (p,) that has each point: 0 to `most`, or less where edges would meet or faces would change.

    coarser: as `coarsening.coarser`; wanted: the length (k,) at a level and points (k, 2).
    """
    points, kept = chains.graph.points, np.ones(len(chains.graph.points), dtype=bool)
    level = np.zeros(len(points), dtype=np.int64)
    faces = faces_beside(*chains.at_level(kept))
    for number in range(1, most + 1):
        paths = [arc.vertices[kept[arc.vertices]] for arc in chains.arcs]
        start, end = points[np.concatenate([_edges_along(path) for path in paths]).T]
        passed = np.linalg.norm(end - start, axis=1) / wanted(number, 0.5 * (start + end))
        kept = chains.corner.copy()
        for path, part in zip(paths, np.split(passed, np.cumsum([len(path) - 1 for path in paths])[:-1]), strict=True):
            fewest = 3 if path[0] == path[-1] else 1
            kept[path[coarser(chains.corner[path[:-1]], part, fewest)]] = True
        if bad_edges(*chains.at_level(kept), faces).any():
            break
        level[kept] = number
    return level
