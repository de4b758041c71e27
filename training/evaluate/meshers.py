"""The meshers that are compared, each from contours (and inner vertices) to meshes."""

from __future__ import annotations

import gmsh
import numpy as np

from tessera import scheme
from tessera.placement import MOST_INNER, place_inner_vertices
from tessera.stopwatch import Stopwatch
from tessera.triangulation import Connect, triangulate

from .. import meshing, reference, tables, teacher
from .meshes import Meshes, gather, measure
from .sets import Contours

DELAUNAY, FRONTAL = 5, 6  # Gmsh's Mesh.Algorithm


def of_scheme(contours: Contours, meshes: scheme.ContourMeshes) -> Meshes:
    """The scheme's meshes in the form of all others."""
    points = scheme.join_vertices(contours.points, contours.n_contour, meshes.inner, meshes.n_inner)
    return Meshes(
        points, contours.n_contour, meshes.n_inner, meshes.triangles.astype(np.int64), meshes.owner.astype(np.int64)
    )


def by_gmsh(contours: Contours, algorithm: int = DELAUNAY) -> Meshes:
    """Gmsh's meshes, none where it changed the contour."""
    reference.start()
    gmsh.option.setNumber("Mesh.Algorithm", algorithm)
    found = []
    for row, (n, l_s) in enumerate(zip(contours.n_contour, contours.l_s, strict=True)):
        own = contours.points[row, :n]
        vertices, triangles = reference.mesh(own, l_s)
        kept = reference.keeps(own, vertices)
        found.append((np.concatenate([own, vertices[n:]]), triangles) if kept else None)
    return gather(contours, found)


def by_teacher(contours: Contours) -> Meshes:
    """The teacher's meshes, none where the reference has none to improve."""
    reference.start()
    found = []
    for row, (n, l_s) in enumerate(zip(contours.n_contour, contours.l_s, strict=True)):
        lesson = teacher.teach(contours.points[row, :n], l_s)
        found.append(None if lesson is None else (lesson.taught.vertices, lesson.taught.triangles))
    return gather(contours, found)


def by_delaunay(contours: Contours, points: np.ndarray, n_inner: np.ndarray) -> Meshes:
    """Constrained Delaunay triangulations of given vertices (B, V, 2); none where it fails."""
    found = []
    for row, (n, m) in enumerate(zip(contours.n_contour, n_inner, strict=True)):
        vertices = np.ascontiguousarray(points[row, : n + m])
        opposite = np.empty((n + m, n + m), dtype=np.int64)
        done = meshing.delaunay(vertices, n, n + m, opposite)
        found.append((vertices, meshing.triangles(opposite, n + m)) if done else None)
    return gather(contours, found)


def by_placement(contours: Contours, n_inner: np.ndarray) -> Meshes:
    """NN2 alone: so many inner vertices (B,) placed by it, connected by the constrained Delaunay triangulation."""
    wanted = np.minimum(n_inner, MOST_INNER)
    inner, count = place_inner_vertices(contours.points, contours.n_contour, wanted, Stopwatch())
    points = scheme.join_vertices(contours.points, contours.n_contour, inner, count)
    return by_delaunay(contours, points, count)


def by_connection(contours: Contours, points: np.ndarray, n_inner: np.ndarray) -> Meshes:
    """NN3 alone: given vertices (B, V, 2), connected by the triangulation that NN3's tables lead."""
    return _by_tables(contours, points, n_inner, lambda *rest: scheme.connect(*rest, Stopwatch()))


def by_calculation(contours: Contours, points: np.ndarray, n_inner: np.ndarray) -> Meshes:
    """The triangulation alone: given vertices (B, V, 2), led by calculated tables."""

    def calculated(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, entries: np.ndarray) -> np.ndarray:
        return tables.connection_tables(points, n_contour, n_inner)[tuple(entries.T)]

    return _by_tables(contours, points, n_inner, calculated)


def _by_tables(contours: Contours, points: np.ndarray, n_inner: np.ndarray, connect: Connect) -> Meshes:
    result = triangulate(points, contours.n_contour, n_inner, connect)
    return Meshes(points, contours.n_contour, n_inner, result.triangles.astype(np.int64), result.owner.astype(np.int64))


def qualities(points: np.ndarray, meshes: scheme.ContourMeshes, n_contour: np.ndarray) -> np.ndarray:
    """(n, 2) worst and mean element quality of each contour's mesh."""
    contours = Contours(points, n_contour, np.ones(len(points)))
    return measure(of_scheme(contours, meshes), contours.l_s)[:, :2]


def reference_meshes(points: np.ndarray, n_contour: np.ndarray, l_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gmsh's (q_worst, q_mean) (n, 2) and inner vertices (n,) of each contour."""
    meshes = by_gmsh(Contours(points, n_contour, l_s))
    return measure(meshes, l_s)[:, :2], meshes.n_inner
