"""The teacher: the reference's mesh with better places, better edges, and a vertex more or less where that pays.

A mesh is judged by what it lacks in quality and how far it is from the target size (`cost`). Vertices move and edges
flip to lower the sum of q^-4 (`meshing.improve`); every inner vertex is tried to be left out and every element to get a
vertex more; the best of these trials is taken as long as one pays. Two starts, so that the number of inner vertices
depends less on where the reference happened to begin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from . import reference
from .improvement import improve
from .meshing import add, delaunay, legalise, qualities, triangles

# What a perfect mesh lacks nothing of: worst quality, mean quality, and the target size, of each edge and on average.
_WORST, _MEAN, _SIZE = 1.0, 2.0, 0.3
_SWEEPS, _TRIAL_SWEEPS = 40, 10
_MOST_STEPS = 12
_GAIN = 1e-3  # in cost: less is not worth another number of vertices
_STARTS = (1.0, 0.9)  # sizes that the reference is asked for, in target edge lengths


@dataclass(frozen=True)
class Meshed:
    """A mesh of one contour: vertices (n, 2) float64, the contour's first, and triangles (m, 3) int64."""

    vertices: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class Lesson:
    """The reference's mesh of a contour, and the teacher's."""

    reference: Meshed
    taught: Meshed


def teach(points: np.ndarray, l_s: float, most: int = 32) -> Lesson | None:
    """The lesson of a contour (N_C, 2) at its target edge length, with at most ``most`` inner vertices.

    None where the reference changes the contour or makes flat elements.
    """
    reference_mesh, another = (_start(points, factor * l_s) for factor in _STARTS)
    if reference_mesh is None:
        return None
    starts = [mesh for mesh in (reference_mesh, another) if mesh is not None]
    found = [_search(mesh.vertices, _matrix(mesh), len(points), l_s, most) for mesh in starts]
    if len(reference_mesh.vertices) <= len(points) + most:
        vertices, opposite = reference_mesh.vertices, _matrix(reference_mesh)
        found.append((vertices, opposite, cost(vertices, opposite, len(points), len(vertices), l_s)))
    vertices, opposite, _ = min(found, key=lambda result: result[2])
    return Lesson(reference_mesh, Meshed(vertices, triangles(opposite, len(vertices))))


def centre(ring: np.ndarray) -> Meshed | None:
    """The best place of one vertex among its neighbours, a ring (N_C, 2); None where their middle is not inside."""
    n = len(ring)
    vertices, opposite = np.concatenate([ring, ring.mean(axis=0, keepdims=True)]), np.empty((n + 1, n + 1), np.int64)
    if not delaunay(vertices, n, n + 1, opposite):
        return None
    improve(vertices, opposite, n, n + 1, _SWEEPS)
    return Meshed(vertices, triangles(opposite, n + 1))


def _start(points: np.ndarray, l_s: float) -> Meshed | None:
    mesh = Meshed(*reference.mesh(points, l_s))
    if (
        not reference.keeps(points, mesh.vertices)
        or qualities(mesh.vertices, _matrix(mesh), len(mesh.vertices))[0] <= 0
    ):
        return None
    return mesh


def _matrix(mesh: Meshed) -> np.ndarray:
    """The matrix ``opposite`` of a mesh (see `meshing`)."""
    n = len(mesh.vertices)
    opposite = np.full((n, n), -1, dtype=np.int64)
    for a, b, c in mesh.triangles:
        add(opposite, a, b, c)
    return opposite


@njit(cache=True)
def cost(points, opposite, n_contour, n, l_s):
    """What a mesh lacks, 0 for equilateral elements of the target size, infinite for a mesh with inverted elements.

    Sizes are compared by logarithms, so that twice and half the target count alike and long contour edges, which no
    mesh can mend, do not outweigh quality.
    """
    worst, mean = qualities(points, opposite, n)
    if worst <= 0:
        return np.inf
    total, apart, count = 0.0, 0.0, 0
    for a in range(n):
        for b in range(n):
            # Edges off the contour have an element on both sides.
            if opposite[a, b] >= 0 and opposite[b, a] >= 0:
                ratio = np.log(np.hypot(points[a, 0] - points[b, 0], points[a, 1] - points[b, 1]) / l_s)
                total += ratio
                apart += abs(ratio)
                count += 1
    return _WORST * (1 - worst) + _MEAN * (1 - mean) + _SIZE * (apart + abs(total)) / max(count, 1)


@njit(cache=True)
def without(points, n_contour, v):
    """The mesh without vertex v: points, ``opposite`` and success."""
    n = len(points) - 1
    rest, opposite = np.empty((n, 2)), np.empty((n, n), np.int64)
    rest[:v], rest[v:] = points[:v], points[v + 1 :]
    made = delaunay(rest, n_contour, n, opposite)
    if made:
        improve(rest, opposite, n_contour, n, _TRIAL_SWEEPS)
    return rest, opposite, made


@njit(cache=True)
def with_another(points, opposite, n_contour, element):
    """The mesh with a vertex in the middle of an element (3,): points and ``opposite``."""
    n = len(points)
    more, wider = np.empty((n + 1, 2)), np.full((n + 1, n + 1), -1, np.int64)
    more[:n], wider[:n, :n] = points, opposite
    a, b, c = element
    more[n] = (points[a] + points[b] + points[c]) / 3
    add(wider, a, b, n)
    add(wider, b, c, n)
    add(wider, c, a, n)
    legalise(more, wider, n + 1, np.zeros((n + 1, n + 1), np.bool_))
    improve(more, wider, n_contour, n + 1, _TRIAL_SWEEPS)
    return more, wider


@njit(cache=True)
def _search(points, opposite, n_contour, l_s, most):
    """Points, ``opposite`` and cost of the best mesh found from one start."""
    points, opposite = points.copy(), opposite.copy()
    improve(points, opposite, n_contour, len(points), _SWEEPS)
    reached = cost(points, opposite, n_contour, len(points), l_s)
    for _ in range(_MOST_STEPS):
        best, best_points, best_opposite = reached - _GAIN, points, opposite
        for v in range(n_contour, len(points)):
            other, matrix, made = without(points, n_contour, v)
            if made:
                value = cost(other, matrix, n_contour, len(other), l_s)
                if value < best:
                    best, best_points, best_opposite = value, other, matrix
        if len(points) < n_contour + most:
            for element in triangles(opposite, len(points)):
                other, matrix = with_another(points, opposite, n_contour, element)
                value = cost(other, matrix, n_contour, len(other), l_s)
                if value < best:
                    best, best_points, best_opposite = value, other, matrix
        if len(best_points) == len(points):
            break
        points, opposite, reached = best_points.copy(), best_opposite.copy(), best
        improve(best_points, best_opposite, n_contour, len(best_points), _SWEEPS)
        value = cost(best_points, best_opposite, n_contour, len(best_points), l_s)
        if value < reached:
            points, opposite, reached = best_points, best_opposite, value
    return points, opposite, reached
