"""How large the elements of a domain may be at first: several fit across its thin parts, and round parts stay round."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .coarser_graphs import Chains
from .cones import Places, build_cones, join_places, lowest
from .contour import edges_of
from .graph import Graph
from .thickness import thin_parts

# Of the largest elements, so many fit across thin parts, or beside a point by itself, and their edges are at most so
# many radii of curvature long.
_ACROSS, _BESIDE, _CURVED = 4.5, 2.0, 0.6
_SLOPE = 0.4  # how fast they may grow from there, in length per length
# Levels at which elements would be twice as large beside at least this share of the boundary are worth while; and one,
# inside a rough boundary, where there are twice as many elements as these to each of its edges, two where four times.
_SHARE, _DEEP = 0.5, 4
_FEWEST = 12  # edges that are left along the boundary
_EQUILATERAL = 4 / np.sqrt(3)  # triangles in the square of their edge length
_MOST_PAIRS = 1 << 22  # of points by themselves and what they might be close to


@dataclass(frozen=True)
class Sides:
    """What a domain is bounded by.

    start, end: (e, 2) edges with the domain to the left of each, those inside it in both directions; ways: polylines
    (k, 2), along which it may be curved; places (p, 2): points by themselves, and how far each is from all else (p,).
    """

    start: np.ndarray
    end: np.ndarray
    ways: list[np.ndarray]
    places: np.ndarray
    clear: np.ndarray


def sides_of_loops(loops: list[np.ndarray], is_hole: np.ndarray) -> Sides:
    """Those of a domain of counter-clockwise polygons (k, 2); is_hole: (l,) bool."""
    start, end = edges_of([loop[::-1] if hole else loop for loop, hole in zip(loops, is_hole, strict=True)])
    ways = [np.concatenate([loop[-1:], loop, loop[:1]]) for loop in loops]
    return Sides(start, end, ways, np.zeros((0, 2)), np.zeros(0))


def sides_of_graph(chains: Chains) -> Sides | None:
    """Those of a graph; None where it has too many points by themselves."""
    graph, arc = chains.at_level(np.ones(len(chains.graph.points), dtype=bool))
    ends = np.concatenate([graph.edges[graph.sides[:, 0] >= 0], graph.edges[graph.sides[:, 1] >= 0, ::-1]])
    found = _clearances(graph, arc)
    if found is None:
        return None
    return Sides(*graph.points[ends.T], [graph.points[arc.vertices] for arc in chains.arcs], *found)


def find_room(
    sides: Sides, target: Callable[[np.ndarray], np.ndarray], corner_angle: float, most: int
) -> tuple[Places, int] | None:
    """What large elements of one domain have room for, and how many levels that makes; None if it makes none.

    target: of points (n, 2); corner_angle: in radians; most: levels.
    """
    start, end = sides.start, sides.end
    middle, length = 0.5 * (start + end), np.linalg.norm(end - start, axis=1)
    fine = target(middle)
    # No more levels than leave a few elements along the boundary.
    most = min(most, int(np.log2(max(np.sum(length / fine) / _FEWEST, 1))))
    if most == 0:
        return None
    longest, shortest = 2.0**most * float(fine.max()), float(fine.min())
    here, there = thin_parts(start, end, _ACROSS, longest, shortest)
    parts = [_places(here, there, np.linalg.norm(there - here, axis=1) / _ACROSS)]
    parts += [_curved(way, corner_angle, longest) for way in sides.ways]
    parts.append(_places(sides.places, sides.places, np.maximum(sides.clear / _BESIDE, shortest)))
    places = join_places(parts)
    large = lowest(build_cones(places), middle, np.zeros(len(middle), dtype=np.int64), 2.0**most * fine)
    ratio = np.sort(large / fine)[int(_SHARE * len(fine))]
    area = 0.5 * np.sum(start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0])
    deep = _EQUILATERAL * area / fine.max() ** 2 / len(fine) / _DEEP
    levels = min(most, int(max(np.log2(max(ratio, 1)) + 0.2, np.log2(max(deep, 1)))))
    return (places, levels) if levels else None


def _curved(way: np.ndarray, corner_angle: float, longest: float) -> Places:
    """`_CURVED` times the radius of curvature, at each vertex of a polyline (k, 2), but its ends, that is no corner."""
    goes = np.diff(way, axis=0)
    edge = np.linalg.norm(goes, axis=1)
    (x, y), (u, v) = goes[:-1].T, goes[1:].T
    turning = np.abs(np.arctan2(x * v - y * u, x * u + y * v))
    with np.errstate(divide="ignore"):
        value = _CURVED * 0.5 * (edge[1:] + edge[:-1]) / turning
    curved = (turning <= corner_angle) & (value < longest)
    return _places(way[1:-1][curved], way[1:-1][curved], value[curved])


def _places(start: np.ndarray, end: np.ndarray, value: np.ndarray) -> Places:
    return Places(start, end, value, np.full(len(value), _SLOPE), np.zeros(len(value), dtype=np.int64))


def _clearances(graph: Graph, arc: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Lone points and ends of lines (k, 2), and how far each is from all else (k,); None where there are too many.

    arc: (e,) of each edge. An end of a line is as far from all other arcs, and from other such ends.
    """
    degree = np.bincount(graph.edges.ravel(), minlength=len(graph.points))
    (single,) = np.nonzero((degree == 1) | (graph.home >= 0))
    if len(single) * (len(graph.edges) + len(single)) > _MOST_PAIRS:
        return None
    own = np.full(len(graph.points), -1)
    own[graph.edges] = arc[:, None]
    at, (start, end) = graph.points[single], graph.points[graph.edges.T]
    along = end - start
    share = np.sum((at[:, None] - start) * along, axis=2) / np.sum(along * along, axis=1)
    foot = start + np.clip(share, 0, 1)[..., None] * along
    away = np.linalg.norm(at[:, None] - foot, axis=2)
    away[own[single][:, None] == arc] = np.inf
    others = np.linalg.norm(at[:, None] - at, axis=2)
    np.fill_diagonal(others, np.inf)
    return at, np.column_stack([away, others]).min(axis=1, initial=np.inf)
