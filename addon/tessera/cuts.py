"""From a graph to simple polygons: bridges through its faces, as from holes to the contour (`bridges.py`).

What bounds a face is made of blocks: the contours of what is not part of the face, which may touch in a vertex; lines'
edges, with the face on both sides; and points. One of them, the root, is around the face. Where a block's leftmost
vertex is in no block that goes farther left, it gets a bridge to the left, and its rightmost one, to the right. Then
from every block there is a way to the root, from block to block, each by its leftmost vertex, around contours on either
side, and along bridges. All that it cannot avoid is left of the block, or its leftmost vertex; and of the way to the
right, right of it. So no vertex blocks both, and the faces are simple polygons, by the argument of `bridges.py`.
"""

from __future__ import annotations

import numpy as np

from .bridges import add_bridges
from .division import Polygons
from .faces import find_faces
from .graph import Faces, Graph, graph_faces, half_edges
from .proposals import Net, Wanted
from .rows import with_rows
from .spacing import Target

# With more points in a face, looking for each one's bridges would take long.
_MANY = 50


def graph_polygons(graph: Graph, edge_length: np.ndarray, target: Target | None = None) -> tuple[np.ndarray, Polygons]:
    """Points (p, 2), the graph's first, and the polygons of them that tile its regions, which are their owners.

    edge_length: (r,) the longest target of each region; target: as of `division.divide`.
    """
    faces = graph_faces(graph.points, graph.edges)
    region = np.full(faces.count, -1)
    region[faces.of_half_edge] = graph.sides.T.ravel()
    tails, heads, back = half_edges(graph.edges)
    inside = region[faces.of_half_edge] >= 0
    net, vertex, left, right, wanted = _cut_faces(graph, faces, region, inside, edge_length, target)
    n, s = len(vertex), len(net.start)
    alone = net.start[net.start == net.end]
    many = np.bincount(net.group[alone], minlength=len(wanted.region)) > _MANY
    net = with_rows(net, alone[many[net.group[alone]]], wanted)
    net = add_bridges(net, left, right, wanted)
    number = np.concatenate([vertex, len(graph.points) + np.arange(len(net.points) - n)])
    points = np.concatenate([graph.points, net.points[n:]])
    tail, head = number[net.start[s:]], number[net.end[s:]]
    owner = wanted.region[net.group[net.start[s:]]]
    number = np.cumsum(inside) - 1
    twin = np.where(inside[back], number[back], -1)[inside]
    n, s = len(twin), len(tail)
    origin = np.concatenate([tails[inside], tail, head])
    goal = np.concatenate([heads[inside], head, tail])
    walk, size = find_faces(points, origin, goal, np.concatenate([twin, n + s + np.arange(s), n + np.arange(s)]))
    of = np.concatenate([region[faces.of_half_edge[inside]], owner, owner])
    return points, Polygons(origin[walk], size, of[walk[np.cumsum(size) - size]])


def _spacing(graph: Graph, edge_length: np.ndarray, target: Target | None) -> np.ndarray:
    """(p,) mean length of the edges at each point, or the target at one without edges."""
    length = np.linalg.norm(graph.points[graph.edges[:, 1]] - graph.points[graph.edges[:, 0]], axis=1)
    n = len(graph.points)
    count = np.bincount(graph.edges.ravel(), minlength=n)
    spacing = np.bincount(graph.edges.ravel(), np.repeat(length, 2), minlength=n) / np.maximum(count, 1)
    alone = np.flatnonzero(graph.home >= 0)
    home = graph.home[alone]
    spacing[alone] = edge_length[home] if target is None else target(graph.points[alone], home)
    return spacing


def _cut_faces(
    graph: Graph, faces: Faces, region: np.ndarray, inside: np.ndarray, edge_length: np.ndarray, target: Target | None
) -> tuple[Net, np.ndarray, np.ndarray, np.ndarray, Wanted]:
    """What bounds the faces that need bridges, each with points of its own; tips to the left and right; what is wanted.

    Also gives the number in the graph of each of the net's points. A point in a face is an edge to itself.
    """
    n = len(graph.points)
    (left_of, left), (right_of, right) = _tips(graph, faces, inside)
    cut = np.union1d(left_of, right_of)
    face, edge = np.divmod(
        np.unique(faces.of_half_edge * len(graph.edges) + np.tile(np.arange(len(graph.edges)), 2)), len(graph.edges)
    )
    edge, face = edge[np.isin(face, cut)], face[np.isin(face, cut)]
    (alone,) = np.nonzero(np.isin(faces.of_point, cut))
    of = np.concatenate([face, faces.of_point[alone]])
    ends = np.concatenate([graph.edges[edge], np.column_stack([alone, alone])])
    keys, ends = np.unique(of[:, None] * n + ends, return_inverse=True)
    start, end = ends.reshape(-1, 2).T
    face, vertex = np.divmod(keys, n)
    spacing = _spacing(graph, edge_length, target)[vertex]
    net = Net(graph.points[vertex], spacing, np.searchsorted(cut, face), start, end)
    left, right = np.searchsorted(keys, left_of * n + left), np.searchsorted(keys, right_of * n + right)
    return net, vertex, left, right, Wanted(edge_length[region[cut]], region[cut], target)


def _tips(
    graph: Graph, faces: Faces, inside: np.ndarray
) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """The faces (k,) and the vertices (k,) in them from which bridges start to the left, and to the right."""
    face, vertex, block, n_blocks = _blocks(graph, faces, inside)
    rank = np.empty(len(graph.points), dtype=np.int64)
    rank[np.lexsort(graph.points.T[::-1])] = np.arange(len(rank))
    rank = rank[vertex]
    lowest, highest, first, last = np.full((4, n_blocks), 0)
    lowest[:], highest[:] = len(graph.points), -1
    np.minimum.at(lowest, block, rank)
    np.maximum.at(highest, block, rank)
    # The root has both the leftmost and the rightmost vertex of its face.
    first, last = np.full(faces.count, len(graph.points)), np.full(faces.count, -1)
    np.minimum.at(first, face, rank)
    np.maximum.at(last, face, rank)
    root = (lowest[block] == first[face]) & (highest[block] == last[face])
    copy = np.unique(face * len(graph.points) + vertex, return_inverse=True)[1]
    farthest = np.full((2, copy.max(initial=-1) + 1), len(graph.points))
    np.minimum.at(farthest[0], copy, np.where(root, -1, lowest[block]))
    np.minimum.at(farthest[1], copy, np.where(root, -1, len(graph.points) - 1 - highest[block]))
    left = farthest[0, copy] == rank
    right = farthest[1, copy] == len(graph.points) - 1 - rank
    n = len(graph.points)
    return tuple(np.divmod(np.unique(face[side] * n + vertex[side]), n) for side in (left, right))


def _blocks(graph: Graph, faces: Faces, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """What bounds faces: the face (k,), the vertex (k,) and the block (k,) of each corner, and how many blocks."""
    tails, heads, back = half_edges(graph.edges)
    line = inside & (faces.of_half_edge == faces.of_half_edge[back])
    around = np.flatnonzero(inside & ~line)
    line = np.flatnonzero(line[: len(graph.edges)])
    # Each face with vertices of its own, and the half-edges back, with on their left what is not part of it.
    face = faces.of_half_edge[around]
    key, ends = np.unique(
        np.concatenate([face, face]) * len(graph.points) + np.concatenate([heads[around], tails[around]]),
        return_inverse=True,
    )
    start, end = np.split(ends, 2)
    walk, size = find_faces(graph.points[key % len(graph.points)], start, end, np.full(len(around), -1))
    n, m, alone = len(size), len(line), np.flatnonzero(graph.home >= 0)
    block = np.concatenate([np.repeat(np.arange(n), size), np.tile(n + np.arange(m), 2), n + m + np.arange(len(alone))])
    vertex = np.concatenate([key[start[walk]] % len(graph.points), graph.edges[line].T.ravel(), alone])
    of = np.concatenate([face[walk], np.tile(faces.of_half_edge[line], 2), faces.of_point[alone]])
    return of, vertex, block, n + m + len(alone)
