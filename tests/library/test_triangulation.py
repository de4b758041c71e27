"""Triangulation: valid for every table, and the same in every batch."""

from itertools import zip_longest

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from tessera.quality import element_quality
from tessera.triangulation import triangulate
from tessera.visibility import as_bools, bits_of, edge_sides, possible_elements, vertex_sides
from tests.library.adversaries import (
    TABLES,
    batches,
    check_guarantee,
    filled,
    inner_vertices,
    padded,
    placed_contours,
    scattered,
    sector,
    tables,
    with_straight_runs,
)
from tests.library.polygons import seeds, staircase, star
from tests.validity import check_many, exact_double_area


@settings(max_examples=60, suppress_health_check=list(HealthCheck), deadline=None)
@given(batches, tables)
def test_every_table_gives_a_valid_mesh(batch, table):
    check_guarantee(batch, table)


def mixed_batch(size: int):
    rng = np.random.default_rng(5)
    members = []
    for seed in range(size):
        polygon = (sector, with_straight_runs, staircase)[seed % 3](seed)
        members.append((polygon, inner_vertices(polygon, seed, int(rng.integers(0, 25)))))
    return members


def meshes(members, connect, extra=0):
    batch = padded(members, extra)
    result = triangulate(*batch, connect)
    return [(result.triangles[result.owner == row].tolist(), result.fallbacks[row]) for row in range(len(members))]


@pytest.mark.parametrize("name", ["random", "few", "constant", "nan"])
def test_a_mesh_does_not_depend_on_its_batch(name):
    members, connect = mixed_batch(60), TABLES[name]
    together = meshes(members, connect)
    order = np.random.default_rng(0).permutation(len(members))
    shuffled = meshes([members[i] for i in order], connect, extra=5)
    assert [shuffled[i] for i in np.argsort(order)] == together
    assert meshes(members[:7], connect) + meshes(members[7:], connect) == together
    assert [mesh for member in members for mesh in meshes([member], connect)] == together


def test_one_call_rates_all_contours_of_a_level():
    members = [member for member in mixed_batch(40) if len(np.concatenate(member)) <= 32]

    def levels(members):
        calls = []

        def connect(points, n_contour, n_inner, entries):
            assert np.array_equal(np.unique(entries[:, 0]), np.arange(len(points)))
            assert np.array_equal(entries, np.unique(entries, axis=0))
            calls.append(len(points))
            return scattered(points, n_contour, n_inner, entries)

        meshes(members, connect)
        return calls

    alone = [levels([member]) for member in members]
    assert levels(members) == [sum(level) for level in zip_longest(*alone, fillvalue=0)]


def test_chunks_do_not_change_meshes(monkeypatch):
    members = mixed_batch(20)
    together = meshes(members, scattered)
    monkeypatch.setattr("tessera.triangulation._CHUNK_SIZE", 1)
    assert meshes(members, scattered) == together


@pytest.mark.parametrize(("n", "m"), [(20, 20), (40, 10), (30, 40)])
def test_words_of_any_size(n, m):
    members = [(star(n, 0.8), inner_vertices(star(n, 0.8), 0, m)), (sector(1), np.zeros((0, 2)))]
    batch = padded(members)
    result = triangulate(*batch, scattered)
    check_many(*batch, result.triangles, result.owner)


@given(placed_contours, seeds)
def test_signs_are_exact(polygon, seed):
    points, n_contour, n_inner = padded([(polygon, inner_vertices(polygon, seed, 3))], extra=1)
    n = int(n_contour[0] + n_inner[0])
    left, right = as_bools(vertex_sides(points, np.array([n]))[0], bits_of(points.shape[1])).transpose(2, 1, 0, 3)
    rng = np.random.default_rng(seed)
    for _ in range(60):
        u, v, x = rng.integers(n, size=3)
        sign = np.sign(exact_double_area(*points[0, [u, v, x]]))
        assert (left[u, v, x], right[u, v, x]) == (sign > 0, sign < 0)
    assert not left[..., n:].any() and not right[..., n:].any()


def possible_table(points, n):
    width, n_contour = points.shape[1], np.array([n])
    sides, bits = vertex_sides(points, np.array([width])), bits_of(width)
    sides = edge_sides(sides, np.array([0]), np.arange(width)[None], n_contour)
    return as_bools(possible_elements(sides, bits[None], n_contour)[:, 0], bits)


def test_possible_elements_of_a_square_with_its_centre():
    points = np.array([[[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]]], dtype=float)
    possible = possible_table(points, 4)
    assert np.array_equal(np.argwhere(possible), [[0, 4], [1, 4], [2, 4], [3, 4]])


def test_facets_behind_others_are_not_connected():
    # A U: the tip of one arm is hidden from the other arm's outer side.
    points = np.array([[[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]]], dtype=float)
    possible = possible_table(points, 8)
    assert np.flatnonzero(possible[1]).tolist() == [3, 4]
    assert np.flatnonzero(possible[0]).tolist() == [4, 5]


@pytest.mark.parametrize("points", [[[0, 0], [0, 1], [1, 0]], [[0, 0], [1, 0], [2, 0]]])
def test_what_is_no_counter_clockwise_polygon_is_refused(points):
    with pytest.raises(ValueError, match="contour 1 "):
        good = (sector(0, 8), np.zeros((0, 2)))
        triangulate(*padded([good, (np.array(points, dtype=float), np.zeros((0, 2)))]), filled(1.0))


def test_no_contours():
    result = triangulate(np.zeros((0, 5, 2)), np.zeros(0, int), np.zeros(0, int), filled(1.0))
    assert result.triangles.shape == (0, 3) and len(result.owner) == 0 and len(result.fallbacks) == 0


def test_flat_elements_are_told_apart():
    """A strip so thin that a quality is below what entries are compared to: its best elements all the same."""
    width, n = 1e-8, 6
    upper = np.column_stack([np.arange(n)[::-1], np.full(n, width)])
    strip = np.concatenate([np.column_stack([np.arange(n), np.zeros(n)]), upper])
    points = strip[None].astype(float)
    result = triangulate(points, np.array([2 * n]), np.array([0]), lambda *rest: np.ones((len(rest[-1]), 2)))
    check_many(points, np.array([2 * n]), np.array([0]), result.triangles, result.owner)
    assert element_quality(strip, result.triangles).min() > 1.5 * width


def test_vertices_outside_the_contour_raise():
    points = np.array([[(0, 0), (1, 0), (1, 1), (0, 1), (2, 2), (0.5, 0.5)]], dtype=float)
    with pytest.raises(ValueError, match="inner vertices inside"):
        triangulate(points, np.array([4]), np.array([2]), lambda *rest: np.ones((len(rest[-1]), 2)))
