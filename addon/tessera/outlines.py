"""What bounds the regions of a batch of domains: contours that do not meet, and graphs where there is more to keep."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .arcs import resample_graph
from .boundary import resample_loops
from .bridges import bridge_holes
from .constraints import PlanarDomain
from .contour import Nesting, edges_of
from .cuts import graph_polygons
from .division import Polygons
from .gradation import Target
from .graph import Graph
from .spacing import Target as LengthAt


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

    @cached_property
    def first_points(self) -> dict[int, int]:
        """Where each graph's points start, by domain, when those of the loops come before, one loop after the other."""
        sizes = [sum(map(len, self.loops)), *(len(graph.points) for graph in self.graphs.values())]
        return dict(zip(self.graphs, np.cumsum(sizes)[:-1].tolist(), strict=True))

    def all_points(self) -> np.ndarray:
        """(p, 2) the points of the loops, then those of the graphs."""
        return np.concatenate([np.zeros((0, 2)), *self.loops, *(graph.points for graph in self.graphs.values())])

    def domain_of_points(self) -> np.ndarray:
        """(p,) the domain of each of them."""
        sizes = [len(part) for part in (*self.loops, *(graph.points for graph in self.graphs.values()))]
        return np.repeat(np.concatenate([self.domain, np.array(list(self.graphs), dtype=np.int64)]), sizes)

    def staying(self) -> np.ndarray:
        """(f, 2) edges of graphs between elements, by the numbers of their points, and points by themselves, twice."""
        found = [np.zeros((0, 2), dtype=np.int64)]
        for number, graph in self.graphs.items():
            alone = np.flatnonzero(graph.home >= 0)
            found.append(np.concatenate([graph.edges[graph.inner], np.column_stack([alone, alone])]))
            found[-1] += self.first_points[number]
        return np.concatenate(found)

    def of_domains(self, numbers: np.ndarray) -> tuple[Outlines, np.ndarray, np.ndarray]:
        """What bounds some domains by themselves, and the numbers here of their loops and of their regions."""
        rows = np.flatnonzero(np.isin(self.domain, numbers))
        graphs = {number: graph for number, graph in self.graphs.items() if number in set(numbers.tolist())}
        loops, region = [self.loops[row] for row in rows], np.searchsorted(rows, self.region[rows])
        some = Outlines(loops, region, self.is_hole[rows], self.domain[rows], graphs)
        return some, rows, np.flatnonzero(np.isin(self.domains, numbers))

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

    def points(self) -> tuple[np.ndarray, np.ndarray]:
        """Points (p, 2) that are on no edge and must be vertices, and the region that each is in (p,)."""
        places, of = [np.zeros((0, 2))], [np.zeros(0, dtype=np.int64)]
        for number, graph in self.graphs.items():
            alone = graph.home >= 0
            places.append(graph.points[alone])
            of.append(self.firsts[number] + graph.home[alone])
        return np.concatenate(places), np.concatenate(of)

    def together(self) -> np.ndarray:
        """(r,) the region whose number stands for each in `edges`: itself, or the first of its graph."""
        own = np.arange(len(self.domains))
        for number, graph in self.graphs.items():
            first = self.firsts[number]
            own[first : first + graph.n_regions] = first
        return own

    def polygons(self, edge_length: np.ndarray, target: LengthAt | None) -> tuple[np.ndarray, Polygons, np.ndarray]:
        """Points (p, 2), the polygons that tile the regions, and which of them are those of `all_points` (k,).

        edge_length: (r,) the longest target of each region; target: as of `division.divide`.
        """
        points, parts, own_points, total = [], [], [], 0
        if self.loops:
            longest = edge_length[: len(self.loops)]
            own, polygons = bridge_holes(self.loops, self.region, self.is_hole, longest, target)
            points, parts, total = [own], [polygons], len(own)
            own_points.append(np.arange(sum(map(len, self.loops))))
        for number, graph in self.graphs.items():
            first = self.firsts[number]
            longest = edge_length[first : first + graph.n_regions]
            own, polygons = graph_polygons(graph, longest, _shifted(target, first))
            points.append(own)
            parts.append(Polygons(polygons.corners + total, polygons.size, polygons.owner + first))
            own_points.append(total + np.arange(len(graph.points)))
            total += len(own)
        names = ("corners", "size", "owner")
        polygons = Polygons(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
        return np.concatenate(points), polygons, np.concatenate(own_points)


def outlines_of(results: list, nested: list[Nesting], planar: dict[int, PlanarDomain], numbers: list[int]) -> Outlines:
    """What bounds some domains: of all, the clean loops (or errors), how they are nested, and the planar ones."""
    simple = [number for number in numbers if number not in planar]
    loops = [loop for number in simple for loop in results[number]]
    domain = np.repeat(simple, [len(results[number]) for number in simple]).astype(np.int64)
    graphs = {number: planar[number].graph for number in numbers if number in planar}
    return Outlines(loops, *_regions([nested[number] for number in simple]), domain, graphs)


def resampled(outlines: Outlines, target: Target, corner_angle: float) -> Outlines:
    """The same with new vertices at the target edge length; corner_angle: in radians."""
    loops, graphs, constant = list(outlines.loops), {}, target.constant
    # By themselves where the target is the same everywhere, so that a batch changes nothing.
    for rows in (np.flatnonzero(constant[outlines.domain]), np.flatnonzero(~constant[outlines.domain])):
        if len(rows):
            domain = outlines.domain[rows]
            spacing = target.most[domain] if constant[domain[0]] else target
            new = resample_loops([loops[row] for row in rows], spacing, domain, corner_angle)
            for row, loop in zip(rows, new, strict=True):
                loops[row] = loop
    for number, graph in outlines.graphs.items():
        spacing = float(target.most[number]) if constant[number] else target.inside(number)
        graphs[number] = resample_graph(graph, spacing, corner_angle)
    return replace(outlines, loops=loops, graphs=graphs)


def _regions(nested: list[Nesting]) -> tuple[np.ndarray, np.ndarray]:
    """Of all loops of domains, one behind the other: the number of the outer contour around each (l,), and the holes.

    An outer contour is its own; the numbers count all the loops.
    """
    region, is_hole, first = [], [], 0
    for loops in nested:
        own = np.arange(len(loops.outer) + len(loops.holes))
        own[loops.holes] = loops.parent
        region.append(own + first)
        is_hole.append(np.isin(np.arange(len(own)), loops.holes))
        first += len(own)
    if not region:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool)
    return np.concatenate(region), np.concatenate(is_hole)


def _shifted(target: LengthAt | None, first: int) -> LengthAt | None:
    """The target for owners that are numbered from `first` on."""
    return None if target is None else lambda places, owner: target(places, owner + first)
