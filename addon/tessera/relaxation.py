"""NN2 recomputes the places of a large mesh's inner vertices (paper, Algorithm 5, line 32), across all seams.

Every vertex off the boundary is the only inner vertex of the contour that its neighbours form: NN2 is asked where it
should be. A move is made where the worst and the mean quality of its elements, added, get better; vertices that move
together are never neighbours, so no move can spoil another and elements stay valid.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from . import networks
from .quality import quality_of_sides
from .stars import Stars, find_independent_stars, total_in_turn
from .steps import Progress, Steps
from .stopwatch import Stopwatch

_PADDED = 0, 8, 16  # sizes that rings are padded to
# In worst and mean quality added: less is not worth a move, and less is no reason to look at the neighbours again.
_GAIN, _SPREADS = 2e-4, 4e-3


def relax(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    free: np.ndarray,
    passes: int,
    watch: Stopwatch,
    disturbed: np.ndarray | None = None,
) -> Steps[np.ndarray]:
    """Better places for the free vertices of a mesh: (n, 2); the others stay.

    vertices: (n, 2); triangles: (m, 3); domain: (m,) int, the domain of each triangle: the vertices of each are
    numbered by themselves, so that a domain is relaxed alike alone and in a batch; free: (n,) bool, none on the
    boundary; disturbed: (n,) bool, vertices near which there is something to relax; all, if not given.
    """
    with watch("relaxation"):
        if disturbed is None:
            disturbed = free
        else:  # a pass goes no farther than to the neighbours
            reached = disturbed
            for _ in range(passes):
                reached = _with_neighbours(reached, triangles)
            free = free & reached
            near = free[triangles].any(axis=1)
            triangles, domain = triangles[near], domain[near]
        sets = find_independent_stars(triangles, domain, free, _PADDED[-1])
    vertices = vertices.copy()
    for step in range(passes):
        with watch("relaxation"):
            disturbed = _pass(vertices, sets, disturbed)
        yield Progress("relaxation", (step + 1) / passes)
    return vertices


def _with_neighbours(chosen: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Some vertices (n,) and those that share an element with one."""
    more = chosen.copy()
    more[triangles[chosen[triangles].any(axis=1)]] = True
    return more


def _pass(vertices: np.ndarray, sets: list[Stars], disturbed: np.ndarray) -> np.ndarray:
    """Move vertices (n, 2), in place, that are or are beside what is disturbed or moves; returns which gained (n,)."""
    moved = np.zeros(len(vertices), dtype=bool)
    for independent in sets:
        around = disturbed[independent.ring] | moved[independent.ring]
        stars = independent.rows(disturbed[independent.centre] | around.any(axis=0))
        for low, high in pairwise(_PADDED):
            rows = np.flatnonzero((stars.n_ring > low) & (stars.n_ring <= high))
            if len(rows):
                centre = stars.centre[rows]
                places, gain = _better_places(vertices, stars.rows(rows), high)
                better = gain > _GAIN
                vertices[centre[better]], moved[centre] = places[better], gain > _SPREADS
    return moved


def _better_places(vertices: np.ndarray, stars: Stars, size: int) -> tuple[np.ndarray, np.ndarray]:
    """New places (S, 2) of the stars' centres, and what each gains, 0 where it may not go; size: to pad rings to."""
    old, n = vertices[stars.centre].T, stars.n_ring
    # The last vertex before the first, and the first in all that is left.
    ring = np.tile(stars.ring[0], (size + 2, 1))
    width = min(size, len(stars.ring))
    ring[1 : width + 1], ring[0] = stars.ring[:width], stars.ring[n - 1, np.arange(len(n))]
    # Beside the old place and the size, so that no coordinate is too large or too small for single precision.
    around = np.stack([vertices[:, axis][ring] - old[axis] for axis in (0, 1)])
    scale = np.abs(around).max(axis=(0, 1))
    around /= scale
    move = networks.centre_stars(around, n)
    before, after = _star_quality(around, n), _star_quality(around - move[:, None], n)
    gain = after.sum(axis=0) - before.sum(axis=0)
    return (old + scale * move).T, np.where(after[0] > np.minimum(before[0], 0.3), gain, 0)


def _star_quality(around: np.ndarray, n_ring: np.ndarray) -> np.ndarray:
    """(2, S) worst and mean quality of the elements that centres form with the wrapped rings (2, R + 2, S) around."""
    real = np.arange(around.shape[1] - 2)[:, None] < n_ring
    quality = quality_of_sides(around[:, 1:-1], around[:, 2:])
    return np.stack([np.where(real, quality, 1).min(axis=0), total_in_turn(np.where(real, quality, 0)) / n_ring])
