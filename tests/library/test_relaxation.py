"""Stars, and their relaxation: valid, better, boundary untouched."""

import numpy as np
import pytest

from tessera.edges import inner_edges, off_boundary
from tessera.quality import element_quality
from tessera.refinement import refine
from tessera.relaxation import _star_quality, relax
from tessera.stars import find_stars, independent_sets
from tessera.steps import finish
from tessera.stopwatch import Stopwatch
from tests.validity import check_mesh


def disturbed_grid(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, triangles and outline of a square grid, its inner vertices moved about."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    vertices = np.stack([x.ravel(), y.ravel()], axis=1)
    first = (np.arange(n) + (n + 1) * np.arange(n)[:, None]).ravel()
    lower = np.stack([first, first + 1, first + n + 2], axis=1)
    upper = np.stack([first, first + n + 2, first + n + 1], axis=1)
    triangles = np.concatenate([lower, upper])
    free = off_boundary(triangles, len(vertices))
    vertices[free] += np.random.default_rng(seed).uniform(-0.25, 0.25, (free.sum(), 2))
    side = np.arange(n)
    outline = np.concatenate([side, (n + 1) * side + n, (n + 1) * n + n - side, (n + 1) * (n - side)])
    return vertices, triangles, vertices[outline]


def test_stars_are_the_rings_of_neighbours():
    vertices, triangles, _ = disturbed_grid(6, 0)
    free = off_boundary(triangles, len(vertices))
    stars = find_stars(triangles, free, 16)
    assert sorted(stars.centre) == sorted(np.flatnonzero(free))
    for centre, ring, n in zip(stars.centre, stars.ring.T, stars.n_ring, strict=True):
        around = triangles[(triangles == centre).any(axis=1)]
        assert set(ring[:n]) == set(around.ravel()) - {centre} and len(around) == n
        pairs = {frozenset(t) - {centre} for t in map(frozenset, around)}
        assert pairs == {frozenset((ring[k], ring[(k + 1) % n])) for k in range(n)}


def test_large_stars_are_left_out():
    triangles = np.stack([np.full(20, 20), np.arange(20), (np.arange(20) + 1) % 20], axis=1)
    free = off_boundary(triangles, 21)
    assert free.sum() == 1
    assert len(find_stars(triangles, free, 16).centre) == 0
    assert len(find_stars(triangles, free, 20).centre) == 1


def test_sets_have_no_neighbours_and_hold_every_star():
    vertices, triangles, _ = disturbed_grid(12, 1)
    stars = find_stars(triangles, off_boundary(triangles, len(vertices)), 16)
    sets = independent_sets(stars, np.arange(len(vertices)))
    assert sorted(np.concatenate(sets)) == list(range(len(stars.centre)))
    edges = {frozenset(edge) for edge in inner_edges(triangles)[0].tolist()}
    for rows in sets:
        centres = stars.centre[rows].tolist()
        assert not any(frozenset((a, b)) in edges for i, a in enumerate(centres) for b in centres[:i])


@pytest.mark.parametrize("seed", range(3))
def test_relaxation_improves_a_disturbed_mesh(seed):
    vertices, triangles, outline = disturbed_grid(10, seed)
    free = off_boundary(triangles, len(vertices))
    relaxed = finish(relax(vertices, triangles, np.zeros(len(triangles), int), free, 3, Stopwatch()))
    check_mesh(relaxed, triangles, [outline])
    np.testing.assert_array_equal(relaxed[~free], vertices[~free])
    before, after = element_quality(vertices, triangles), element_quality(relaxed, triangles)
    assert after.mean() > before.mean() + 0.02 and after.min() > before.min() + 0.1


def test_refinement_reaches_the_target_and_keeps_the_boundary():
    angle = np.arange(24) / 24 * 2 * np.pi
    outline = 3.45 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.vstack([outline, [[0, 0]]])
    fan = np.stack([np.arange(24), (np.arange(24) + 1) % 24, np.full(24, 24)], axis=1)

    def sizing(points, domain):
        return np.full(len(points), 0.9)

    refined = finish(refine(vertices, fan, np.zeros(24, int), sizing, Stopwatch()))
    vertices, triangles, parent = refined.vertices, refined.triangles, refined.parent
    check_mesh(vertices, triangles, [outline])
    edges, inner = inner_edges(triangles)
    lengths = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    assert lengths[inner].max() < 1.6 * 0.9
    assert set(parent) == set(range(24))


def test_no_refinement_where_none_is_needed():
    vertices, triangles, _ = disturbed_grid(4, 3)

    def sizing(points, domain):
        return np.full(len(points), 2.0)

    again = finish(refine(vertices, triangles, np.zeros(len(triangles), int), sizing, Stopwatch()))
    np.testing.assert_array_equal(again.vertices, vertices)
    np.testing.assert_array_equal(again.triangles, triangles)


def test_the_quality_around_a_vertex_does_not_depend_on_the_padding():
    """To the last bit: whether a move is made must not hang on the widest ring of the batch."""
    rng = np.random.default_rng(3)
    around = rng.normal(size=(2, 9, 200))
    n_ring = rng.integers(4, 8, 200)
    padded = np.concatenate([around, np.repeat(around[:, 1:2], 6, axis=1)], axis=1)
    np.testing.assert_array_equal(_star_quality(around, n_ring), _star_quality(padded, n_ring))
