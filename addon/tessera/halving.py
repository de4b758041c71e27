"""Elements all of whose edges come to two segments: four elements at once, without asking the networks.

Between the corners of such an element and a vertex amid each of its edges there is room for no inner vertex, and four
connections have no flat element: the one that joins the vertices amid the edges, and those with one of its inner edges
flipped. The former is taken where it is Delaunay.
"""

from __future__ import annotations

import numpy as np


def find_halved(points: np.ndarray, cells: np.ndarray, first: int) -> np.ndarray:
    """(m,) which sub-contours (m, N), padded with -1, are such elements, and make four acute ones.

    points: (p, 2); first: from which those are counted that were inserted into edges.
    """
    six = np.flatnonzero((cells[:, 5] >= 0) & (cells[:, 6] < 0))
    six = six[((cells[six, :6] >= first) == [False, True] * 3).all(axis=1)]
    around = points[cells[six, :6]]
    acute = np.ones(len(six), dtype=bool)
    for k in range(6):
        # Corners see the vertices amid the edges beside them, and those the other two of them.
        step = 1 + k % 2
        u, v = around[:, (k + step) % 6] - around[:, k], around[:, k - step] - around[:, k]
        acute &= (u[:, 0] * v[:, 1] > u[:, 1] * v[:, 0]) & (u[:, 0] * v[:, 0] + u[:, 1] * v[:, 1] > 0)
    halved = np.zeros(len(cells), dtype=bool)
    halved[six[acute]] = True
    return halved


def four_elements(cells: np.ndarray) -> np.ndarray:
    """The elements (4 h, 3) of sub-contours (h, 6 or more) that `find_halved` found, four of each."""
    return cells[:, [[0, 1, 5], [1, 2, 3], [5, 3, 4], [1, 3, 5]]].reshape(-1, 3)
