"""The reference mesher: Gmsh with the contour's edges frozen. Version and options go into every manifest."""

from __future__ import annotations

import gmsh
import numpy as np

from tessera.stopwatch import Stopwatch

OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.Algorithm": 5,  # Delaunay
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.RandomSeed": 1,
}
VERSION = gmsh.__version__


def start() -> None:
    """Open Gmsh once in this process."""
    if not gmsh.isInitialized():
        gmsh.initialize(interruptible=False)
    for name, value in OPTIONS.items():
        gmsh.option.setNumber(name, value)


def keeps(points: np.ndarray, vertices: np.ndarray) -> bool:
    """Whether a mesh's first vertices are still the contour (N_C, 2)."""
    return len(vertices) >= len(points) and np.allclose(vertices[: len(points)], points, atol=1e-9)


def mesh(points: np.ndarray, edge_length: float, watch: Stopwatch | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Mesh a contour at a target edge length, its edges kept whole.

    points: (N_C, 2) float64; watch: times the stage "generate", Gmsh's own meshing without the calls that hand the
    contour over and read the mesh. Returns vertices (n, 2) float64, the contour's first and in their order, and
    triangles (m, 3) int64. The size is set once, by MeshSizeMin = MeshSizeMax.
    """
    watch = watch or Stopwatch()
    gmsh.model.add("contour")
    gmsh.option.setNumber("Mesh.MeshSizeMin", edge_length)
    gmsh.option.setNumber("Mesh.MeshSizeMax", edge_length)
    geo = gmsh.model.geo
    corners = [geo.addPoint(x, y, 0) for x, y in points]
    lines = [geo.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    geo.addPlaneSurface([geo.addCurveLoop(lines)])
    geo.synchronize()
    with watch("generate"):
        gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, nodes = gmsh.model.mesh.getElementsByType(2)
    gmsh.model.remove()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    return coordinates.reshape(-1, 3)[:, :2].copy(), place[nodes.astype(np.int64)].reshape(-1, 3)
