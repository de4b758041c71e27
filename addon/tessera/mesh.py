"""The mesh that a caller gets, and its report."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .edges import unique_edges
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
    """vertices: (n, 2) float64, in the input's coordinates; triangles: (m, 3) int32, counter-clockwise.

    region: (m,) int32, the number of the outer contour around each triangle among the contours that were given, or of
    the region that it is part of.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    region: np.ndarray
    report: Report


def make_mesh(
    vertices: np.ndarray,
    triangles: np.ndarray,
    region: np.ndarray,
    *,
    fallbacks: int = 0,
    warnings: tuple[str, ...] = (),
    seconds: dict[str, float] | None = None,
) -> Mesh:
    """A mesh with its report made from its vertices (n, 2), triangles (m, 3) and their regions (m,)."""
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
    triangles, region = (np.ascontiguousarray(part, dtype=np.int32) for part in (triangles, region))
    return Mesh(vertices, triangles, region, report)
