"""What is measured of a mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import tessera

from .meshers import Meshed

SHORTEST, LONGEST = 0.7, 1.4  # times the sizing function, between which an inner edge is as long as it should be


@dataclass(frozen=True)
class Measures:
    """Of one mesh; q_left_out: the worst quality of the elements that do not count for q_worst, 1 if there are none.

    edges: number of inner edges; good: how many of them are SHORTEST to LONGEST times the sizing function at their
    middle; short: how many are shorter.
    """

    vertices: int
    triangles: int
    q_worst: float
    q_mean: float
    q_left_out: float
    edges: int
    good: int
    short: int
    seconds: float

    @property
    def share(self) -> float:
        """Share of inner edges as long as they should be, in per cent."""
        return 100 * self.good / max(self.edges, 1)


def measure(
    mesh: Meshed, target: float | Callable[[np.ndarray], np.ndarray], left_out: np.ndarray | None = None
) -> Measures:
    """target: an edge length, or points (n, 2) -> (n,); left_out: the vertex (2,) whose elements do not count."""
    quality = tessera.element_quality(mesh.vertices, mesh.triangles)
    out = np.zeros(len(quality), dtype=bool)
    if left_out is not None:
        out = np.all(mesh.vertices[mesh.triangles] == left_out, axis=2).any(axis=1)
    one, other = np.moveaxis(mesh.vertices[inner_edges(mesh.triangles)], 1, 0)
    middle = 0.5 * (one + other)
    wanted = target(middle) if callable(target) else np.full(len(middle), target)
    ratio = np.linalg.norm(one - other, axis=1) / wanted
    return Measures(
        vertices=len(mesh.vertices),
        triangles=len(mesh.triangles),
        q_worst=float(quality[~out].min()),
        q_mean=float(quality.mean()),
        q_left_out=float(quality[out].min(initial=1.0)),
        edges=len(ratio),
        good=int(np.count_nonzero((ratio >= SHORTEST) & (ratio <= LONGEST))),
        short=int(np.count_nonzero(ratio < SHORTEST)),
        seconds=mesh.seconds,
    )


def inner_edges(triangles: np.ndarray) -> np.ndarray:
    """(e, 2) the edges between two triangles, each once."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    return edges[count == 2]
