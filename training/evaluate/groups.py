"""Means of contours' errors by group: number of edges, and number of inner vertices or target edge length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Groups:
    """The cells of a table of R rows and C columns."""

    rows: np.ndarray  # (R,) keys, ascending
    columns: np.ndarray  # (C,)
    count: np.ndarray  # (R, C) int64 contours
    mean: np.ndarray  # (R, C) float64, NaN where there is none
    spread: np.ndarray  # (R, C) float64, standard error of the mean, NaN of fewer than two

    def cell(self, row: float, column: float) -> tuple[int, float]:
        """Contours and mean of one cell, (0, NaN) where there is none."""
        i, j = np.flatnonzero(self.rows == row), np.flatnonzero(self.columns == column)
        if not (len(i) and len(j)):
            return 0, np.nan
        return int(self.count[i[0], j[0]]), float(self.mean[i[0], j[0]])

    def without(self, column: float) -> Groups:
        """The same without a column."""
        kept = self.columns != column
        return Groups(self.rows, self.columns[kept], *(a[:, kept] for a in (self.count, self.mean, self.spread)))

    def worst(self, at_least: int) -> tuple[float, float, float, float] | None:
        """Row, column, mean and spread of the largest mean among cells of so many contours; None if there are none."""
        means = np.where(self.count >= at_least, self.mean, -np.inf)
        if not (means > -np.inf).any():
            return None
        i, j = np.unravel_index(np.argmax(means), means.shape)
        return float(self.rows[i]), float(self.columns[j]), float(self.mean[i, j]), float(self.spread[i, j])


def group(row: np.ndarray, column: np.ndarray, value: np.ndarray) -> Groups:
    """Groups of contours by their keys (B,) and (B,), those whose value (B,) or key is NaN left out."""
    known = np.isfinite(value) & np.isfinite(row) & np.isfinite(column)
    row, column, value = row[known], column[known], value[known]
    rows, i = np.unique(row, return_inverse=True)
    columns, j = np.unique(column, return_inverse=True)
    shape = len(rows), len(columns)
    count, total, squares = (
        np.bincount(i * shape[1] + j, weights, minlength=shape[0] * shape[1]).reshape(shape)
        for weights in (None, value, value**2)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / count
        variance = np.maximum(squares - count * mean**2, 0) / (count - 1)
        spread = np.where(count > 1, np.sqrt(variance / count), np.nan)
    return Groups(rows, columns, count, mean, spread)


def mean_and_spread(value: np.ndarray) -> tuple[float, float]:
    """Mean of the values that are no NaN, and its standard error."""
    value = value[np.isfinite(value)]
    if len(value) < 2:
        return np.nan, np.nan
    return float(value.mean()), float(value.std(ddof=1) / np.sqrt(len(value)))
