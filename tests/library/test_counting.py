"""Meshes of a wanted number of triangles."""

import numpy as np
import pytest

import tessera
from tessera.counting import TOLERANCE, expected_edge_length, mesh_to_counts
from tessera.steps import finish

SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)


def circle(radius=1.0, n=200):
    t = np.arange(n) / n * 2 * np.pi
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def star(n=14, inner=0.45):
    t = np.arange(n) / n * 2 * np.pi
    return np.where(np.arange(n) % 2 == 0, 1, inner)[:, None] * np.column_stack([np.cos(t), np.sin(t)])


DOMAINS = {
    "square": [SQUARE],
    "ring": [circle(), circle(0.6)],
    "star": [star()],
    "strip": [SQUARE * (10, 1)],
    "far and tiny": [1e-6 * star() + 5],
    "plate": [SQUARE * 4, circle(0.5) + 1, circle(0.3) + 3],
}


def made(loops, n_triangles, **settings):
    """The mesh, and the lengths that were tried."""
    lengths = []

    def mesh_at(numbers, tried):
        assert numbers == [0]
        lengths.extend(tried)
        return [tessera.mesh(loops, *tried, **settings)]
        yield

    (mesh,) = finish(mesh_to_counts([loops], [n_triangles], mesh_at))
    return mesh, lengths


@pytest.mark.parametrize("name", DOMAINS)
@pytest.mark.parametrize("n_triangles", [150, 1000])
def test_the_number_is_met(name, n_triangles):
    mesh, tries = made(DOMAINS[name], n_triangles)
    assert abs(mesh.report.n_triangles / n_triangles - 1) <= TOLERANCE
    assert not mesh.report.warnings
    assert len(tries) <= 4


@pytest.mark.parametrize("sizing", [tessera.by_distance(0.06), tessera.by_thickness(4)])
def test_the_number_is_met_with_a_sizing(sizing):
    mesh, _ = made(DOMAINS["plate"], 3000, sizing=sizing)
    assert abs(mesh.report.n_triangles / 3000 - 1) <= TOLERANCE


def test_a_kept_boundary_that_needs_more_gives_the_closest_and_says_so():
    mesh, tries = made([circle()], 20, boundary="keep")
    assert mesh.report.n_triangles >= 198
    assert any("20 triangles are wanted" in warning for warning in mesh.report.warnings)
    assert len(set(tries)) == len(tries)


def test_the_expected_length_goes_with_the_size():
    length = expected_edge_length(DOMAINS["plate"], 500)
    assert expected_edge_length([1000 * loop for loop in DOMAINS["plate"]], 500) == pytest.approx(1000 * length)


def test_a_domain_that_cannot_be_meshed_is_refused():
    crossed, _ = made([[(0, 0), (1, 1), (1, 0), (0, 1)]], 100)
    assert crossed.reason == "self-intersection"
    nothing, _ = made([], 100)
    assert nothing.reason == "too-few-points"


def test_each_of_several_domains_is_meshed_as_it_would_be_alone():
    names, counts = ["ring", "strip", "star", "plate"], [300, 20, 500, 150]
    domains = [DOMAINS[name] for name in names] + [[[(0, 0), (1, 1), (1, 0), (0, 1)]]]
    asked = []

    def mesh_at(numbers, lengths):
        asked.append(numbers)
        return tessera.mesh_many([domains[number] for number in numbers], lengths)
        yield

    *meshes, error = finish(mesh_to_counts(domains, [*counts, 100], mesh_at))
    assert isinstance(error, tessera.ContourError) and asked[0] == [0, 1, 2, 3]
    for name, count, mesh in zip(names, counts, meshes, strict=True):
        alone, _ = made(DOMAINS[name], count)
        assert np.array_equal(alone.vertices, mesh.vertices) and np.array_equal(alone.triangles, mesh.triangles)
        assert alone.report.warnings == mesh.report.warnings
