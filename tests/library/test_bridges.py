"""Domains with holes: bridges cut them into simple polygons, and their meshes are valid and show no seam."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera.bridges import bridge_holes
from tessera.contour import clean_domains, clean_loop, nesting
from tests.library.polygons import (
    LETTER_E,
    circle,
    comb,
    placed,
    placements,
    random_star_shaped,
    seeds,
    spiral,
    staircase,
    star,
)
from tests.validity import check_mesh, polygon_area, polygon_is_simple, side

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
Loops = list[np.ndarray]


def in_a_box(polygon: np.ndarray, centre: np.ndarray, size: float) -> np.ndarray:
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    return (polygon - 0.5 * (low + high)) * (size / (high - low).max()) + centre


def random_loop(rng: np.random.Generator) -> np.ndarray:
    kind = rng.integers(6)
    if kind < 3:
        return (random_star_shaped, staircase, lambda seed: circle(3 + seed % 40))[kind](int(rng.integers(1 << 30)))
    return (comb(int(rng.integers(2, 5)), 3), spiral(40, turns=0.9, width=0.3), LETTER_E)[kind - 3]


def random_domain(seed: int) -> Loops:
    """An outline, and up to five loops more wherever they do not meet: holes, islands in them, contours beside it.

    In some domains all coordinates are multiples of 1/16, so that many are equal.
    """
    rng = np.random.default_rng(seed)
    coarse = rng.random() < 0.3
    loops: Loops = []
    wanted = rng.integers(1, 7)
    for attempt in range(25):
        size = 2.0 if not loops else float(rng.choice([0.03, 0.2, 0.5, 1.2]))
        centre = np.zeros(2) if not loops else rng.uniform(-1, 1, 2)
        loop = in_a_box(random_loop(rng) if attempt else circle(int(rng.integers(4, 80))), centre, size)
        loop = np.round(loop * 16) / 16 if coarse else loop
        if not isinstance(clean_domains([[*loops, loop]])[0], tessera.ContourError):
            loops.append(loop)
        if len(loops) == wanted:
            break
    return loops


random_domains = seeds.map(random_domain)


def regions(loops: Loops) -> tuple[np.ndarray, np.ndarray]:
    """The number of the outer contour of each loop, and which loops are holes."""
    nested = nesting(loops)
    region = np.arange(len(loops))
    region[nested.holes] = nested.parent
    return region, np.isin(np.arange(len(loops)), nested.holes)


def check_bridges(loops: Loops, edge_length: float) -> int:
    """Simple counter-clockwise polygons, whose edges pair up but for the loops' own: they cover each region once.

    Returns how many polygons there are.
    """
    loops = [clean_loop(loop) for loop in loops]
    region, is_hole = regions(loops)
    points, polygons = bridge_holes(loops, region, is_hole, edge_length)
    ends = np.cumsum(polygons.size)
    faces = np.split(polygons.corners, ends[:-1])
    area, directed = np.zeros(len(loops)), set()
    for face, owner in zip(faces, polygons.owner, strict=True):
        corners = points[face]
        assert len(set(face)) == len(face) and polygon_is_simple(corners)
        first = np.lexsort(corners.T[::-1])[0]
        assert side(corners[first - 1], corners[first], corners[(first + 1) % len(face)]) > 0, "clockwise polygon"
        edges = set(zip(face.tolist(), np.roll(face, -1).tolist(), strict=True))
        assert not directed & edges
        directed |= edges
        area[owner] += polygon_area(corners)
    expected, first = set(), 0
    for loop, hole in zip(loops, is_hole, strict=True):
        around = np.arange(first, first + len(loop))[:: -1 if hole else 1]
        expected |= set(zip(around.tolist(), np.roll(around, -1).tolist(), strict=True))
        first += len(loop)
    assert np.array_equal(points[:first], np.concatenate(loops))
    assert {(a, b) for a, b in directed if (b, a) not in directed} == expected
    assert len(np.unique(polygons.corners)) == len(points) == len(np.unique(points, axis=0))
    signs = np.where(is_hole, -1, 1) * [polygon_area(loop) for loop in loops]
    assert area == pytest.approx(np.bincount(region, signs, len(loops)), rel=1e-6, abs=1e-12 * np.abs(signs).max())
    return len(faces)


@settings(deadline=None, max_examples=60)
@given(random_domains, st.sampled_from([1.0, 0.1, 0.01]), placements)
def test_bridges_cut_any_domain_into_simple_polygons(loops, edge_length, placement):
    loops = [placed(loop, placement) for loop in loops]
    if not isinstance(clean_domains([loops])[0], tessera.ContourError):  # rounding may have made them meet
        check_bridges(loops, edge_length * placement[0])


@settings(deadline=None, max_examples=30)
@given(random_domains, placements, st.sampled_from([1.0, 0.3, 0.1]), st.sampled_from(["resample", "keep"]))
def test_any_domain_is_meshed(loops, placement, edge_length, boundary):
    loops = [placed(loop, placement) for loop in loops]
    if not isinstance(clean_domains([loops])[0], tessera.ContourError):
        mesh = tessera.mesh(loops, edge_length * placement[0], boundary=boundary)
        check_mesh(mesh.vertices, mesh.triangles, loops, keep=boundary == "keep")


@settings(deadline=None, max_examples=4)
@given(st.lists(random_domains, min_size=2, max_size=5))
def test_a_batch_is_each_domain_alone(domains):
    for domain, mesh in zip(domains, tessera.mesh_many(domains, 0.15), strict=True):
        alone = tessera.mesh(domain, 0.15)
        np.testing.assert_array_equal(alone.triangles, mesh.triangles)
        np.testing.assert_array_equal(alone.vertices, mesh.vertices)


def ring(gap: float, width: float) -> np.ndarray:
    """A thin C, open to the right by so many radians on either side."""
    angle = np.linspace(gap, 2 * np.pi - gap, 60)
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.concatenate([unit, (1 - width) * unit[::-1]])


LETTER_O = [circle(60) * [0.7, 1], circle(60) * [0.45, 0.75]]
LETTER_B = [
    np.concatenate([[[0, 0]], circle(40)[-9:] + [1, 1], circle(40)[:9] + [1, 3], [[0, 4]]]),
    SQUARE * [1, 1.2] + [0.4, 0.4],
    SQUARE * [1, 1.2] + [0.4, 2.4],
]
FIGURE_8 = [circle(80) * [1, 2], circle(40) * 0.6 + [0, 0.9], circle(40) * 0.6 - [0, 0.9]]
SHAPES = {
    "O": LETTER_O,
    "B": LETTER_B,
    "8": FIGURE_8,
    "C around a hole": [SQUARE * 3 - 1.5, ring(0.2, 0.1), circle(40) * 0.5],
    "nested islands": [(SQUARE * 2 - 1) * s for s in (5, 4, 3, 2, 1)],
    "60 holes": [SQUARE * 9] + [star(5) * 0.3 + [1 + i % 8 + 0.3 * (i // 8 % 2), 1 + i // 8] for i in range(60)],
    "equal x": [SQUARE * 4] + [SQUARE * 0.4 + [x, y] for x in (0.8, 1.8, 2.8) for y in (0.8, 1.8, 2.8)],
    "a hair from the contour": [SQUARE * 4 - 2, SQUARE - [2 - 1e-9, 0.5]],
    "two hairs apart": [SQUARE * 4 - 2, SQUARE - [1 + 1e-9, 0.5], SQUARE - [0, 0.5]],
    "a spiral around a hole": [circle(60) * 6, spiral(120, turns=2.5, width=0.2), circle(12) * 0.4],
}


@pytest.mark.parametrize("edge_length", [0.5, 0.12])
@pytest.mark.parametrize("name", SHAPES)
def test_shapes_with_holes(name, edge_length):
    loops = SHAPES[name]
    assert check_bridges(loops, edge_length) > 1
    mesh = tessera.mesh(loops, edge_length)
    check_mesh(mesh.vertices, mesh.triangles, loops, keep=False)
    assert mesh.report.q_mean > (0.93 if edge_length == 0.12 else 0.8)


def test_a_contour_without_holes_is_its_own_polygon():
    loops = [clean_loop(SQUARE), clean_loop(LETTER_E + 3)]
    points, polygons = bridge_holes(loops, np.arange(2), np.zeros(2, dtype=bool), 0.1)
    np.testing.assert_array_equal(points, np.concatenate(loops))
    assert polygons.corners.tolist() == list(range(16)) and polygons.size.tolist() == [4, 12]
    assert polygons.owner.tolist() == [0, 1]


def test_neighbouring_holes_share_a_bridge():
    row = [SQUARE * [20, 3]] + [circle(16) * 0.5 + [2 + 2 * i, 1.5] for i in range(8)]
    assert check_bridges(row, 0.3) == 2


def test_no_seam_is_seen():
    """The elements that a bridge passed are no worse than those across, where none did."""
    loops = [clean_loop(SQUARE * 4 - 2), clean_loop(circle(60) * 0.8)]
    passed, across = [], []
    for edge_length in (0.09, 0.1, 0.12, 0.14, 0.16):
        mesh = tessera.mesh(loops, edge_length)
        quality = tessera.element_quality(mesh.vertices, mesh.triangles)
        x, y = np.abs(mesh.vertices[mesh.triangles].mean(axis=1)).T
        passed.append(quality[(y < edge_length) & (x > 0.8)])
        across.append(quality[(x < edge_length) & (y > 0.8)])
    passed, across = np.concatenate(passed), np.concatenate(across)
    assert min(len(passed), len(across)) > 300
    assert passed.mean() > across.mean() - 0.005
    assert passed.min() > 0.6
