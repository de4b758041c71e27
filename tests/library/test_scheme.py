"""The scheme on single contours and in batches: valid, faithful to the contour, the same in every batch."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera import networks
from tessera.scheme import join_vertices, mesh_contours
from tessera.stopwatch import Stopwatch
from tests.validity import check_many, check_mesh


def sector_contours(seed: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random star-shaped contours of 3 to 16 edges, padded (count, 16, 2), and their numbers of edges."""
    rng = np.random.default_rng(seed)
    n_contour = rng.integers(3, 17, count)
    points = np.zeros((count, 16, 2))
    for row, n in enumerate(n_contour):
        angle = 2 * np.pi * (np.arange(n) + rng.uniform(0, 0.7, n)) / n
        points[row, :n] = rng.uniform(0.3, 1, (n, 1)) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return points, n_contour


def mesh(points, n_contour, l_s):
    return mesh_contours(points, n_contour, l_s, Stopwatch())


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 2**32), st.floats(0.15, 2))
def test_every_contour_gets_a_valid_mesh(seed, l_s):
    points, n_contour = sector_contours(seed, 40)
    meshes = mesh(points, n_contour, np.full(40, l_s))
    vertices = join_vertices(points, n_contour, meshes.inner, meshes.n_inner)
    check_many(vertices, n_contour, meshes.n_inner, meshes.triangles, meshes.owner)


def test_a_shorter_target_gives_more_vertices():
    points, n_contour = sector_contours(6, 100)
    counts = [mesh(points, n_contour, np.full(100, l_s)).n_inner.mean() for l_s in (1.0, 0.6, 0.4)]
    assert counts[0] < counts[1] < counts[2]


def test_mesh_contour_keeps_the_contour():
    points = 100 + 30 * np.array([[0, 0], [2, 0], [3, 1], [2, 2], [1, 1.5], [0, 2]])
    result = tessera.mesh_contour(points, 20)
    check_mesh(result.vertices, result.triangles, [points])
    np.testing.assert_array_equal(result.vertices[:6], points)
    assert result.report.n_triangles == len(result.triangles) and result.report.q_worst > 0.3


@pytest.mark.parametrize("scale", [1e-6, 1, 1e6])
def test_mesh_contour_at_any_scale(scale):
    points = scale * np.array([[0, 0], [4, 0], [5, 3], [2, 5], [-1, 3]])
    result = tessera.mesh_contour(points, scale)
    check_mesh(result.vertices, result.triangles, [points])
    assert result.report.n_vertices > 5


def test_mesh_contour_says_when_the_target_is_out_of_its_reach():
    result = tessera.mesh_contour([(0, 0), (1, 0), (1, 1), (0, 1)], 0.01)
    assert "4 of the 4 kept boundary edges are longer than the target" in result.report.warnings[0]
    angle = np.arange(16) / 8 * np.pi
    result = tessera.mesh_contour(np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.05)
    assert "inner vertices would suit" in result.report.warnings[-1]


def test_mesh_contour_of_too_many_edges():
    angle = np.arange(17) / 17 * 2 * np.pi
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh_contour(np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.3)
    assert error.value.reason == "too-many-edges"


@pytest.mark.parametrize("answer", [np.nan, np.inf, -5.0, 1e30])
@pytest.mark.parametrize("role", ["nn1", "nn2_scores", "nn2_moves", "nn3"])
def test_whatever_a_network_answers_meshes_are_valid(role, answer, monkeypatch):
    shipped = networks.session

    class Wrong:
        def run(self, _, inputs):
            return [np.full_like(out, answer) for out in shipped(role).run(None, inputs)]

    monkeypatch.setattr(networks, "session", lambda asked: Wrong() if asked == role else shipped(asked))
    points, n_contour = sector_contours(3, 30)
    meshes = mesh(points, n_contour, np.full(30, 0.4))
    assert (meshes.wanted >= 0).all()
    if role == "nn3" and not np.isfinite(answer):
        assert (meshes.fallbacks > 0).any()  # what such a table had no say in is counted
    vertices = join_vertices(points, n_contour, meshes.inner, meshes.n_inner)
    check_many(vertices, n_contour, meshes.n_inner, meshes.triangles, meshes.owner)


def test_poor_contours_are_led_by_the_table_too(monkeypatch):
    """Where NN3's q_worst is nowhere above 0, as its error may be larger, it is no fallback."""
    shipped = networks.session

    class Pessimist:
        def run(self, _, inputs):
            return [out - [2, 0] for out in shipped("nn3").run(None, inputs)]

    points, n_contour = sector_contours(3, 30)
    monkeypatch.setattr(networks, "session", lambda asked: Pessimist() if asked == "nn3" else shipped(asked))
    meshes = mesh(points, n_contour, np.full(30, 0.4))
    assert not meshes.fallbacks.any()
    vertices = join_vertices(points, n_contour, meshes.inner, meshes.n_inner)
    check_many(vertices, n_contour, meshes.n_inner, meshes.triangles, meshes.owner)


@pytest.mark.parametrize("padding", [np.nan, np.inf, -1e300, 0.1])
def test_padding_is_of_any_value(padding):
    points, n_contour = sector_contours(4, 30)
    expected = mesh(points, n_contour, np.full(30, 0.4))
    points[np.arange(16) >= n_contour[:, None]] = padding
    found = mesh(points, n_contour, np.full(30, 0.4))
    assert np.array_equal(found.triangles, expected.triangles) and np.array_equal(found.inner, expected.inner)


@pytest.mark.parametrize("edge_length", [1e-300, 1e-19, 1e-9, 1e9, 1e300])
def test_a_target_far_from_the_contour_s_size(edge_length):
    contour = [(0, 0), (4, 0), (4, 3), (2, 1.5), (0, 3)]
    mesh = tessera.mesh_contour(contour, edge_length)
    check_mesh(mesh.vertices, mesh.triangles, [contour])
    assert bool(mesh.report.warnings) == (edge_length < 1.6)


def test_counts_may_be_shorter_integers():
    """As numpy's own are on Windows before its version 2; the networks take those of 64 bits alone."""
    angle = 2 * np.pi * np.arange(9) / 9
    contour, length = np.stack([np.cos(angle), np.sin(angle)], axis=1)[None], np.array([0.5])
    kinds = np.int32, np.int64
    one, other = (mesh_contours(contour, np.array([9], dtype=kind), length, Stopwatch()) for kind in kinds)
    np.testing.assert_array_equal(one.triangles, other.triangles)
    np.testing.assert_array_equal(one.inner, other.inner)
