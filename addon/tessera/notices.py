"""What a mesh's report warns of."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .sizing import LONG

LOST_AREA = 0.1  # of a curve's area, from which a coarser boundary is warned of


def long_edge_warnings(
    start: np.ndarray, end: np.ndarray, target: Callable[[np.ndarray], np.ndarray]
) -> tuple[str, ...]:
    """A warning where kept edges, from start to end (e, 2), are longer than the target at places (n, 2), or none."""
    lengths = np.linalg.norm(end - start, axis=1)
    wanted = target(0.5 * (start + end))
    long = np.count_nonzero(lengths > LONG * wanted)
    if not long:
        return ()
    shortest = wanted[lengths > LONG * wanted].min()
    return (
        f"{long} of the {len(lengths)} kept boundary edges are longer than the target edge length {shortest:g} "
        f"(the longest is {lengths.max():g}), and so are the elements beside them: resample the boundary, or divide it",
    )


def lost_area_warnings(area: float, vertices: np.ndarray, triangles: np.ndarray, edge_length: float) -> tuple[str, ...]:
    """A warning where the resampled boundary is too coarse for a domain of that area, or none."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    u, v = b - a, c - a
    covered = 0.5 * float(np.sum(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    changed = abs(covered / area - 1)
    if changed < LOST_AREA:
        return ()
    return (
        f"the target edge length {edge_length:g} is too long for the curve's shape: the mesh's area differs by "
        f"{100 * changed:.0f} %. Use a shorter one",
    )
