"""Inner vertices that NN3 learns connections of (section 2.5.2, Fig. 14), and the tables of them (section 2.5.1)."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from tessera.cavity import distances_to_contour, is_inside
from tessera.paper_placement import grid_points

from .. import tables
from .data import Group, Population

GRID = 50  # points along the grid that vertices are drawn from (section 3.2.4; 2.5.2 names none)
APART = 0.1  # of l_s, to the contour and to each other


def admissible(contour: np.ndarray, margin: float, resolution: int = GRID) -> np.ndarray:
    """The grid points (k, 2) inside a contour (N_C, 2) and at least ``margin`` from it."""
    points, n = grid_points(resolution)[None], np.array([len(contour)])
    inside = is_inside(points, contour[None], n) & (distances_to_contour(points, contour[None], n) >= margin)
    return points[inside]


def groups_per_contour(n_inner: int) -> int:
    """How many random groups of inner vertices a contour has (section 3.2.3)."""
    return 50 if n_inner <= 4 else 100 if n_inner <= 8 else 200


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


def make_tables(rng: np.random.Generator, group: Group, n_inner: int) -> dict[str, np.ndarray]:
    """Of each mesh of a group the reference's vertices and random ones: points (K, V, 2) and q_worst (K, N_C, V).

    mesh: (K,) the row of the group; vertices that the reference does not have are given as NaN.
    """
    points, rows = [], []
    for row in range(len(group)):
        contour, inner = group.contour[row], group.inner[row : row + 1]
        places = admissible(contour, APART * group.l_s[row])
        drawn = random_groups(rng, places, n_inner, groups_per_contour(n_inner), APART * group.l_s[row])
        inner = np.concatenate([inner[np.isfinite(inner).all(axis=(1, 2))], drawn]) if n_inner else inner
        points.append(np.concatenate([np.repeat(contour[None], len(inner), axis=0), inner], axis=1))
        rows.append(np.full(len(inner), row))
    points, rows = np.concatenate(points), np.concatenate(rows)
    n_contour = group.contour.shape[1]
    table = tables.connection_tables(points, np.full(len(points), n_contour), np.full(len(points), n_inner))
    return {"points": points.astype(np.float32), "table": table[..., 0].astype(np.float16), "mesh": rows}


def learnt_group(population: Population, n_inner: int, most: int) -> Group:
    """The meshes that NN3 learns from: the population's group, filled up by contours of other groups.

    Those have NaN for inner vertices, so that only random ones are learnt from; a contour is there once where it can
    be. Without inner vertices the mesh does not matter, so every contour is of the group.
    """
    group = population.group(n_inner)
    if n_inner and len(group) >= most:
        return group.rows(np.random.default_rng(n_inner).permutation(len(group))[:most])
    index = np.arange(most if n_inner else 20 * most) % len(population.contour)
    missing = len(index) - len(group) if n_inner else len(index)
    rows, target = index[:missing], np.arange(missing) % len(population.targets)
    nothing = np.full((missing, n_inner, 2), np.nan)
    other = Group(population.contour[rows], population.targets[target], nothing, population.quality[rows, target])
    if not n_inner:
        return other
    return Group(*(np.concatenate([getattr(g, name) for g in (group, other)]) for name in Group.__dataclass_fields__))


def kept_tables(file: Path, make: callable) -> dict[str, np.ndarray]:
    """The arrays of a file, which is made first where it is not there."""
    if not file.exists():
        unfinished = file.with_suffix(f".{os.getpid()}.part")
        with open(unfinished, "wb") as stream:
            np.savez(stream, **make())
        unfinished.rename(file)
    with np.load(file) as kept:
        return dict(kept)
