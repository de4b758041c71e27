"""Refinement of a coarse mesh by the scheme itself (paper, Algorithms 5 and 6).

Every edge off the boundary that is longer than the sizing function wants is split into at most five segments, each as
long as it is wanted there; every element with a split edge becomes a sub-contour, meshed by the scheme at its own mean
edge length; NN2 recomputes the places of the inner vertices; until no edge is split. (The listing's condition to split,
``|l_e - l_s| < eps``, is a misprint.)
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .assembly import mean_edge_lengths, mesh_cells
from .edges import among, inner_edges, sides
from .quality import element_quality
from .relaxation import relax
from .stopwatch import Stopwatch

MOST_SEGMENTS = 5
# An element flatter than this keeps its edges: its sub-contour could cross itself by the rounding of inserted vertices.
_SLIVER = 1e-6
# Where along an edge the sizing function is asked.
_STATIONS = np.arange(0.1, 1.0, 0.2)
# Edges no longer than this, times the length that is wanted in the middle, are one segment: it does not change so fast.
_SURELY_ONE = 1.1
_MOST_ROUNDS = 20  # five to the power of it is more than any ratio of lengths

Sizing = Callable[[np.ndarray, np.ndarray], np.ndarray]


def refine(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    sizing: Sizing,
    watch: Stopwatch,
    fixed: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Refine a mesh until its inner edges follow the sizing function.

    vertices: (n, 2); triangles: (m, 3); domain: (m,) int of each triangle; sizing: (k, 2) points and the domains (k,)
    that they are in -> (k,) wanted edge lengths; fixed: (f, 2) edges that stay, as the boundary does. Returns vertices,
    the old ones first, triangles (t, 3), the old triangle that each is part of (t,), and for each of those the
    fallbacks (m,).
    """
    parent = np.arange(len(triangles))
    fallbacks = np.zeros(len(triangles), dtype=np.int64)
    for _ in range(_MOST_ROUNDS):
        edges, inner = inner_edges(triangles)
        ends = vertices[edges]
        home = np.zeros(len(vertices), dtype=np.int64)
        home[triangles] = domain[parent][:, None]
        may_split = inner & ~_beside_slivers(vertices, triangles, edges) & ~among(edges, fixed)
        with watch("sizing"):
            segments, wanted = _segments(ends, may_split, home[edges[:, 0]], sizing)
        if segments.max(initial=1) == 1:
            break
        points, cells = _sub_contours(vertices, triangles, edges, segments, wanted)
        split = (cells[:, 3:] >= 0).any(axis=1)
        vertices, new, owner, fell = mesh_cells(points, cells[split], mean_edge_lengths(points, cells[split]), watch)
        np.add.at(fallbacks, parent[split], fell)
        parent = np.concatenate([parent[~split], parent[split][owner]])
        triangles = np.concatenate([triangles[~split], new])
        # Only domains that were split, so that each goes the same way as it would alone.
        of = domain[parent]
        changed = np.isin(of, of[-len(new) :])
        with watch("relaxation"):
            vertices = relax(vertices, triangles[changed], of[changed], passes=1, fixed=fixed)
    return vertices, triangles, parent, fallbacks


def _segments(
    ends: np.ndarray, may_split: np.ndarray, domain: np.ndarray, sizing: Sizing
) -> tuple[np.ndarray, np.ndarray]:
    """How many segments edges (e, 2, 2) come to (e,), and the lengths wanted at their stations (e, 5) if it is several.

    may_split: (e,) bool; domain: (e,).
    """
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    segments, wanted = np.ones(len(ends), dtype=np.int64), np.ones((len(ends), len(_STATIONS)))
    rows = np.flatnonzero(may_split)
    rows = rows[length[rows] > _SURELY_ONE * sizing(ends[rows].mean(axis=1), domain[rows])]
    along = ends[rows, :1] + _STATIONS[:, None] * (ends[rows, 1:] - ends[rows, :1])
    wanted[rows] = sizing(along.reshape(-1, 2), np.repeat(domain[rows], len(_STATIONS))).reshape(-1, len(_STATIONS))
    segments[rows] = np.clip(np.rint(length[rows] * (1 / wanted[rows]).mean(axis=1)), 1, MOST_SEGMENTS)
    return segments, wanted


def _beside_slivers(vertices: np.ndarray, triangles: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(e,) which edges belong to an element that is too flat to be split."""
    a, b = sides(triangles[element_quality(vertices, triangles) < _SLIVER]).T
    stride = int(edges.max()) + 1
    return np.isin(edges[:, 0] * stride + edges[:, 1], a * stride + b)


def _sub_contours(
    vertices: np.ndarray, triangles: np.ndarray, edges: np.ndarray, segments: np.ndarray, wanted: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Insert vertices on the edges: all points (p, 2), and each triangle's contour (m, 15), padded with -1.

    segments: (e,) how many each edge comes to; wanted: (e, 5) lengths at `_STATIONS`.
    """
    n = len(vertices)
    edge = np.repeat(np.arange(len(edges)), segments - 1)
    first = np.cumsum(segments - 1) - (segments - 1)
    step = np.arange(len(edge)) - first[edge] + 1
    start, end = vertices[edges[edge, 0]], vertices[edges[edge, 1]]
    passed = np.concatenate([np.zeros((len(edges), 1)), np.cumsum(1 / wanted, axis=1)], axis=1)
    reached = passed[edge, -1] * (step / segments[edge])
    part = np.minimum(np.sum(passed[edge] <= reached[:, None], axis=1) - 1, len(_STATIONS) - 1)
    share = (part + (reached - passed[edge, part]) * wanted[edge, part]) / len(_STATIONS)
    inserted = start + share[:, None] * (end - start)
    stride = int(triangles.max()) + 1
    key = edges[:, 0] * stride + edges[:, 1]
    cells = np.full((len(triangles), 3, MOST_SEGMENTS), -1, dtype=np.int64)
    cells[:, :, 0] = triangles
    for side in range(3):
        a, b = triangles[:, side], triangles[:, (side + 1) % 3]
        of = np.searchsorted(key, np.minimum(a, b) * stride + np.maximum(a, b))
        for k in range(1, MOST_SEGMENTS):
            here = np.where(a < b, k - 1, segments[of] - 1 - k)
            cells[:, side, k] = np.where(k < segments[of], n + first[of] + here, -1)
    cells = cells.reshape(len(triangles), -1)
    order = np.argsort(cells < 0, axis=1, kind="stable")
    return np.concatenate([vertices, inserted]), np.take_along_axis(cells, order, axis=1)
