"""Coarser boundaries of the same domains, for a mesh to start from (paper, Algorithm 5: "sample N_C vertices").

A mesh that is first made of large elements, whose edges are then halved again and again, has fewer vertices with five
or seven neighbours than one made small at once, and is better for it. How large elements may be is a matter of the
domain: several fit across its thin parts, and a round boundary keeps its shape.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .boundary import count_edges, even_spacing, turning_angles, until_simple
from .cones import Cones, Places, build_cones, join_places, lowest
from .contour import edges_of, neighbours
from .finer import Arcs
from .gradation import Target
from .thickness import thin_parts

MOST_LEVELS = 3
MOST_SEGMENTS = 5  # of the finer boundary to an edge of the coarser one
# Of the largest elements, so many fit across thin parts, and their edges are at most so many radii of curvature long.
_ACROSS, _CURVED = 4.5, 0.6
_SLOPE = 0.4  # how fast they may grow from there, in length per length
# Levels at which elements would be twice as large beside at least this share of the boundary are worth while; and one,
# inside a rough boundary, where there are twice as many elements as these to each of its edges, two where four times.
_SHARE, _DEEP = 0.5, 4
_EQUILATERAL = 4 / np.sqrt(3)  # triangles in the square of their edge length
_HALF = 0.15  # what half as many edges may differ from the wanted number by


@dataclass(frozen=True)
class Coarsening:
    """Boundaries of several levels; those of a finer level hold all vertices of a coarser one.

    points (n, 2), size (m,): the loops, one behind the other; level: (n,) int, the coarsest that still has the vertex;
    levels: (d,) how many levels each domain has above 0, the loops as they are; target: the edge length wanted at level
    0; room: what elements have room for.
    """

    points: np.ndarray
    size: np.ndarray
    level: np.ndarray
    levels: np.ndarray
    target: Target
    room: Cones | None

    def of_loops(self, rows: np.ndarray) -> Coarsening:
        """That of some loops alone, by their numbers."""
        chosen = np.isin(np.repeat(np.arange(len(self.size)), self.size), rows)
        return replace(self, points=self.points[chosen], size=self.size[rows], level=self.level[chosen])

    def arcs(self, level: int, number: np.ndarray) -> Arcs:
        """What the boundary edges of the next coarser level's mesh come to; number: (v,) as of `Arcs`."""
        return Arcs(self.points, self.size, self.level >= level + 1, self.level >= level, number)

    def loops(self, level: int) -> list[np.ndarray]:
        """The boundaries of a level, (k, 2) each."""
        if not len(self.size):
            return []
        kept = self.level >= level
        count = np.add.reduceat(kept, np.cumsum(self.size) - self.size)
        return np.split(self.points[kept], np.cumsum(count)[:-1])

    def wanted(self, level: int, points: np.ndarray, domain: np.ndarray) -> np.ndarray:
        """The edge length (n,) that is wanted at points (n, 2) of domains (n,) at a level."""
        fine = self.target(points, domain)
        rows = np.flatnonzero(self.levels[domain] > 0) if level else []
        if len(rows):
            large = fine[rows] * 2.0 ** np.minimum(level, self.levels[domain[rows]])
            large = lowest(self.room, points[rows], domain[rows], large)
            fine[rows] = np.maximum(fine[rows], large)
        return fine


def coarsen(
    loops: list[np.ndarray],
    is_hole: np.ndarray,
    domain: np.ndarray,
    target: Target,
    corner_angle: float,
    most: np.ndarray,
) -> Coarsening:
    """Find how coarse a mesh of each domain may start, and the boundaries of its levels.

    loops: simple counter-clockwise polygons (k, 2), spaced as wanted; is_hole: (m,) bool; domain: (m,) int, as the
    target knows it; corner_angle: in radians; most: (d,) the largest number of levels of each domain.
    """
    places, levels = [], np.zeros(len(target.most), dtype=np.int64)
    for number in np.unique(domain):
        mine = np.flatnonzero(domain == number)
        found = _room([loops[k] for k in mine], is_hole[mine], target, number, corner_angle, int(most[number]))
        if found is not None:
            levels[number] = found[1]
            places.append(found[0])
    chosen = np.flatnonzero(levels[domain] > 0)
    size = np.array([len(loop) for loop in loops], dtype=np.int64)
    level = np.zeros(size.sum(), dtype=np.int64)
    points = np.concatenate([np.zeros((0, 2)), *loops])
    coarsening = Coarsening(points, size, level, levels, target, build_cones(join_places(places)) if places else None)
    if len(chosen):
        rows = np.flatnonzero(np.isin(np.repeat(np.arange(len(loops)), size), chosen))
        level[rows] = _levels_of([loops[k] for k in chosen], domain[chosen], coarsening, corner_angle)
    return coarsening


def _room(loops, is_hole, target: Target, number: int, corner_angle: float, most: int) -> tuple[Places, int] | None:
    """What large elements of one domain have room for, and how many levels that makes; None if it makes none."""
    start, end = edges_of([loop[::-1] if hole else loop for loop, hole in zip(loops, is_hole, strict=True)])
    middle, length = 0.5 * (start + end), np.linalg.norm(end - start, axis=1)
    of = np.full(len(start), number)
    fine = target(middle, of)
    # No more levels than leave a few elements along the boundary.
    most = min(most, int(np.log2(max(np.sum(length / fine) / 12, 1))))
    if most == 0:
        return None
    longest, shortest = 2.0**most * float(fine.max()), float(fine.min())
    here, there = thin_parts(start, end, _ACROSS, longest, shortest)
    parts = [_places(here, there, np.linalg.norm(there - here, axis=1) / _ACROSS, number)]
    for loop in loops:
        parts.append(_curved(loop, corner_angle, longest, number))
    places = join_places(parts)
    large = lowest(build_cones(places), middle, of, 2.0**most * fine)
    ratio = np.sort(large / fine)[int(_SHARE * len(fine))]
    area = 0.5 * np.sum(start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0])
    deep = _EQUILATERAL * area / fine.max() ** 2 / len(fine) / _DEEP
    levels = min(most, int(max(np.log2(max(ratio, 1)) + 0.2, np.log2(max(deep, 1)))))
    return (places, levels) if levels else None


def _curved(loop: np.ndarray, corner_angle: float, longest: float, number: int) -> Places:
    """`_CURVED` times the radius of curvature, at each vertex of a loop that is no corner."""
    turning = np.abs(turning_angles(loop, *neighbours(np.array([len(loop)]))))
    edge = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
    with np.errstate(divide="ignore"):
        value = _CURVED * 0.5 * (edge + np.roll(edge, 1)) / turning
    curved = (turning <= corner_angle) & (value < longest)
    return _places(loop[curved], loop[curved], value[curved], number)


def _places(start: np.ndarray, end: np.ndarray, value: np.ndarray, number: int) -> Places:
    return Places(start, end, value, np.full(len(value), _SLOPE), np.full(len(value), number))


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


def _coarser(corner: np.ndarray, passed: np.ndarray) -> np.ndarray:
    """Which vertices of one loop stay, ascending: corners, and between them about one an edge that is wanted there.

    corner: (k,) bool; passed: (k,) wanted edges that each edge is long. Arcs whose edges all should be about twice as
    long keep every other vertex.
    """
    first = int(np.argmax(corner))
    corner, passed = np.roll(corner, -first), np.roll(passed, -first)
    corner[0] = True
    start, n = np.flatnonzero(corner), len(passed)
    size = np.diff(start, append=n)
    arcs = np.add.reduceat(passed, start)
    wanted = count_edges(arcs)
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
