"""Inner vertices that NN3 learns connections of (section 2.5.2, Fig. 14), and the tables of them (section 2.5.1)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from tessera.cavity import signed_distances
from tessera.paper_placement import grid_points

from .. import tables
from .data import Group, Population

GRID = 50  # points along the grid that vertices are drawn from (section 3.2.4; 2.5.2 names none)
APART = 0.1  # of l_s, to the contour and to each other


def admissible(contour: np.ndarray, margin: float, resolution: int = GRID) -> np.ndarray:
    """The grid points (k, 2) inside a contour (N_C, 2) and at least ``margin`` from it."""
    points, n = grid_points(resolution)[None], np.array([len(contour)])
    return points[signed_distances(points, contour[None], n) >= margin]


def groups_per_contour(n_inner: int) -> int:
    """How many random groups of inner vertices a contour has (section 3.2.3); without inner vertices one row."""
    return 50 if 0 < n_inner <= 4 else 100 if 4 < n_inner <= 8 else 200 if n_inner else 1


def random_groups(rng: np.random.Generator, places: np.ndarray, n_inner: int, count: int, apart: float) -> np.ndarray:
    """Groups (count, N_I, 2) of grid points (k, 2), those of a group at least ``apart`` from each other.

    Fewer than ``count``, or none, where there are too few points to draw from.
    """
    found = np.zeros((0, n_inner, 2))
    for _ in range(20):
        if len(found) >= count or len(places) < n_inner:
            break
        drawn = places[rng.integers(0, len(places), (2 * count, n_inner))]
        away = np.linalg.norm(drawn[:, :, None] - drawn[:, None], axis=-1) + 10 * np.eye(n_inner)
        found = np.concatenate([found, drawn[(away >= apart).all(axis=(1, 2))]])
    return found[:count]


def random_tables(rng: np.random.Generator, contours: np.ndarray, l_s: np.ndarray, n_inner: int) -> dict:
    """Random inner vertices in contours (k, N_C, 2) meshed at l_s (k,).

    points (K, V, 2), their q_worst (K, N_C, V), and the contours' numbers (K,) as "mesh".
    """
    points, rows = [], []
    for row, (contour, apart) in enumerate(zip(contours, APART * l_s, strict=True)):
        drawn = random_groups(rng, admissible(contour, apart), n_inner, groups_per_contour(n_inner), apart)
        points.append(np.concatenate([np.repeat(contour[None], len(drawn), axis=0), drawn], axis=1))
        rows.append(np.full(len(drawn), row))
    return {**_tables(np.concatenate(points), n_inner), "mesh": np.concatenate(rows)}


def reference_tables(group: Group) -> dict[str, np.ndarray]:
    """As `random_tables`, of the reference's own vertices: one row for each mesh of a group."""
    points = np.concatenate([group.contour, group.inner], axis=1)
    return {**_tables(points, group.inner.shape[1]), "mesh": np.arange(len(group))}


def _tables(points: np.ndarray, n_inner: int) -> dict[str, np.ndarray]:
    count, n_contour = len(points), points.shape[1] - n_inner
    table = np.zeros((0, n_contour, points.shape[1], 2))
    if count:
        table = tables.connection_tables(points, np.full(count, n_contour), np.full(count, n_inner))
    return {"points": points.astype(np.float32), "table": table[..., 0].astype(np.float16)}


def drawn_in(population: Population, n_inner: int, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Contours and targets that random vertices are drawn in: the group's, filled up by those of other groups.

    A contour is there once where it can be. Without inner vertices the target does not matter, and there are 20 times
    as many contours.
    """
    group = population.group(n_inner)
    if not n_inner:
        group, most = group.rows(slice(0)), 20 * most
    group = group.rows(np.random.default_rng(n_inner).permutation(len(group))[:most])
    other = np.arange(most - len(group))
    contours = population.contour[other % len(population.contour)]
    targets = population.targets[other % len(population.targets)]
    return np.concatenate([group.contour, contours]), np.concatenate([group.l_s, targets])


def kept_tables(file: Path, make: callable) -> dict[str, np.ndarray]:
    """The arrays of a file, which is made first where it is not there."""
    if not file.exists():
        unfinished = file.with_suffix(f".{os.getpid()}.part")
        with open(unfinished, "wb") as stream:
            np.savez(stream, **make())
        unfinished.rename(file)
    with np.load(file) as kept:
        return dict(kept)
