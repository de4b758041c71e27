"""Whether a domain can be meshed at its target edge length: with no more triangles than there may be, and exactly."""

from __future__ import annotations

import numpy as np

from .constraints import PlanarDomain
from .contour import Nesting, lost_in_rounding, signed_area
from .errors import ContourError

MOST_TRIANGLES = 5_000_000


def checked_domain(
    loops: list[np.ndarray] | ContourError, nested: Nesting, edge_length: float
) -> list[np.ndarray] | ContourError:
    """Clean loops, or the error of a domain that has none, or would have too many triangles or too small ones."""
    if isinstance(loops, ContourError):
        return loops
    if not loops:
        return ContourError("too-few-points", "The domain has no contour. Give at least one closed loop of points.")
    error = _too_many(enclosed_area(loops, nested), total_length(loops), edge_length)
    return error or lost_in_rounding(loops, edge_length) or loops


def checked_graph(domain: PlanarDomain, edge_length: float) -> list[np.ndarray] | ContourError:
    """The domain's clean loops, or the error of one that would have too many triangles or too small ones."""
    error = _too_many(domain.graph.area(), domain.graph.length(), edge_length)
    return error or lost_in_rounding(domain.loops, edge_length) or domain.loops


def _too_many(area: float, length: float, edge_length: float) -> ContourError | None:
    """The error of a domain of an area, with so much of boundary, that would have too many triangles."""
    # Equilateral triangles, and one on each edge of the boundary: area / l² + length / l, both divided before they are
    # multiplied, so that no length is too small or too large for it.
    area *= 4 / 3**0.5
    wanted = area / edge_length / edge_length + length / edge_length
    if wanted > MOST_TRIANGLES:
        smallest = (length + (length**2 + 4 * MOST_TRIANGLES * area) ** 0.5) / (2 * MOST_TRIANGLES)
        message = (
            f"The target edge length {edge_length:g} asks for about {wanted:.2g} triangles, "
            f"the most is {MOST_TRIANGLES:,}. Use {1.1 * smallest:.2g} or more."
        )
        return ContourError("too-many-triangles", message)
    return None


def enclosed_area(loops: list[np.ndarray], nested: Nesting) -> float:
    """The area of a domain, without that of its holes; loops: counter-clockwise."""
    areas = np.array([signed_area(loop) for loop in loops])
    return float(areas[nested.outer].sum() - areas[nested.holes].sum())


def total_length(loops: list[np.ndarray]) -> float:
    """The length of all edges of loops (k, 2)."""
    return sum(float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum()) for loop in loops)
