"""Points in the same place made one. Arrays in, arrays out: no `bpy` here."""

from itertools import product

import numpy as np


def same_place(points: np.ndarray, tolerance: float) -> np.ndarray:
    """For each point (n, d), the lowest index among those in its place: (n,) int64.

    Points whose coordinates differ by no more than the tolerance are in the same place (with some that differ by up to
    four times that), and so are those in the places of these.
    """
    label = np.arange(len(points))
    cells = points / (4 * tolerance)
    # Two points that close share a cell of one of these grids at least, whatever side of a cell's border they are on.
    groups = [_numbers(np.floor(cells + shift)) for shift in product((0.0, 0.5), repeat=points.shape[1])]
    while True:
        before = label
        for group in groups:
            lowest = np.full(group.max(initial=-1) + 1, len(points))
            np.minimum.at(lowest, group, label)
            label = lowest[group]
        if (label == before).all():
            return label


def _numbers(rows: np.ndarray) -> np.ndarray:
    """Equal rows (n, d) get equal numbers (n,), from 0."""
    order = np.lexsort(rows.T)
    new = np.ones(len(rows), dtype=bool)
    new[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    numbers = np.empty(len(rows), dtype=np.int64)
    numbers[order] = np.cumsum(new) - 1
    return numbers


def weld(triangles: np.ndarray, label: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vertices (n,) that stay when those of one label (n,) are made one, and the triangles (m, 3) on these."""
    kept, number = np.unique(label, return_inverse=True)
    return kept, number[triangles].astype(np.int32)


def border_edges(triangles: np.ndarray) -> np.ndarray:
    """The directed sides (k, 2) of triangles (m, 3) that no other triangle shares."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    low, high = sides.min(axis=1), sides.max(axis=1)
    _, first, count = np.unique(low * (high.max(initial=0) + 1) + high, return_index=True, return_counts=True)
    return sides[first[count == 1]]
