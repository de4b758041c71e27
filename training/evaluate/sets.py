"""The sets of test contours: the paper's sector contours, those that refinement makes, and those of real curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import contours


@dataclass(frozen=True)
class Contours:
    """Transformed contours, padded."""

    points: np.ndarray  # (B, 16, 2) float64, counter-clockwise
    n_contour: np.ndarray  # (B,) int64, 3 to 16
    l_s: np.ndarray  # (B,) float64, scaled target edge lengths

    def __len__(self) -> int:
        return len(self.n_contour)

    def rows(self, index: slice | np.ndarray) -> Contours:
        """Some of them."""
        return Contours(self.points[index], self.n_contour[index], self.l_s[index])


def held_out(count: int, seed: int | tuple[int, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transformed sector contours, N_C 4 to 16 in turn, l_s 0.3 to 1: points (n, 16, 2), n_contour (n,), l_s (n,)."""
    rng = np.random.default_rng(seed)
    points, n_contour = np.zeros((count, 16, 2)), 4 + np.arange(count) % 13
    for row, n in enumerate(n_contour):
        points[row, :n] = contours.transformed_sector(rng, int(n))
    return points, n_contour, rng.uniform(0.3, 1, count)


def sector(count: int, seed: tuple[int, ...]) -> Contours:
    """`held_out`, as the evaluation takes it."""
    return Contours(*held_out(count, seed))
