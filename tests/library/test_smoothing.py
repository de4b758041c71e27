"""Smoothing: the boundary stays, meshes stay valid, poor elements get better, the same in every batch."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import tessera
from tessera.quality import element_quality
from tessera.smoothing import smooth
from tests.library.adversaries import members, tables
from tests.library.polygons import LETTER_E
from tests.library.test_flips import triangulated
from tests.validity import check_many, check_mesh


def energy(vertices, triangles):
    return (element_quality(vertices, triangles) ** -8.0).sum()


HEXAGON = np.array([[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3])


@settings(max_examples=40, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.lists(members, min_size=1, max_size=10), tables)
def test_smoothed_meshes_are_valid_and_no_worse(batch, table):
    """In the sum of q^-8, however bad the meshes were."""
    points, n_contour, n_inner, triangles, owner = triangulated(batch, table)
    flat = triangles + owner[:, None] * points.shape[1]
    after = smooth(points.reshape(-1, 2), flat, 2, owner).reshape(points.shape)
    check_many(after, n_contour, n_inner, triangles, owner)
    for row, n in enumerate(n_contour):
        assert np.array_equal(after[row, :n], points[row, :n])
        own = triangles[owner == row]
        if element_quality(points[row], own).min() > 0.1:
            assert energy(after[row], own) <= energy(points[row], own) * (1 + 1e-9)
        assert np.array_equal(smooth(points[row], own, 2), after[row])


def test_a_vertex_finds_the_middle():
    vertices = np.concatenate([HEXAGON, [[0.5, 0.2]]])
    triangles = np.array([[k, (k + 1) % 6, 6] for k in range(6)])
    np.testing.assert_allclose(smooth(vertices, triangles, 20)[6], 0, atol=0.01)
    assert np.array_equal(smooth(vertices, triangles, 0), vertices)
    assert len(smooth(np.zeros((0, 2)), np.zeros((0, 3), dtype=int), 3)) == 0


def test_a_neighbour_that_is_next_to_the_vertex():
    """It stands for a ring's padding too, beside a larger ring: an element without any side, which has no say."""
    seven = 5 + np.array([[np.cos(a), np.sin(a)] for a in np.arange(7) * 2 * np.pi / 7])
    vertices = np.concatenate([HEXAGON, [[0.0, 0.0]], seven, [[5.3, 5.1]]])
    vertices[0] = 1e-200, 0
    triangles = np.array([[k, (k + 1) % 6, 6] for k in range(6)] + [[7 + k, 7 + (k + 1) % 7, 14] for k in range(7)])
    found = smooth(vertices, triangles, 20)
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found[14], [5, 5], atol=0.01)


@pytest.mark.parametrize("scale", [1e-99, 1e-6, 1e6, 1e99])
def test_the_scale_does_not_matter(scale):
    vertices = np.concatenate([HEXAGON, [[0.5, 0.2]]])
    triangles = np.array([[k, (k + 1) % 6, 6] for k in range(6)])
    np.testing.assert_allclose(
        smooth(scale * vertices, triangles, 3) / scale, smooth(vertices, triangles, 3), atol=1e-9
    )


def test_smoothing_is_an_option_of_meshing():
    square = [[0, 0], [1, 0], [1, 1.2], [0, 1]]
    for mesh in (
        lambda n: tessera.mesh([LETTER_E], 0.31, smooth=n),
        lambda n: tessera.mesh_contour(square, 0.3, smooth=n),
    ):
        before, after = mesh(0), mesh(3)
        assert np.array_equal(before.triangles, after.triangles)
        assert energy(after.vertices, after.triangles) < energy(before.vertices, before.triangles)
        assert "smoothing" in after.report.seconds and "smoothing" not in before.report.seconds
        for steps in (-1, 1.5, None, "3"):
            with pytest.raises(ValueError, match="smooth"):
                mesh(steps)
    (many,) = tessera.mesh_many([[LETTER_E]], 0.31, smooth=3)
    assert np.array_equal(many.vertices, tessera.mesh([LETTER_E], 0.31, smooth=3).vertices)
    check_mesh(many.vertices, many.triangles, [LETTER_E], keep=False)
