"""NN2 recomputes the places of a large mesh's inner vertices (paper, Algorithm 5, line 32), across all seams.

Every vertex off the boundary is the only inner vertex of the contour that its neighbours form: NN2 is asked where it
should be. A move is made where the worst and the mean quality of its elements, added, get better; vertices that move
together are never neighbours, so no move can spoil another and elements stay valid.
"""

from __future__ import annotations

import numpy as np

from . import networks
from .cavity import next_vertices
from .quality import quality_of_sides
from .stars import Stars, find_independent_stars, total_in_turn
from .transform import superimpose

LARGEST_STAR = 16
# A vertex on the straight cut between two cells is often in a local optimum of its own; a few passes spread the error.
PASSES = 3
_GAIN = 2e-3  # in worst and mean quality added: less is not worth a move


def relax(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    passes: int = PASSES,
    disturbed: np.ndarray | None = None,
    fixed: np.ndarray | None = None,
) -> np.ndarray:
    """Better places for the vertices of a mesh that are off its boundary: (n, 2); the others stay.

    vertices: (n, 2); triangles: (m, 3); domain: (m,) int, the domain of each triangle: the vertices of each are
    numbered by themselves, so that a domain is relaxed alike alone and in a batch. disturbed: (n,) bool, vertices near
    which there is something to relax; all, if not given. fixed: (f, 2) edges whose vertices stay too.
    """
    sets = find_independent_stars(triangles, domain, len(vertices), LARGEST_STAR, fixed)
    vertices = vertices.copy()
    if disturbed is None:
        disturbed = np.ones(len(vertices), dtype=bool)
    for _ in range(passes):
        moved = np.zeros(len(vertices), dtype=bool)
        for independent in sets:
            around = disturbed[independent.ring] | moved[independent.ring]
            stars = independent.rows(disturbed[independent.centre] | around.any(axis=1))
            if len(stars.centre):
                places, better = _better_places(vertices, stars)
                vertices[stars.centre[better]], moved[stars.centre] = places[better], better
        disturbed = moved
    return vertices


def _better_places(vertices: np.ndarray, stars: Stars) -> tuple[np.ndarray, np.ndarray]:
    """New places (S, 2) of the stars' centres, and whether each is better than the old one."""
    contour, old = vertices[stars.ring], vertices[stars.centre]
    transformation = superimpose(contour, stars.n_ring)
    moved = networks.move_inner_vertices(
        transformation.apply(contour), stars.n_ring, transformation.apply(old[:, None]), np.ones_like(stars.n_ring)
    )
    new = transformation.invert(moved)[:, 0]
    before, after = _star_quality(contour, stars.n_ring, old), _star_quality(contour, stars.n_ring, new)
    better = after.sum(axis=0) > before.sum(axis=0) + _GAIN
    return new, better & (after[0] > np.minimum(before[0], 0.3))


def _star_quality(ring: np.ndarray, n_ring: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """(2, S) worst and mean quality of the elements that each centre (S, 2) forms with its ring (S, R, 2)."""
    real = np.arange(ring.shape[1]) < n_ring[:, None]
    a, b = ring - centre[:, None], next_vertices(ring, n_ring) - centre[:, None]
    quality = quality_of_sides(a, b)
    return np.stack([np.where(real, quality, 1).min(axis=1), total_in_turn(np.where(real, quality, 0)) / n_ring])
