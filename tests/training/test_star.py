"""NN2 of a star, as it ships: near the best place, turned and scaled with the ring, the same with any padding."""

import numpy as np
import pytest
import torch

from tessera.networks import centre_stars
from training.star import energy, rings

SEED = 991


def wrapped(ring: np.ndarray, size: int = 8) -> np.ndarray:
    padding = np.repeat(ring[:, :1], size + 1 - ring.shape[1], axis=1)
    return np.concatenate([ring[:, -1:], ring, padding], axis=1)


def places(ring: np.ndarray, size: int = 8) -> np.ndarray:
    return centre_stars(wrapped(ring, size).T, np.full(len(ring), ring.shape[1])).T


@pytest.mark.parametrize("n", [4, 5, 6, 7])
def test_it_is_closer_to_the_best_place_than_to_the_mean(n):
    ring = torch.tensor(rings(np.random.default_rng(SEED + n), 300, n), dtype=torch.float64)
    found = torch.tensor(places(ring.numpy()))
    best = found.clone().requires_grad_(True)
    optimiser = torch.optim.Adam([best], lr=0.01)
    for _ in range(200):
        optimiser.zero_grad()
        energy(ring, best).sum().backward()
        optimiser.step()
    least, own, mean = (float(energy(ring, p).mean()) for p in (best.detach(), found, ring.mean(1)))
    assert own - least < 0.25 * (mean - least) and own - least < 0.02 * least


@pytest.mark.parametrize("n", [3, 5, 6, 8])
def test_the_middle_of_a_regular_polygon_is_its_centre(n):
    turn = 2 * np.pi * np.arange(n) / n
    np.testing.assert_allclose(places(np.column_stack([np.cos(turn), np.sin(turn)])[None]), 0, atol=1e-5)


def test_places_turn_grow_and_move_with_the_ring():
    ring = rings(np.random.default_rng(SEED), 50, 6).astype(np.float64)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    np.testing.assert_allclose(places(0.5 * ring @ turn.T + 0.1), 0.5 * places(ring) @ turn.T + 0.1, atol=1e-5)


def test_padding_and_company_change_nothing():
    ring = rings(np.random.default_rng(SEED), 40, 6)
    together = places(ring)
    alone = np.concatenate([places(ring[row : row + 1]) for row in range(len(ring))])
    np.testing.assert_array_equal(alone, together)
    np.testing.assert_allclose(places(ring, 16), together, atol=1e-5)
