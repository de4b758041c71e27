"""Smoothing after the networks, an option: inner vertices go downhill in the sum of q^-8 of the elements around them.

The sum weighs poor elements most, so that the worst ones mostly get better, which the mean of the neighbours does not
see to. A vertex tries a few steps along the slope and takes the best; vertices that move together are never neighbours,
so no move can spoil another and elements stay valid.
"""

from __future__ import annotations

import numpy as np

from .edges import off_boundary
from .quality import quality_of_sides
from .stars import Stars, find_independent_stars, total_in_turn
from .steps import Progress, Steps, finish
from .stopwatch import Stopwatch

_LARGEST_STAR = 32
# Steps along the slope that are tried, in mean edge lengths of the star.
_STEPS = np.array([0.2, 0.1, 0.05, 0.025, 0.0125])
_POOR = 0.1  # quality below which the energy goes on linearly
_FLAT = 1e-9  # quality far above its rounding


def checked_steps(steps: int, name: str = "smooth") -> int:
    """A number of steps; raises ValueError unless it is a whole number, 0 or more."""
    if not isinstance(steps, (int, np.integer)) or steps < 0:
        raise ValueError(f"{name} is how often every vertex may move, a whole number of 0 or more, not {steps!r}")
    return int(steps)


def smooth(vertices: np.ndarray, triangles: np.ndarray, steps: int, domain: np.ndarray | None = None) -> np.ndarray:
    """`smooth_in_steps`, at once; without domains all are one."""
    if domain is None:
        domain = np.zeros(len(triangles), dtype=np.int64)
    return finish(smooth_in_steps(vertices, triangles, steps, domain, Stopwatch()))


def smooth_in_steps(
    vertices: np.ndarray,
    triangles: np.ndarray,
    steps: int,
    domain: np.ndarray,
    watch: Stopwatch,
    fixed: np.ndarray | None = None,
) -> Steps[np.ndarray]:
    """Better places for the vertices of meshes that are off the boundary, (n, 2); the others stay.

    vertices: (n, 2) float64; triangles: (m, 3) int, counter-clockwise; steps: how often every vertex may move, but for
    those with more than 32 neighbours; domain: (m,) int, of a batch: what is done to one domain's mesh does not depend
    on the others; fixed: (f, 2) edges whose vertices stay too. Raises ValueError as `checked_steps`.
    """
    steps, vertices = checked_steps(steps), np.array(vertices, dtype=np.float64)
    if not (steps and len(triangles)):
        return vertices
    with watch("smoothing"):
        free = off_boundary(triangles, len(vertices), fixed)
        sets = find_independent_stars(triangles, domain, free, _LARGEST_STAR)
    for step in range(steps):
        with watch("smoothing"):
            for independent in sets:
                vertices[independent.centre] = _downhill(vertices, independent)
        yield Progress("smoothing", (step + 1) / steps)
    return vertices


def _downhill(vertices: np.ndarray, stars: Stars) -> np.ndarray:
    """The best places (S, 2) that the stars' centres find along the slope, or the ones that they have.

    Where a star's worst element is poor, it gets no poorer, and none gets so flat that its sign is not sure.
    """
    # Coordinates first, then elements around each star, then stars: those are many.
    centre, n = vertices[stars.centre].T, stars.n_ring
    ring = np.stack([vertices[:, axis][stars.ring] for axis in (0, 1)])
    real = np.arange(ring.shape[1])[:, None] < n
    size = total_in_turn(np.where(real, np.hypot(*(ring - centre[:, None])), 0)) / n
    # Around the centre and beside the size, so that no coordinate is too large or too small.
    start = (ring - centre[:, None]) / size
    end = np.where(np.arange(1, ring.shape[1] + 1)[:, None] < n, np.roll(start, -1, axis=1), start[:, :1])
    slope = _slope(start, end, real)
    steepness = np.hypot(*slope)
    direction = -slope * (size / np.where(steepness > 0, steepness, 1))
    places = centre[:, None] + np.append(0, _STEPS)[:, None] * direction[:, None]
    moved = ((places - centre[:, None]) / size)[:, :, None]
    quality = np.where(real, quality_of_sides(start[:, None] - moved, end[:, None] - moved), 1)
    worst = quality.min(axis=1)
    allowed = worst >= np.clip(worst[:1], _FLAT, _POOR)
    allowed[0] = True
    energy = np.where(allowed, total_in_turn(np.moveaxis(_energy(quality) * real, 1, 0)), np.inf)
    best = energy.argmin(axis=0)
    return places[:, best, np.arange(len(n))].T


def _energy(quality: np.ndarray) -> np.ndarray:
    """q^-8, continued as a straight line below `_POOR`."""
    return np.maximum(quality, _POOR) ** -8.0 + 8 * _POOR**-9.0 * np.maximum(_POOR - quality, 0)


def _slope(u: np.ndarray, v: np.ndarray, real: np.ndarray) -> np.ndarray:
    """(2, S) the derivative of each star's energy by its centre. u, v: (2, R, S) from there to the ends of elements."""
    (ux, uy), (vx, vy) = u, v
    # u² + v² + (u - v)²
    # At least so much that its square is above 0.
    squares = np.maximum(2 * (ux * ux + uy * uy + vx * vx + vy * vy - ux * vx - uy * vy), 1e-150)
    double = ux * vy - uy * vx
    by_area = np.stack([uy - vy, vx - ux])
    by_squares = -2 * (u + v)
    quality = 2 * np.sqrt(3) * double / squares
    change = 2 * np.sqrt(3) * (by_area * squares - double * by_squares) / squares**2
    return total_in_turn(np.moveaxis(-8 * np.maximum(quality, _POOR) ** -9.0 * change * real, 1, 0))
