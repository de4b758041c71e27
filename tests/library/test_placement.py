"""Inner vertices are distinct and strictly inside, even where the cavity is thin or the network is wrong."""

import numpy as np
import pytest

from tessera import networks, placement
from tessera.cavity import even_lengths, signed_distances
from tessera.stopwatch import Stopwatch

THIN = np.array([[[0, 0], [4, 0], [4, 0.05], [0, 0.05]]]) - [2, 0.025]
SQUARE = np.array([[[-1.0, -1], [1, -1], [1, 1], [-1, 1]]])


def place(contour, count):
    n = np.array([contour.shape[1]])
    return placement.place_inner_vertices(contour, n, np.array([count]), Stopwatch())


def assert_valid(contour, inner, count):
    n = np.array([contour.shape[1]])
    if not count:
        return
    gap = 0.05 * even_lengths(contour, n, np.array([count]))[0]
    assert signed_distances(inner, contour, n).min() > gap
    apart = np.linalg.norm(inner[0][:, None] - inner[0], axis=-1) + np.eye(count) * 9
    assert apart.min() > gap


@pytest.mark.parametrize("count", [1, 2, 5, 12, 24, 32])
def test_as_many_as_asked_for(count):
    inner, found = place(SQUARE, count)
    assert found[0] == count
    assert_valid(SQUARE, inner[:, :count], count)


@pytest.mark.parametrize(("height", "fitting"), [(1, 0), (10, 3)])
def test_a_thin_cavity_holds_what_fits(height, fitting):
    cavity = THIN * [1, height]
    inner, found = place(cavity, 3)
    assert found[0] == fitting
    assert_valid(cavity, inner[:, : found[0]], int(found[0]))


def test_none_asked_for():
    inner, found = place(SQUARE, 0)
    assert inner.shape == (1, 0, 2) and found[0] == 0


@pytest.mark.parametrize("wrong", [np.nan, 100.0, 0.0])
def test_a_network_that_sends_vertices_astray_moves_none(wrong, monkeypatch):
    def astray(contour, n_contour, inner, n_inner):
        return np.full_like(inner, wrong)

    monkeypatch.setattr(networks, "move_inner_vertices", astray)
    inner, found = place(SQUARE, 6)
    assert found[0] == 6
    assert_valid(SQUARE, inner, 6)


def test_passes_that_are_asked_twice_see_what_they_gave(monkeypatch):
    given, move = [], networks.move_inner_vertices
    monkeypatch.setattr(networks, "move_inner_vertices", lambda *call: given.append(call) or move(*call))
    n = np.array([4])
    inner, found = placement.place_inner_vertices(SQUARE, n, np.array([6]), Stopwatch(), times=2)
    assert len(given) == 2 and found[0] == 6
    np.testing.assert_array_equal(given[1][2], move(*given[0]))
    assert_valid(SQUARE, inner, 6)


@pytest.mark.parametrize("count", [2, 5, 12, 32])
def test_scores_cannot_draw_vertices_across_a_notch(count, monkeypatch):
    """Scores that fall towards the tip of a notch, between the grid's points, and a network that moves nothing."""
    even = even_lengths(SQUARE, np.array([4]), np.array([count]))
    for tip in np.linspace(0.05, 0.5, 10):
        notched = np.array([[(-1, -1), (1, -1), (1, 0.98), (tip, tip), (0.98, 1), (-1, 1)]])

        def towards_the_tip(contour, n_contour, n_inner, grid, n_grid, tip=tip):
            away = np.hypot(*(grid - tip).swapaxes(0, 1))
            scores = np.where(away < 0.8 * even, away - 9, 0).astype(np.float32)
            return np.where(np.arange(grid.shape[2]) < n_grid[:, None], scores, np.inf)

        monkeypatch.setattr(networks, "score_grid", towards_the_tip)
        monkeypatch.setattr(networks, "move_inner_vertices", lambda contour, n_contour, inner, n_inner: inner)
        inner, found = place(notched, count)
        assert_valid(notched, inner[:, : found[0]], int(found[0]))


def test_points_are_refined_to_where_the_scores_are_lowest():
    """On parabolas of known lowest points: inside the grid along both axes; not beside what is unknown, nor far."""
    resolution = 6
    row, column = (of.ravel() for of in np.mgrid[:resolution, :resolution])
    lowest = np.array([[2.3, 3.8], [1.1, 2.6]])  # row and column, of two contours
    scores = ((row - lowest[:, :1]) ** 2 + 2 * (column - lowest[:, 1:]) ** 2).astype(np.float32)
    hole = 3 * resolution + 1
    scores[1, hole] = np.inf
    rows, columns = np.tile(row, (2, 1)), np.tile(column, (2, 1))
    offsets = placement._refinement(scores, rows, columns, resolution)
    for number in (0, 1):
        known = np.isfinite(scores[number]).reshape(resolution, resolution)
        for axis, place in ((0, column), (1, row)):
            wanted = np.clip(lowest[number, 1 - axis] - place, -0.5, 0.5)
            between = (place > 0) & (place < resolution - 1)
            beside = np.pad(known, 1)  # unknown all around
            shifts = (beside[1:-1, :-2] & beside[1:-1, 2:], beside[:-2, 1:-1] & beside[2:, 1:-1])
            sees = shifts[axis].ravel() & known.ravel()
            assert (sees <= between).all()
            np.testing.assert_allclose(offsets[number, axis], np.where(sees, wanted, 0), atol=1e-5)
