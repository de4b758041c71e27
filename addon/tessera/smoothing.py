"""Smoothing after the networks, an option: inner vertices go downhill in the sum of q^-8 of the elements around them.

The sum weighs poor elements most, so that the worst ones mostly get better, which the mean of the neighbours does not
see to. A vertex tries a few steps along the slope and takes the best; vertices that move together are never neighbours,
so no move can spoil another and elements stay valid.
"""

from __future__ import annotations

import numpy as np

from .cavity import next_vertices
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
    ring, centre = vertices[stars.ring], vertices[stars.centre]
    real = np.arange(ring.shape[1]) < stars.n_ring[:, None]
    size = total_in_turn(np.where(real, np.hypot(*np.moveaxis(ring - centre[:, None], 2, 0)), 0)) / stars.n_ring
    # Around the centre and beside the size, so that no coordinate is too large or too small.
    start = (ring - centre[:, None]) / size[:, None, None]
    end = next_vertices(start, stars.n_ring)
    slope = _slope(start, end, real)
    steepness = np.hypot(*slope.T)
    direction = -slope * (size / np.where(steepness > 0, steepness, 1))[:, None]
    places = np.concatenate([centre[:, None], centre[:, None] + _STEPS[:, None] * direction[:, None]], axis=1)
    moved = (places - centre[:, None]) / size[:, None, None]
    quality = np.where(
        real[:, None], quality_of_sides(start[:, None] - moved[:, :, None], end[:, None] - moved[:, :, None]), 1
    )
    worst = quality.min(axis=2)
    allowed = worst >= np.clip(worst[:, :1], _FLAT, _POOR)
    allowed[:, 0] = True
    energy = np.where(allowed, total_in_turn(_energy(quality) * real[:, None]), np.inf)
    best = energy.argmin(axis=1)
    return places[np.arange(len(places)), best]


def _energy(quality: np.ndarray) -> np.ndarray:
    """q^-8, continued as a straight line below `_POOR`."""
    return np.maximum(quality, _POOR) ** -8.0 + 8 * _POOR**-9.0 * np.maximum(_POOR - quality, 0)


def _slope(u: np.ndarray, v: np.ndarray, real: np.ndarray) -> np.ndarray:
    """(S, 2) the derivative of each star's energy by its centre. u, v: (S, R, 2) from there to the ends of elements."""
    squares = ((u * u).sum(-1) + (v * v).sum(-1) + ((u - v) ** 2).sum(-1))[..., None]
    squares = np.maximum(squares, 1e-300)
    double = (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])[..., None]
    by_area = np.stack([u[..., 1] - v[..., 1], v[..., 0] - u[..., 0]], axis=-1)
    by_squares = -2 * (u + v)
    quality = 2 * np.sqrt(3) * double / squares
    change = 2 * np.sqrt(3) * (by_area * squares - double * by_squares) / squares**2
    return total_in_turn(np.swapaxes(-8 * np.maximum(quality, _POOR) ** -9.0 * change * real[..., None], 1, 2))
