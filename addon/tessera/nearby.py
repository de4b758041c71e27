"""Which of many boxes meet others: a balanced tree of boxes, which all questions go down together.

The boxes lie in groups that know nothing of each other. In each, they are in the order of a curve that fills the plane,
by the ranks of their middles, so that neighbours in the tree are near each other however uneven the boxes are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_LEAF = 4


@dataclass(frozen=True)
class Boxes:
    """order: (n,) the boxes' numbers along the curve, one group after the other; group: (n,) int, of each number.

    levels: of the nodes of each level, from the root, the lower and upper corners (k, 3), in x, y and group.
    """

    order: np.ndarray
    group: np.ndarray
    levels: tuple[tuple[np.ndarray, np.ndarray], ...]


def build_boxes(low: np.ndarray, high: np.ndarray, group: np.ndarray) -> Boxes:
    """A tree over at least one box, from `low` to `high` (n, 2), in groups (n,) int."""
    n = len(group)
    order = along_curve(0.5 * low + 0.5 * high, group)
    depth = max(0, int(np.ceil(np.log2(n / _LEAF))))
    # Padding repeats the last box.
    padded = order[np.minimum(np.arange(_LEAF << depth), n - 1)]
    low, high = np.column_stack([low, group])[padded], np.column_stack([high, group])[padded]
    levels = [(low, high), (low.reshape(-1, _LEAF, 3).min(axis=1), high.reshape(-1, _LEAF, 3).max(axis=1))]
    for _ in range(depth):
        low, high = levels[-1]
        levels.append((low.reshape(-1, 2, 3).min(axis=1), high.reshape(-1, 2, 3).max(axis=1)))
    return Boxes(order, group, tuple(levels[::-1]))


def meeting(boxes: Boxes, low: np.ndarray, high: np.ndarray, group: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of the boxes meet, or touch, those from `low` to `high` (q, 2) of groups (q,).

    Returns pairs, sorted: the question (k,), the box (k,).
    """
    asked = np.arange(len(group))
    node = np.zeros(len(group), dtype=np.int64)
    for level, (lowest, highest) in enumerate(boxes.levels):
        if level:
            children = _LEAF if level == len(boxes.levels) - 1 else 2
            asked, node = np.repeat(asked, children), (node[:, None] * children + np.arange(children)).ravel()
        meets = (lowest[node, 2] <= group[asked]) & (highest[node, 2] >= group[asked])
        for axis in (0, 1):
            meets &= (lowest[node, axis] <= high[asked, axis]) & (highest[node, axis] >= low[asked, axis])
        asked, node = asked[meets], node[meets]
    real = node < len(boxes.order)
    asked, found = asked[real], boxes.order[node[real]]
    order = np.lexsort((found, asked))
    return asked[order], found[order]


def along_curve(points: np.ndarray, group: np.ndarray) -> np.ndarray:
    """The order (n,) of points (n, 2) along a curve that fills the plane, one group (n,) after the other."""
    cell = np.zeros(len(points), dtype=np.uint64)
    count = np.bincount(group)
    first = np.cumsum(count) - count
    for axis in (0, 1):
        order = np.lexsort((points[:, axis], group))
        rank = np.arange(len(order)) - first[group[order]]
        bits = np.empty(len(order), dtype=np.uint64)
        bits[order] = (rank << 16) // count[group[order]]
        for shift, mask in ((8, 0x00FF00FF), (4, 0x0F0F0F0F), (2, 0x33333333), (1, 0x55555555)):
            bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
        cell |= bits << np.uint64(axis)
    return np.lexsort((cell, group))


def runs(first: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Runs of `count` (k,) numbers from `first` (k,): the run (n,) and the number (n,) of each, one after the other."""
    of = np.repeat(np.arange(len(count)), count)
    return of, first[of] + np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
