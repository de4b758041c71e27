"""Triangulation: valid for every table, the same in every batch, and close to CDT with calculated tables."""

from itertools import zip_longest

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tessera.quality import element_quality
from tessera.triangulation import _FLAT, triangulate
from tessera.visibility import edge_signs, edge_starts, possible_elements
from tests.library.polygons import comb, needle, placed, placements, seeds, spiral, staircase, star
from tests.validity import check_many, exact_double_area, polygon_area, side
from training.meshing import delaunay, qualities
from training.tables import connection_tables


def sector(seed: int, n: int | None = None) -> np.ndarray:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 17)) if n is None else n
    angle = (np.arange(n) + rng.uniform(0, 0.95, n)) * 2 * np.pi / n
    points = rng.uniform(rng.choice([0.05, 0.3, 0.8]), 1, n)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return points if polygon_area(points) > 0 else points[::-1]  # three vertices may leave half a turn between two


def with_straight_runs(seed: int) -> np.ndarray:
    """A polygon of few corners, its sides divided: straight to the last bit only where the sides are axis-parallel."""
    rng = np.random.default_rng(seed)
    corners = sector(seed, int(rng.integers(3, 6)))
    if rng.random() < 0.5:
        corners = np.array([[0, 0], [4, 0], [4, rng.integers(1, 4)], [0, 3]], dtype=float)
    parts = rng.integers(1, 4, len(corners))
    sides = zip(corners, np.roll(corners, -1, axis=0), parts, strict=True)
    return np.concatenate([a + np.arange(k)[:, None] / k * (b - a) for a, b, k in sides])


contours = st.one_of(
    seeds.map(sector),
    seeds.map(with_straight_runs),
    seeds.map(staircase),
    st.integers(1, 4).map(comb),
    st.integers(8, 12).map(lambda n: spiral(n, turns=1.2)),
    st.tuples(st.integers(2, 8), st.sampled_from([1.0, 0.05, 1e-4, 1e-7])).map(lambda a: needle(*a)),
    st.tuples(st.integers(3, 8), st.sampled_from([0.05, 0.4, 0.9])).map(lambda a: star(*a)),
)


def strictly_inside(point: np.ndarray, polygon: np.ndarray) -> bool:
    inside = False
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        low, high = (a, b) if a[1] <= b[1] else (b, a)
        turn = side(low, high, point)
        if turn == 0 and np.all(np.minimum(a, b) <= point) and np.all(point <= np.maximum(a, b)):
            return False
        inside ^= bool(low[1] <= point[1] < high[1] and turn > 0)
    return inside


def inner_vertices(polygon: np.ndarray, seed: int, wanted: int) -> np.ndarray:
    """Up to so many distinct points inside: anywhere, and on lines through vertices (halfway between two of them)."""
    rng = np.random.default_rng(seed)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    pairs = polygon[rng.integers(len(polygon), size=(3 * wanted, 2))].mean(axis=1)
    candidates = np.concatenate([rng.uniform(low, high, (3 * wanted, 2)), pairs])
    found: list[np.ndarray] = []
    for point in rng.permutation(candidates):
        if len(found) < wanted and strictly_inside(point, polygon):
            found.append(point)
    return np.unique(np.array(found).reshape(-1, 2), axis=0)


def padded(members: list[tuple[np.ndarray, np.ndarray]], extra: int = 0):
    width = max(len(contour) + len(inner) for contour, inner in members) + extra
    points = np.full((len(members), width, 2), 7.0)
    for row, member in zip(points, members, strict=True):
        joined = np.concatenate(member)
        row[: len(joined)] = joined
    n_contour, n_inner = np.array([[len(contour), len(inner)] for contour, inner in members]).T
    return points, n_contour, n_inner


def corners(points, n_contour, entries):
    """The entries' elements (P, 3, 2)."""
    row, facet, vertex = entries.T
    return points[row[:, None], np.stack([facet, (facet + 1) % n_contour[row], vertex], axis=1)]


def scattered(points, n_contour, n_inner, entries):
    """Entries that look random, but depend on the contour's own points alone."""
    x = corners(points, n_contour, entries) @ [12.9898, 78.233]
    value = np.sin(1e4 * (x @ [1, 3, 1])) * 43758.5453
    return np.stack([value % 1, (7 * value) % 1], axis=-1)


def own_quality(points, n_contour, n_inner, entries):
    elements = corners(points, n_contour, entries).reshape(-1, 2)
    quality = element_quality(elements, np.arange(len(elements)).reshape(-1, 3))
    return np.repeat(quality[:, None], 2, axis=1)


def calculated(points, n_contour, n_inner, entries):
    return connection_tables(points, n_contour, n_inner)[tuple(entries.T)]


def filled(value):
    return lambda points, n_contour, n_inner, entries: np.full((len(entries), 2), value)


TABLES = {
    "zero": filled(0.0),
    "constant": filled(0.5),
    "one": filled(1.0),
    "negative": filled(-1.0),
    "nan": filled(np.nan),
    "infinite": filled(np.inf),
    "huge": filled(1e300),
    "random": scattered,
    "few": lambda *a: np.maximum(scattered(*a) - 0.9, 0),
    "holed": lambda *a: np.where(scattered(*a) > 0.5, np.nan, scattered(*a)),
    "own quality": own_quality,
    "inverted": lambda *a: 1 - own_quality(*a),
}


@settings(max_examples=200, suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(
    st.lists(st.tuples(contours, placements, seeds, st.integers(0, 24)), min_size=1, max_size=4),
    st.sampled_from(sorted(TABLES)),
)
def test_every_table_gives_a_valid_mesh(members, name):
    polygons = [(placed(polygon, placement), seed, n) for polygon, placement, seed, n in members]
    batch = padded([(polygon, inner_vertices(polygon, seed, n)) for polygon, seed, n in polygons], extra=2)
    result = triangulate(*batch, TABLES[name])
    check_many(*batch, result.triangles, result.owner)
    if name in ("zero", "negative", "nan", "infinite"):
        assert (result.fallbacks > 0).all()
    if name in ("constant", "one", "huge", "own quality"):
        # Straight runs that are bent by rounding alone may leave nothing but flat elements.
        quality = element_quality(batch[0].reshape(-1, 2), result.triangles + result.owner[:, None] * batch[0].shape[1])
        flat = np.isin(np.arange(len(polygons)), result.owner[quality <= _FLAT])
        assert not result.fallbacks[~flat].any()


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
    members = mixed_batch(30)

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


@given(contours, placements, seeds)
def test_signs_are_exact(polygon, placement, seed):
    polygon = placed(polygon, placement)
    points, n_contour, n_inner = padded([(polygon, inner_vertices(polygon, seed, 3))], extra=1)
    signs, starts = edge_signs(points, n_contour, n_inner)[0], edge_starts(n_contour)[0]
    rng = np.random.default_rng(seed)
    n = int(n_contour[0] + n_inner[0])
    for _ in range(60):
        x, v = rng.integers(n, size=2)
        k = int(rng.integers(len(starts)))
        assert signs[x, k, v] == np.sign(exact_double_area(points[0, starts[k]], points[0, v], points[0, x]))
    assert not signs[n:].any() and not signs[:, :, n:].any()


def test_possible_elements_of_a_square_with_its_centre():
    points = np.array([[[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]]], dtype=float)
    possible = possible_elements(edge_signs(points, np.array([4]), np.array([1])), np.array([4]), np.array([1]))[0]
    assert np.array_equal(np.argwhere(possible), [[0, 4], [1, 4], [2, 4], [3, 4]])


def test_facets_behind_others_are_not_connected():
    # A U: the tip of one arm is hidden from the other arm's outer side.
    points = np.array([[[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]]], dtype=float)
    possible = possible_elements(edge_signs(points, np.array([8]), np.array([0])), np.array([8]), np.array([0]))[0]
    assert np.flatnonzero(possible[1]).tolist() == [3, 4]
    assert np.flatnonzero(possible[0]).tolist() == [4, 5]


def test_calculated_tables_lead_close_to_cdt():
    rng = np.random.default_rng(2)
    members = []
    while len(members) < 200:
        polygon = rng.uniform(0.3, 1, 10)[:, None] ** 0.5 * star(5, 1.0)
        candidates = rng.uniform(-0.8, 0.8, (60, 2))
        spaced = [p for p in candidates if np.linalg.norm(polygon - p, axis=1).min() > 0.15]
        inner: list[np.ndarray] = []
        for p in spaced:
            if len(inner) < 5 and strictly_inside(p, polygon) and all(np.linalg.norm(p - q) > 0.25 for q in inner):
                inner.append(p)
        if len(inner) >= 2:
            members.append((polygon, np.array(inner)))
    batch = padded(members)
    result = triangulate(*batch, calculated)
    errors = []
    for row, (polygon, inner) in enumerate(members):
        vertices = np.concatenate([polygon, inner])
        matrix = np.empty((len(vertices), len(vertices)), dtype=np.int64)
        assert delaunay(vertices, len(polygon), len(vertices), matrix)
        q = element_quality(vertices, result.triangles[result.owner == row])
        reference = np.array(qualities(vertices, matrix, len(vertices)))
        errors.append((reference - [q.min(), q.mean()]) / reference)
    e_worst, e_mean = np.mean(errors, axis=0)
    assert e_worst <= 0.01 and e_mean <= 0.005
    assert not result.fallbacks.any()


@pytest.mark.parametrize("points", [[[0, 0], [0, 1], [1, 0]], [[0, 0], [1, 0], [2, 0]]])
def test_what_is_no_counter_clockwise_polygon_is_refused(points):
    with pytest.raises(ValueError, match="contour 1 "):
        good = (sector(0, 8), np.zeros((0, 2)))
        triangulate(*padded([good, (np.array(points, dtype=float), np.zeros((0, 2)))]), filled(1.0))


def test_no_contours():
    result = triangulate(np.zeros((0, 5, 2)), np.zeros(0, int), np.zeros(0, int), filled(1.0))
    assert result.triangles.shape == (0, 3) and len(result.owner) == 0 and len(result.fallbacks) == 0
