"""Coarser boundaries of the same domains, for a mesh to start from (paper, Algorithm 5: "sample N_C vertices").

A mesh that is first made of large elements, whose edges are then halved again and again, has fewer vertices with five
or seven neighbours than one made small at once, and is better for it. How large elements may be is a matter of the
domain (`room.py`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .boundary import count_edges, even_spacing, turning_angles, until_simple
from .coarser_graphs import Chains, chains_of, levels_of_graph
from .cones import Cones, build_cones, join_places, lowest
from .contour import neighbours
from .finer import Arcs
from .gradation import Target
from .outlines import Outlines
from .room import find_room, sides_of_graph, sides_of_loops

MOST_LEVELS = 3
MOST_SEGMENTS = 5  # of the finer boundary to an edge of the coarser one
_HALF = 0.15  # what half as many edges may differ from the wanted number by


@dataclass(frozen=True)
class Coarsening:
    """Boundaries of several levels; those of a finer level hold all vertices of a coarser one.

    outlines: those of level 0, as they are; level: (n,) int, the coarsest that still has each of their points; levels:
    (d,) how many levels each domain has above 0; target: the edge length wanted at level 0; room: what elements have
    room for; chains: of the graphs of those domains that have levels.
    """

    outlines: Outlines
    level: np.ndarray
    levels: np.ndarray
    target: Target
    room: Cones | None
    chains: dict[int, Chains]

    def of_domains(self, numbers: np.ndarray) -> tuple[Coarsening, np.ndarray]:
        """That of some domains alone, and the numbers here of their regions."""
        some, _, regions = self.outlines.of_domains(numbers)
        chosen = np.isin(self.outlines.domain_of_points(), numbers)
        return replace(self, outlines=some, level=self.level[chosen]), regions

    def arcs(self, level: int, number: np.ndarray) -> Arcs:
        """What the next coarser level's edges along outlines come to; number: (v,) as of `Arcs`."""
        walks = [np.append(part, part[0]) for part in self._loops()]
        for domain, first in self.outlines.first_points.items():
            walks += [first + arc.vertices for arc in self.chains[domain].arcs]
        size, points = np.array([len(walk) for walk in walks]), self.outlines.all_points()
        return Arcs(points, np.concatenate(walks), size, self.level >= level + 1, self.level >= level, number)

    def _loops(self) -> list[np.ndarray]:
        """The numbers of each loop's points, from one that all levels have."""
        found, first = [], 0
        for loop in self.outlines.loops:
            start = np.argmax(self.level[first : first + len(loop)])
            found.append(first + np.roll(np.arange(len(loop)), -start))
            first += len(loop)
        return found

    def at_level(self, level: int) -> Outlines:
        """The outlines of a level."""
        if level == 0:
            return self.outlines
        outlines = self.outlines
        sizes = [len(loop) for loop in outlines.loops] + [len(graph.points) for graph in outlines.graphs.values()]
        kept = np.split(self.level >= level, np.cumsum(sizes)[:-1])
        loops = [loop[some] for loop, some in zip(outlines.loops, kept, strict=False)]
        rest = zip(outlines.graphs, kept[len(loops) :], strict=True)
        graphs = {domain: self.chains[domain].at_level(some)[0] for domain, some in rest}
        return replace(outlines, loops=loops, graphs=graphs)

    def wanted(self, level: int, points: np.ndarray, domain: np.ndarray) -> np.ndarray:
        """The edge length (n,) that is wanted at points (n, 2) of domains (n,) at a level."""
        fine = self.target(points, domain)
        rows = np.flatnonzero(self.levels[domain] > 0) if level else []
        if len(rows):
            large = fine[rows] * 2.0 ** np.minimum(level, self.levels[domain[rows]])
            large = lowest(self.room, points[rows], domain[rows], large)
            fine[rows] = np.maximum(fine[rows], large)
        return fine


def coarsen(outlines: Outlines, target: Target, corner_angle: float, most: np.ndarray) -> Coarsening:
    """Find how coarse a mesh of each domain may start, and the outlines of its levels.

    outlines: spaced as wanted; corner_angle: in radians; most: (d,) the largest number of levels of each domain.
    """
    places, levels = [], np.zeros(len(target.most), dtype=np.int64)
    chains = {n: chains_of(graph, corner_angle) for n, graph in outlines.graphs.items() if most[n]}
    for number in np.unique(outlines.domains):
        if number in outlines.graphs:
            sides = sides_of_graph(chains[number]) if number in chains else None
        else:
            mine = np.flatnonzero(outlines.domain == number)
            sides = sides_of_loops([outlines.loops[row] for row in mine], outlines.is_hole[mine])
        found = sides and find_room(sides, target.inside(int(number)), corner_angle, int(most[number]))
        if found:
            own, levels[number] = found
            places.append(replace(own, domain=np.full(len(own.value), number)))
    level = np.zeros(len(outlines.all_points()), dtype=np.int64)
    room = build_cones(join_places(places)) if places else None
    coarsening = Coarsening(outlines, level, levels, target, room, chains)
    of = np.repeat(outlines.domain, [len(loop) for loop in outlines.loops])
    rows = np.flatnonzero(levels[of] > 0)
    if len(rows):
        some = np.flatnonzero(levels[outlines.domain] > 0)
        loops = [outlines.loops[row] for row in some]
        level[rows] = _levels_of(loops, outlines.domain[some], coarsening, corner_angle)
    for number, first in outlines.first_points.items():
        if levels[number]:
            own = levels_of_graph(chains[number], _coarser, _wanted_in(coarsening, number), int(levels[number]))
            level[first : first + len(own)], levels[number] = own, own.max()
    return coarsening


def _wanted_in(coarsening: Coarsening, domain: int) -> Callable[[int, np.ndarray], np.ndarray]:
    """The length (k,) that is wanted in a domain at a level and points (k, 2)."""
    return lambda level, points: coarsening.wanted(level, points, np.full(len(points), domain))


def _levels_of(loops: list[np.ndarray], domain: np.ndarray, coarsening: Coarsening, corner_angle: float) -> np.ndarray:
    """The coarsest level (n,) that has each of the loops' vertices."""
    size = np.array([len(loop) for loop in loops], dtype=np.int64)
    points = np.concatenate(loops)
    before, after = neighbours(size)
    corner = np.abs(turning_angles(points, before, after)) > corner_angle
    level = np.zeros(len(points), dtype=np.int64)
    kept = np.arange(len(points))
    for number in range(1, int(coarsening.levels[domain].max()) + 1):
        of = np.searchsorted(np.cumsum(size), kept, side="right")
        own = np.bincount(of, minlength=len(loops))
        x = points[kept]
        _, following = neighbours(own)
        middle, edge = 0.5 * (x + x[following]), np.linalg.norm(x[following] - x, axis=1)
        passed = edge / coarsening.wanted(number, middle, domain[of])
        ends = np.cumsum(own)[:-1]
        chosen = [_coarser(*one) for one in zip(np.split(corner[kept], ends), np.split(passed, ends), strict=True)]
        loop = np.repeat(np.arange(len(loops)), [len(c) for c in chosen])
        position = np.concatenate(chosen).astype(np.float64)
        _, loop, position = until_simple(x, own, loop, position, domain)
        kept = kept[(np.cumsum(own) - own)[loop] + position.astype(np.int64)]
        level[kept] = number
    return level


def _coarser(corner: np.ndarray, passed: np.ndarray, fewest: int = 3) -> np.ndarray:
    """Which vertices of one loop stay, ascending: corners, and between them about one an edge that is wanted there.

    corner: (k,) bool; passed: (k,) wanted edges that each edge is long; fewest: edges that there are at least. Arcs
    whose edges all should be about twice as long keep every other vertex.
    """
    first = int(np.argmax(corner))
    corner, passed = np.roll(corner, -first), np.roll(passed, -first)
    corner[0] = True
    start, n = np.flatnonzero(corner), len(passed)
    size = np.diff(start, append=n)
    arcs = np.add.reduceat(passed, start)
    wanted = count_edges(arcs, fewest)
    halved = (size % 2 == 0) & (np.abs(2 * arcs - size) < _HALF * size)
    wanted = np.where(halved, size // 2, wanted)
    passed = np.where(np.repeat(halved, size), 0.5, passed)
    places = even_spacing(start, np.arange(n + 1.0), np.concatenate([[0.0], np.cumsum(passed)]), wanted)
    kept = np.unique(np.rint(places).astype(np.int64) % n)
    # No more between two than a sub-contour has room for, however close together they are.
    gap = np.diff(kept, append=kept[0] + n)
    parts = -(-gap // MOST_SEGMENTS)
    place = np.repeat(np.arange(len(kept)), parts)
    step = np.arange(len(place)) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.unique((kept[place] + gap[place] * step // parts[place] + first) % n)
