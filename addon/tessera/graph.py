"""Plane graphs: the contours, lines and points of a domain on common vertices, and the faces between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .contour import points_inside, starting_between
from .faces import find_faces
from .predicates import orientation


@dataclass(frozen=True)
class Graph:
    """Straight edges that meet at common ends only.

    points (p, 2) float64; edges (e, 2) int64, by numbers of points; sides (e, 2) int64: the regions to the left and to
    the right of each edge, -1 for what is not meshed; home (p,) int64: the region around each point without edges, -1
    for all others; kept (p,) bool: which points stay when the edges get new vertices.
    """

    points: np.ndarray
    edges: np.ndarray
    sides: np.ndarray
    home: np.ndarray
    kept: np.ndarray

    @property
    def inner(self) -> np.ndarray:
        """(e,) which edges have elements on both sides."""
        return (self.sides >= 0).all(axis=1)

    @property
    def n_regions(self) -> int:
        """One more than the largest number of a region."""
        return int(max(self.sides.max(), self.home.max())) + 1

    def length(self) -> float:
        """The length of all edges."""
        return float(np.linalg.norm(self.points[self.edges[:, 1]] - self.points[self.edges[:, 0]], axis=1).sum())

    def area(self) -> float:
        """The area of all regions."""
        x, y = (self.points - self.points[0]).T
        a, b = self.edges.T
        across = x[a] * y[b] - x[b] * y[a]
        return 0.5 * float(across @ ((self.sides[:, 0] >= 0) * 1.0 - (self.sides[:, 1] >= 0)))


@dataclass(frozen=True)
class Faces:
    """Which face each half-edge has on its left (2 e,), and each point without edges is in (p,), or -1; count: of them.

    Half-edges: the edges from their first end to their second, then all of them back. The last face is the unbounded
    one.
    """

    of_half_edge: np.ndarray
    of_point: np.ndarray
    count: int


def half_edges(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tails, heads and the numbers of the half-edges back (2 e,), of edges (e, 2)."""
    n = len(edges)
    back = np.concatenate([np.arange(n) + n, np.arange(n)])
    return edges.T.ravel(), edges[:, ::-1].T.ravel(), back


def graph_faces(points: np.ndarray, edges: np.ndarray) -> Faces:
    """The faces of the graph of edges (e, 2) between points (p, 2). A loop over the faces' walks, to nest them."""
    tails, heads, back = half_edges(edges)
    walk, size = find_faces(points, tails, heads, back)
    walk_of = np.empty(len(tails), dtype=np.int64)
    walk_of[walk] = np.repeat(np.arange(len(size)), size)
    component, lowest = _components(points, edges)
    around = walk_of[_outermost(points, tails, heads, lowest)]
    bounded = np.ones(len(size), dtype=bool)
    bounded[around] = False
    ends = np.cumsum(size)
    face = np.cumsum(bounded) - 1
    count = int(bounded.sum())
    home = np.full(len(lowest), -1)  # of each component, the bounded walk that it lies in
    deepest = np.full(len(lowest), -1)
    tips = points[lowest]
    inside = [np.zeros((0, 2), dtype=np.int64)]
    corner = points[tails[walk]]
    low, high = (np.stack([side.reduceat(p, ends - size) for p in corner.T]).T for side in (np.minimum, np.maximum))
    by_x, begin, end = starting_between(tips[:, 0], low[:, 0], high[:, 0])
    for number in np.flatnonzero(bounded):
        near = by_x[begin[number] : end[number]]
        near = near[np.all((tips[near] > low[number]) & (tips[near] < high[number]), axis=1)]
        near = near[near != component[tails[walk[ends[number] - 1]]]]
        if len(near):
            near = near[points_inside(tips[near], corner[ends[number] - size[number] : ends[number]])]
            inside.append(np.column_stack([near, np.full(len(near), number)]))
    inner, outer = np.concatenate(inside).T
    depth = np.bincount(inner, minlength=len(lowest))
    around_it = depth[component[tails[walk[ends[outer] - 1]]]]
    order = np.argsort(around_it, kind="stable")
    home[inner[order]], deepest[inner[order]] = outer[order], around_it[order]
    of_component = np.where(home >= 0, face[home], count)
    of_walk = np.where(bounded, face, count)
    of_walk[around] = of_component[component[tails[walk[ends[around] - 1]]]]
    alone = np.bincount(tails, minlength=len(points)) == 0
    return Faces(of_walk[walk_of], np.where(alone, of_component[component], -1), count + 1)


def _components(points: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The connected component of each point (p,), from 0, and the leftmost (then lowest) point of each (c,)."""
    label = connected(len(points), edges)
    _, component = np.unique(label, return_inverse=True)
    order = np.lexsort((points[:, 1], points[:, 0], component))
    first = np.flatnonzero(np.diff(component[order], prepend=-1))
    return component, order[first]


def connected(count: int, pairs: np.ndarray) -> np.ndarray:
    """(count,) the smallest number that each of `count` things is connected to by pairs (k, 2)."""
    label = np.arange(count)
    while True:
        new = label.copy()
        lower = label[pairs].min(axis=1)
        np.minimum.at(new, label[pairs].ravel(), np.repeat(lower, 2))
        np.minimum.at(new, pairs.ravel(), np.repeat(lower, 2))
        new = new[new]
        if np.array_equal(new, label):
            return label
        label = new


def _outermost(points, tails, heads, lowest) -> np.ndarray:
    """Of each component's leftmost (then lowest) point, the half-edge that has the outside on its left.

    It is the steepest one there, as all go to the right. Components without edges have none.
    """
    starts = np.flatnonzero(np.isin(tails, lowest))
    starts = starts[np.argsort(tails[starts], kind="stable")]
    count = np.bincount(tails[starts], minlength=len(points))[tails[starts]]
    first = np.searchsorted(tails[starts], tails[starts])
    one = np.repeat(np.arange(len(starts)), count)
    other = first[one] + np.arange(len(one)) - np.repeat(np.cumsum(count) - count, count)
    at, here, there = points[tails[starts[one]]], points[heads[starts[one]]], points[heads[starts[other]]]
    steeper = orientation(at, here, there) > 0
    return starts[np.bincount(one, steeper, minlength=len(starts)) == 0]
