"""The mesh that a caller gets, and its report."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .quality import element_quality


@dataclass(frozen=True)
class Report:
    """What there is to know of a mesh.

    edge_lengths: shortest, mean and longest edge, in the input's unit; seconds: of each stage (of the whole batch,
    where the mesh was made in one); fallbacks: elements that were chosen by their own quality, as NN3's table led
    nowhere.
    """

    n_vertices: int
    n_triangles: int
    q_worst: float
    q_mean: float
    edge_lengths: tuple[float, float, float]
    fallbacks: int = 0
    warnings: tuple[str, ...] = ()
    seconds: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Mesh:
    """vertices: (n, 2) float64, in the input's coordinates; triangles: (m, 3) int32, counter-clockwise."""

    vertices: np.ndarray
    triangles: np.ndarray
    report: Report


def make_mesh(
    vertices: np.ndarray,
    triangles: np.ndarray,
    *,
    fallbacks: int = 0,
    warnings: tuple[str, ...] = (),
    seconds: dict[str, float] | None = None,
) -> Mesh:
    """A mesh with its report made from its vertices (n, 2) and triangles (m, 3)."""
    quality = element_quality(vertices, triangles)
    edges = unique_edges(triangles)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    report = Report(
        n_vertices=len(vertices),
        n_triangles=len(triangles),
        q_worst=float(quality.min()),
        q_mean=float(quality.mean()),
        edge_lengths=(float(lengths.min()), float(lengths.mean()), float(lengths.max())),
        fallbacks=fallbacks,
        warnings=warnings,
        seconds=dict(seconds or {}),
    )
    return Mesh(vertices, np.ascontiguousarray(triangles, dtype=np.int32), report)


def unique_edges(triangles: np.ndarray) -> np.ndarray:
    """Each edge of triangles (m, 3) once, its smaller vertex first: (e, 2)."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1).astype(np.int64)
    key = np.unique(edges[:, 0] * (int(edges.max(initial=0)) + 1) + edges[:, 1])
    return np.stack(np.divmod(key, int(edges.max(initial=0)) + 1), axis=1)
