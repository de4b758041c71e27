"""A case meshed by Tessera, and by Gmsh's two algorithms with the boundary vertices and the size of the first."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import gmsh
import numpy as np

import tessera
from training import reference

from .cases import Case, target_of

OURS, DELAUNAY, FRONTAL = "Tessera", "Gmsh Delaunay", "Gmsh Frontal-Delaunay"
ALGORITHMS = {DELAUNAY: 5, FRONTAL: 6}
MESHERS = OURS, *ALGORITHMS


@dataclass(frozen=True)
class Meshed:
    """vertices (n, 2), triangles (m, 3), and the seconds that it took."""

    vertices: np.ndarray
    triangles: np.ndarray
    seconds: float


def mesh_all(case: Case) -> dict[str, Meshed]:
    """One case by all meshers. Raises RuntimeError where Gmsh does not keep the boundary."""
    start = time.perf_counter()
    mesh = tessera.mesh(case.loops, case.edge_length, **case.options)
    found = {OURS: Meshed(mesh.vertices, mesh.triangles, time.perf_counter() - start)}
    target, loops = target_of(case), boundary_loops(found[OURS])
    for name, algorithm in ALGORITHMS.items():
        start = time.perf_counter()
        theirs = by_gmsh(loops, target, algorithm)
        found[name] = Meshed(*theirs, time.perf_counter() - start)
        if not same_boundary(found[OURS], found[name]):
            raise RuntimeError(f"{name} changed the boundary of {case.name}")
    return found


def by_gmsh(
    loops: list[np.ndarray], target: float | Callable[[np.ndarray], np.ndarray], algorithm: int
) -> tuple[np.ndarray, np.ndarray]:
    """Gmsh's mesh of a domain of one piece, its boundary edges kept whole.

    loops: (k, 2) arrays, the outer one first; target: an edge length, or points (n, 2) -> (n,). Returns vertices
    (n, 2), the loops' first and in their order, and triangles (m, 3).
    """
    reference.start()
    gmsh.model.add("domain")
    gmsh.option.setNumber("Mesh.Algorithm", algorithm)
    constant = not callable(target)
    gmsh.option.setNumber("Mesh.MeshSizeMin", target if constant else 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", target if constant else 1e22)
    geo, curves = gmsh.model.geo, []
    for loop in loops:
        corners = [geo.addPoint(x, y, 0) for x, y in loop]
        lines = [geo.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        for line in lines:
            geo.mesh.setTransfiniteCurve(line, 2)
        curves.append(geo.addCurveLoop(lines))
    geo.addPlaneSurface(curves)
    geo.synchronize()
    if not constant:
        gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, size: float(target(np.array([[x, y]]))[0]))
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    if not constant:
        gmsh.model.mesh.removeSizeCallback()
    gmsh.model.remove()
    gmsh.option.setNumber("Mesh.Algorithm", reference.OPTIONS["Mesh.Algorithm"])
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    return coordinates.reshape(-1, 3)[:, :2].copy(), place[nodes.astype(np.int64)].reshape(-1, 3)


def boundary_loops(mesh: Meshed) -> list[np.ndarray]:
    """Closed polygons (k, 2) along the edges of one triangle only, the outer one first.

    Raises ValueError where there is more than one outer one.
    """
    following = dict(boundary_edges(mesh.triangles).tolist())
    loops = []
    while following:
        loop = [next(iter(following))]
        while (after := following.pop(loop[-1])) != loop[0]:
            loop.append(after)
        loops.append(mesh.vertices[loop])
    loops.sort(key=lambda loop: loop[:, 0] @ (np.roll(loop[:, 1], 1) - np.roll(loop[:, 1], -1)))
    areas = [loop[:, 0] @ (np.roll(loop[:, 1], -1) - np.roll(loop[:, 1], 1)) for loop in loops]
    if sum(area > 0 for area in areas) != 1:
        raise ValueError("the mesh has several pieces")
    return loops


def same_boundary(one: Meshed, other: Meshed) -> bool:
    """Whether two meshes' boundary edges have the same ends, bit for bit."""
    ends = [mesh.vertices[boundary_edges(mesh.triangles)].reshape(-1, 4) for mesh in (one, other)]
    first, second = (part[np.lexsort(part.T)] for part in ends)
    return np.array_equal(first, second)


def boundary_edges(triangles: np.ndarray) -> np.ndarray:
    """(b, 2) directed edges that run along one triangle only."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    size = int(triangles.max()) + 1
    key, back = edges @ [size, 1], edges @ [1, size]
    return edges[~np.isin(key, back)]
