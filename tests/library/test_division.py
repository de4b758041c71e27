import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tessera.boundary import resample
from tessera.chords import choose_chords
from tessera.contour import clean_loop
from tessera.diagonals import any_diagonal, balanced_diagonal
from tessera.division import Division, Polygons, divide
from tessera.spacing import graded_spacing
from tests.library.polygons import (
    LETTER_E,
    LETTER_M,
    circle,
    comb,
    letter_s,
    needle,
    placed,
    placements,
    seeds,
    simple_polygons,
    spiral,
    star,
)
from tests.validity import polygon_area, polygon_is_simple, side


def divided(loops, edge_length) -> Division:
    size = np.array([len(loop) for loop in loops])
    return divide(np.concatenate(loops), Polygons(np.arange(size.sum()), size, np.arange(len(loops))), edge_length)


def check_division(division, loops) -> None:
    """Simple counter-clockwise cells, whose edges pair up but for the polygons' own: they cover each polygon once."""
    n_edges = (division.cells >= 0).sum(axis=1)
    assert n_edges.min() >= 3 and n_edges.max() <= 16
    directed = set()
    for cell, n in zip(division.cells, n_edges, strict=True):
        assert (cell[n:] == -1).all()
        corners = division.points[cell[:n]]
        assert polygon_is_simple(corners)
        first = np.lexsort(corners.T[::-1])[0]
        assert side(corners[first - 1], corners[first], corners[(first + 1) % n]) > 0, "clockwise cell"
        edges = list(zip(cell[:n].tolist(), np.roll(cell[:n], -1).tolist(), strict=True))
        assert not directed & set(edges)
        directed |= set(edges)
    size = [len(loop) for loop in loops]
    expected = {(b + i, b + (i + 1) % n) for b, n in zip(np.cumsum(size) - size, size, strict=True) for i in range(n)}
    assert {(a, b) for a, b in directed if (b, a) not in directed} == expected
    assert np.array_equal(division.points[: sum(size)], np.concatenate(loops))
    area, of = np.zeros(len(loops)), np.full(len(division.points), -1)
    of[division.cells] = division.owner[:, None]
    for cell, n, owner in zip(division.cells, n_edges, division.owner, strict=True):
        area[owner] += polygon_area(division.points[cell[:n]])
        assert (of[cell[:n]] == owner).all()
    assert area == pytest.approx([polygon_area(loop) for loop in loops], rel=1e-6)
    assert len(np.unique(division.cells[division.cells >= 0])) == len(division.points)


@given(simple_polygons, st.sampled_from([0.9, 0.3, 0.1]), placements)
@settings(deadline=None, max_examples=60)
def test_divides_resampled_polygons(polygon, edge_length, placement):
    loop = resample(placed(polygon, placement), edge_length * placement[0])
    if len(loop) < 1000:
        check_division(divided([loop], edge_length * placement[0]), [loop])


@given(simple_polygons, st.sampled_from([3.0, 0.2, 0.01]), placements)
@settings(deadline=None, max_examples=60)
def test_divides_kept_polygons_of_any_spacing(polygon, edge_length, placement):
    loop = clean_loop(placed(polygon, placement))
    check_division(divided([loop], edge_length * placement[0]), [loop])


@given(seeds, st.integers(4, 60))
@settings(deadline=None, max_examples=60)
def test_the_last_resort_finds_a_diagonal(seed, n):
    rng = np.random.default_rng(seed)
    for polygon in (
        spiral(n + 40),
        comb(n),
        needle(n, 1e-9),
        star(n) * rng.normal(size=2),
        np.roll(letter_s(), n, axis=0),
    ):
        polygon = clean_loop(polygon)
        for diagonal in (any_diagonal, balanced_diagonal):
            a, b = sorted(diagonal(polygon))
            assert 2 <= b - a <= len(polygon) - 2
            parts = polygon[a : b + 1], np.concatenate([polygon[b:], polygon[: a + 1]])
            assert all(polygon_is_simple(p) and polygon_area(p) > -1e-12 for p in parts)


@pytest.mark.parametrize("hair", [[[0, 0], [1, 0], [0.5, 1e-9]], [[0, 0], [1, 0], [1, 1e-11], [0, 1e-11]]])
def test_a_hair_is_cut_in_the_middle_too(hair):
    loop = resample(np.array(hair), 1e-3)
    chord = choose_chords(loop[None], np.array([len(loop)]), np.array([1e-3]))
    behind = int(chord.end[0] - chord.start[0])
    assert 0.2 * len(loop) < behind < 0.8 * len(loop)


def test_batches_do_not_matter():
    loops = [resample(p, 0.2) for p in (circle(100), LETTER_E, spiral(80), star(5), LETTER_M)]
    together = divided(loops, 0.2)
    check_division(together, loops)
    for i, loop in enumerate(loops):
        alone = divided([loop], 0.2)
        cells = together.cells[together.owner == i]
        mine = np.isin(np.arange(len(together.points)), cells)
        number = np.cumsum(mine) - 1
        assert np.array_equal(together.points[mine], alone.points)
        assert np.array_equal(np.where(cells >= 0, number[cells], -1), alone.cells)


@pytest.mark.parametrize(
    "polygon", [circle(300), LETTER_E / 3, LETTER_M / 3, letter_s() / 1.5], ids=["o", "E", "M", "S"]
)
def test_cells_are_fat_with_few_of_them(polygon):
    division = divided([resample(polygon, 0.1)], 0.1)
    n_edges = (division.cells >= 0).sum(axis=1)
    assert n_edges.mean() > 11
    fatness = []
    for cell, n in zip(division.cells, n_edges, strict=True):
        corners = division.points[cell[:n]]
        perimeter = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).sum()
        fatness.append(4 * np.pi * polygon_area(corners) / perimeter**2)
    assert np.mean(fatness) > 0.6 and min(fatness) > 0.25
    edges = np.linalg.norm(np.diff(division.points[division.cells[:, :3]], axis=1), axis=2)
    assert edges.min() > 0.05 and edges.max() < 0.2


def test_a_polygon_of_few_edges_is_its_own_cell():
    triangle = np.array([[0, 0], [1, 0], [0, 1]], dtype=float)
    division = divided([triangle, circle(16)], 0.01)
    assert (division.cells >= 0).sum(axis=1).tolist() == [3, 16]
    assert len(division.points) == 19


def test_spacing_goes_from_the_ends_to_the_target():
    position = np.linspace(0, 100, 5)
    assert graded_spacing(position, 100, 1, 1, 1) == pytest.approx(np.ones(5))
    assert graded_spacing(position, 100, 20, 0.5, 2)[[0, 2, 4]] == pytest.approx([20, 5, 0.5])
