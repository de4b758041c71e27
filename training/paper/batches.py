"""What each network is asked and what it should answer, as rows of numbers (see `networks`), and batches of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from tessera.paper_placement import grid_points, patches

from .data import Group, Population
from .fitting import BATCH, Draw


def count_rows(population: Population) -> tuple[np.ndarray, np.ndarray]:
    """NN1's rows (n T, 2 N_C + 1) and N_I (n T, 1): every contour at every target edge length."""
    n, targets = population.n_inner.shape
    contour = np.repeat(population.contour.reshape(n, -1), targets, axis=0)
    given = np.concatenate([contour, np.tile(population.targets, n)[:, None]], axis=1)
    return given.astype(np.float32), population.n_inner.reshape(-1, 1).astype(np.float32)


def scores(group: Group, resolution: int) -> np.ndarray:
    """(k, R²) distance of each grid point to the closest of the group's inner vertices."""
    points = grid_points(resolution).astype(np.float32)
    closest = np.full((len(group), len(points)), np.inf, dtype=np.float32)
    for vertex in np.moveaxis(group.inner.astype(np.float32), 1, 0):
        closest = np.minimum(closest, ((points - vertex[:, None]) ** 2).sum(axis=-1))
    return np.sqrt(closest)


def from_rows(rows: Sequence[tuple[np.ndarray, np.ndarray]]) -> Draw:
    """Batches for G networks, each of its own rows: inputs (n, i) and answers (n, o)."""
    kept = [(torch.as_tensor(given), torch.as_tensor(wanted)) for given, wanted in rows]

    def draw(generator: torch.Generator) -> tuple[torch.Tensor, torch.Tensor]:
        chosen = [torch.randint(len(given), (BATCH,), generator=generator) for given, _ in kept]
        return tuple(
            torch.stack([part[side][index] for part, index in zip(kept, chosen, strict=True)]).float()
            for side in range(2)
        )

    return draw


def from_groups(groups: Sequence[Group], resolutions: Sequence[int]) -> Draw:
    """Batches for G NN2, each of its own group and grid: a mesh and a patch at random."""
    kept = []
    for group, resolution in zip(groups, resolutions, strict=True):
        number = patches(resolution)
        given = np.concatenate([group.contour.reshape(len(group), -1), group.l_s[:, None]], axis=1)
        places = grid_points(resolution)[number].reshape(len(number), -1)
        wanted = scores(group, resolution)[:, number]
        kept.append([torch.as_tensor(array.astype(np.float32)) for array in (given, places, wanted)])

    def draw(generator: torch.Generator) -> tuple[torch.Tensor, torch.Tensor]:
        given, wanted = [], []
        for contour, places, score in kept:
            mesh = torch.randint(len(contour), (BATCH,), generator=generator)
            patch = torch.randint(len(places), (BATCH,), generator=generator)
            given.append(torch.cat([contour[mesh], places[patch]], dim=1))
            wanted.append(score[mesh, patch])
        return torch.stack(given), torch.stack(wanted)

    return draw


def table_rows(found: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """NN3's rows of points (K, V, 2), and their tables (K, N_C, V), flattened."""
    count = len(found["points"])
    return found["points"].reshape(count, -1), found["table"].reshape(count, -1)
