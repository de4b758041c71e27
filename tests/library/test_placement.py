"""Inner vertices are distinct and strictly inside, even where the cavity is thin or the network is wrong."""

import numpy as np
import pytest

from tessera import networks, placement
from tessera.cavity import distances_to_contour, even_lengths, is_inside
from tessera.stopwatch import Stopwatch

THIN = np.array([[[0, 0], [4, 0], [4, 0.05], [0, 0.05]]]) - [2, 0.025]
SQUARE = np.array([[[-1.0, -1], [1, -1], [1, 1], [-1, 1]]])


def place(contour, count):
    n = np.array([contour.shape[1]])
    return placement.place_inner_vertices(contour, n, np.array([count]), Stopwatch())


def assert_valid(contour, inner, count):
    n = np.array([contour.shape[1]])
    assert is_inside(inner, contour, n).all()
    gap = 0.05 * even_lengths(contour, n, np.array([count]))[0]
    assert distances_to_contour(inner, contour, n).min() > gap
    apart = np.linalg.norm(inner[0][:, None] - inner[0], axis=-1) + np.eye(count) * 9
    assert apart.min() > gap


@pytest.mark.parametrize("count", [1, 2, 5, 12, 24, 32])
def test_as_many_as_asked_for(count):
    inner, found = place(SQUARE, count)
    assert found[0] == count
    assert_valid(SQUARE, inner[:, :count], count)


def test_a_thin_cavity_holds_what_fits():
    inner, found = place(THIN, 3)
    if found[0]:
        assert_valid(THIN, inner[:, : found[0]], int(found[0]))


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
