"""From the edges of a mesh to its chains of vertices. Arrays in, arrays out: no `bpy` here."""

from collections import defaultdict

import numpy as np


def outline_edges(edges: np.ndarray, face_edges: np.ndarray) -> np.ndarray:
    """The edges that bound something: wire edges, and edges of exactly one face.

    edges: (e, 2) int32 vertex indices; face_edges: the edge index at every face corner. Returns (k, 2) int32.
    """
    faces_at_edge = np.bincount(face_edges, minlength=len(edges))
    return edges[faces_at_edge <= 1]


def polylines(n_vertices: int, edges: np.ndarray) -> list[tuple[np.ndarray, bool]]:
    """Chains of edges as vertex indices, each with whether it is closed, in the order of their lowest vertex.

    edges: (e, 2) int32. A vertex without an edge is an open chain of its own. A closed chain does not repeat its first
    vertex. Where more than two edges meet, the chain takes them in the order given, and a closed one is cut there into
    closed ones that pass no vertex twice.
    """
    neighbours: dict[int, list[int]] = defaultdict(list)
    for a, b in edges.tolist():
        neighbours[a].append(b)
        neighbours[b].append(a)

    seen = np.zeros(n_vertices, dtype=bool)
    chains = []
    for seed in range(n_vertices):
        if seen[seed]:
            continue
        chain, closed = _walk(seed, neighbours)
        if not closed and neighbours[seed]:
            # The seed may lie inside an open chain: go back to its end, and walk from there. `_walk` consumed the
            # edges, so they are those just walked, from the seed onwards, and what lies on its other side.
            before, _ = _walk(seed, neighbours)
            chain = before[:0:-1] + chain
        seen[chain] = True
        chains += [(np.array(part, dtype=np.int32), closed) for part in (_simple(chain) if closed else [chain])]
    return chains


def _simple(chain: list[int]) -> list[list[int]]:
    """A closed chain in parts that pass no vertex twice."""
    parts, path, place = [], [], {}
    for vertex in chain:
        if vertex in place:
            first = place[vertex]
            parts.append(path[first:])
            for gone in path[first:]:
                del place[gone]
            del path[first:]
        place[vertex] = len(path)
        path.append(vertex)
    return [path, *parts]


def _walk(seed: int, neighbours: dict[int, list[int]]) -> tuple[list[int], bool]:
    """Follow edges from `seed` and remove them as they are walked, until there is none or the seed is back."""
    chain = [seed]
    here = seed
    while neighbours[here]:
        ahead = neighbours[here].pop(0)
        neighbours[ahead].remove(here)
        if ahead == seed:
            return chain, True
        chain.append(ahead)
        here = ahead
    return chain, False
