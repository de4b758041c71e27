"""A mesh of a wanted number of triangles: an edge length from area and length, corrected by what comes out of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from .budget import enclosed_area, total_length
from .constraints import planar_domains
from .contour import clean_domains, nesting
from .errors import ContourError
from .mesh import Mesh
from .steps import Steps, within

TOLERANCE = 0.1  # of the wanted number
MOST_TRIES = 6
# A mesh of the target edge length l has about SHARE · (4/√3 · area / l² + BESIDE · length / l) triangles: fitted to
# meshes of 30 to 1500 triangles of squares, circles, stars, rings, strips and plates with holes.
_SHARE, _BESIDE = 1.05, 0.25


def expected_edge_length(loops: Sequence[ArrayLike], n_triangles: int) -> float:
    """The target edge length, in the loops' unit, that gives about so many triangles of one size.

    loops: (k, 2) each, as for `mesh`. Raises ContourError for loops that cannot be meshed.
    """
    (cleaned,), planar = planar_domains([loops], clean_domains([loops]))
    if isinstance(cleaned, ContourError):
        raise cleaned
    if not cleaned:
        raise ContourError("too-few-points", "The domain has no contour. Give at least one closed loop of points.")
    if planar:
        area, length = planar[0].graph.area(), planar[0].graph.length()
    else:
        area, length = enclosed_area(cleaned, nesting(cleaned)), total_length(cleaned)
    area, beside, wanted = 4 / 3**0.5 * area, _BESIDE * length, n_triangles / _SHARE
    return (beside + (beside**2 + 4 * wanted * area) ** 0.5) / (2 * wanted)


def mesh_to_count(loops: Sequence[ArrayLike], n_triangles: int, mesh_at: Callable[[float], Steps[Mesh]]) -> Steps[Mesh]:
    """Mesh until the number of triangles is within 10 % of the wanted one: gives the closest of at most six meshes.

    mesh_at: takes a target edge length and meshes the loops in steps. Where corners, a kept boundary or limits of the
    sizing leave no such mesh, the closest has a warning. Raises ContourError.
    """
    length = expected_edge_length(loops, n_triangles)
    tried: list[tuple[float, float]] = []  # logarithms of the length, and of the count over the wanted one
    best, error = None, np.inf
    for number in range(MOST_TRIES):
        # Nobody knows how many tries will follow: each has half of what is left.
        mesh = yield from within(mesh_at(length), 1 - 0.5**number, 1 - 0.5 ** (number + 1))
        ratio = mesh.report.n_triangles / n_triangles
        if abs(ratio - 1) < error:
            best, error = mesh, abs(ratio - 1)
        if error <= TOLERANCE:
            return best
        tried.append((np.log(length), np.log(ratio)))
        if _stuck(tried):
            break
        length = float(np.exp(_next(tried)))
    warning = (
        f"{n_triangles} triangles are wanted, and {best.report.n_triangles} is as close as meshing came: the outline's "
        "corners, a kept boundary or the sizing's limits leave no other number"
    )
    return replace(best, report=replace(best.report, warnings=(*best.report.warnings, warning)))


def _stuck(tried: list[tuple[float, float]]) -> bool:
    """Whether another length made no difference at all."""
    return len(tried) > 1 and tried[-1][1] == tried[-2][1]


def _next(tried: list[tuple[float, float]]) -> float:
    """The logarithm of the length to try next: between a longer and a shorter one, if both are known."""
    fewer = max((pair for pair in tried if pair[1] < 0), key=lambda pair: pair[1], default=None)
    more = min((pair for pair in tried if pair[1] > 0), key=lambda pair: pair[1], default=None)
    if fewer is None or more is None or fewer[0] <= more[0]:
        # The number goes with the inverse square of the length; where a limit holds it, farther each time.
        length, ratio = tried[-1]
        return length + ratio / 2 * len(tried)
    share = np.clip(more[1] / (more[1] - fewer[1]), 0.1, 0.9)
    return more[0] + share * (fewer[0] - more[0])
