"""What bounds the regions of a batch of domains: contours that do not meet, and graphs where there is more to keep."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .bridges import bridge_holes
from .contour import edges_of
from .cuts import graph_polygons
from .division import Polygons
from .graph import Graph
from .spacing import Target


@dataclass(frozen=True)
class Outlines:
    """Regions are numbered through the batch: by their outer loops, then those of one graph after the other.

    loops: simple counter-clockwise polygons (k, 2); region (l,): the outer loop around each, is_hole (l,), domain (l,);
    graphs: by domain.
    """

    loops: list[np.ndarray]
    region: np.ndarray
    is_hole: np.ndarray
    domain: np.ndarray
    graphs: dict[int, Graph]

    @cached_property
    def domains(self) -> np.ndarray:
        """(r,) the domain of each region."""
        count = [graph.n_regions for graph in self.graphs.values()]
        return np.concatenate([self.domain, np.repeat(np.array(list(self.graphs), dtype=np.int64), count)])

    @cached_property
    def firsts(self) -> dict[int, int]:
        """The number of each domain's first region."""
        domain, first = np.unique(self.domains, return_index=True)
        return dict(zip(domain.tolist(), first.tolist(), strict=True))

    def edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Start and end (e, 2) of all edges, and the region of each (e,): of a graph's edges, its first one."""
        starts, ends, of = [np.zeros((0, 2))], [np.zeros((0, 2))], [np.zeros(0, dtype=np.int64)]
        if self.loops:
            start, end = edges_of(self.loops)
            starts.append(start)
            ends.append(end)
            of.append(np.repeat(self.region, [len(loop) for loop in self.loops]))
        for number, graph in self.graphs.items():
            starts.append(graph.points[graph.edges[:, 0]])
            ends.append(graph.points[graph.edges[:, 1]])
            of.append(np.full(len(graph.edges), self.firsts[number]))
        return np.concatenate(starts), np.concatenate(ends), np.concatenate(of)

    def together(self) -> np.ndarray:
        """(r,) the region whose number stands for each in `edges`: itself, or the first of its graph."""
        own = np.arange(len(self.domains))
        for number, graph in self.graphs.items():
            first = self.firsts[number]
            own[first : first + graph.n_regions] = first
        return own

    def polygons(
        self, edge_length: np.ndarray, target: Target | None
    ) -> tuple[np.ndarray, Polygons, np.ndarray | None]:
        """Points (p, 2), the polygons that tile the regions, and edges (f, 2) that stay, a point by itself too.

        edge_length: (r,) the longest target of each region; target: as of `division.divide`. The last is None where
        there are no graphs.
        """
        if not self.graphs:
            return *bridge_holes(self.loops, self.region, self.is_hole, edge_length, target), None
        points, parts, fixed, total = [], [], [], 0
        if self.loops:
            longest = edge_length[: len(self.loops)]
            own, polygons = bridge_holes(self.loops, self.region, self.is_hole, longest, target)
            points, parts, total = [own], [polygons], len(own)
        for number, graph in self.graphs.items():
            first = self.firsts[number]
            longest = edge_length[first : first + graph.n_regions]
            own, polygons, stay = graph_polygons(graph, longest, _shifted(target, first))
            points.append(own)
            parts.append(Polygons(polygons.corners + total, polygons.size, polygons.owner + first))
            fixed.append(stay + total)
            total += len(own)
        names = ("corners", "size", "owner")
        polygons = Polygons(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
        return np.concatenate(points), polygons, np.concatenate(fixed)


def _shifted(target: Target | None, first: int) -> Target | None:
    """The target for owners that are numbered from `first` on."""
    return None if target is None else lambda places, owner: target(places, owner + first)
