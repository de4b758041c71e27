"""Which of many boxes may meet another one, where more are added all the time."""

from __future__ import annotations

import numpy as np

# Cells are so many times as wide as the boxes are on average; a box over more cells than that is kept apart.
_WIDTH = 4.0
_MOST_CELLS = 16


class Boxes:
    """Boxes from `low` to `high` (n, 2), numbered as they come, by the square cells of the plane that they touch.

    extent: the longer side of the box around the first of them.
    """

    def __init__(self, low: np.ndarray, high: np.ndarray) -> None:
        self.extent = float((high.max(axis=0) - low.min(axis=0)).max())
        self._origin = low.min(axis=0)
        self._width = _WIDTH * float((high - low).max(axis=1).mean())
        self._cells: dict[tuple[int, int], list[int]] = {}
        self._large: list[int] = []
        self._count = 0
        self.add(low, high)

    def add(self, low: np.ndarray, high: np.ndarray) -> None:
        """Some boxes more."""
        for left, lower, right, upper in np.concatenate([self._cell(low), self._cell(high)], axis=1).tolist():
            if (right - left + 1) * (upper - lower + 1) > _MOST_CELLS:
                self._large.append(self._count)
            else:
                for x in range(left, right + 1):
                    for y in range(lower, upper + 1):
                        self._cells.setdefault((x, y), []).append(self._count)
            self._count += 1

    def around(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Numbers (k,), in order, of boxes among which are all that meet the one from `low` to `high` (2,)."""
        (left, lower), (right, upper) = self._cell(np.stack([low, high])).tolist()
        if (right - left + 1) * (upper - lower + 1) > len(self._cells):
            return np.arange(self._count)
        found = set(self._large)
        for x in range(left, right + 1):
            for y in range(lower, upper + 1):
                found.update(self._cells.get((x, y), ()))
        return np.array(sorted(found), dtype=np.int64)

    def _cell(self, place: np.ndarray) -> np.ndarray:
        return np.floor((place - self._origin) / self._width).astype(np.int64)
