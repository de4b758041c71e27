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


def from_tables(networks: Sequence[Sequence[tuple[dict[str, np.ndarray], int]]]) -> Draw:
    """Batches for G NN3, each of several sorts of tables (`sampling`), so many rows of each sort.

    Inner vertices come in another random order each time, the table's columns with them: section 2.5.2 has no order.
    """
    kept = [
        [(torch.as_tensor(found["points"]), torch.as_tensor(found["table"]), count) for found, count in sorts]
        for sorts in networks
    ]

    def draw(generator: torch.Generator) -> tuple[torch.Tensor, torch.Tensor]:
        given, wanted = [], []
        for sorts in kept:
            rows = [torch.randint(len(points), (count,), generator=generator) for points, _, count in sorts]
            points = torch.cat([points[row] for (points, _, _), row in zip(sorts, rows, strict=True)])
            table = torch.cat([table[row] for (_, table, _), row in zip(sorts, rows, strict=True)]).float()
            points, table = shuffled(points, table, generator)
            given.append(points.flatten(1))
            wanted.append(table.flatten(1))
        return torch.stack(given), torch.stack(wanted)

    return draw


def shuffled(
    points: torch.Tensor, table: torch.Tensor, generator: torch.Generator
) -> tuple[torch.Tensor, torch.Tensor]:
    """Points (B, V, 2) with their inner vertices in random orders, and their tables (B, N_C, V)."""
    count, n_contour, n_points = table.shape
    inner = torch.rand((count, n_points - n_contour), generator=generator).argsort(dim=1) + n_contour
    order = torch.cat([torch.arange(n_contour).expand(count, -1), inner], dim=1)
    moved = points.gather(1, order[..., None].expand(-1, -1, 2))
    return moved, table.gather(2, order[:, None].expand(-1, n_contour, -1))


def mixed(random: dict[str, np.ndarray], *others: tuple[dict[str, np.ndarray], float]) -> list:
    """A NN3's sorts of tables for `from_tables`: shares of others, where there are any, the rest random."""
    counts = [round(share * BATCH) if len(found["points"]) else 0 for found, share in others]
    sorts = (random, BATCH - sum(counts)), *((found, count) for (found, _), count in zip(others, counts, strict=True))
    return [(found, count) for found, count in sorts if count]
