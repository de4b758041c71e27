"""The grid over each cavity that NN2 scores (paper, section 2.4), and which of its points may become inner vertices.

Everything here is in grid units, the origin in the middle of a contour's bounding box, so that the grid itself is the
same for all contours of a resolution. In single precision: the margin that candidates keep is far above its rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cavity import next_vertices

# Numbers held at a time, so that the temporaries stay in the processor's cache.
_BLOCK_SIZE = 1 << 17
# Where padded vertices are put, in grid units.
_FAR = 1e4


@dataclass(frozen=True)
class Grids:
    """Grids of R² points over B contours, row by row from below, and which points are admissible."""

    resolution: int
    middle: np.ndarray  # (B, 2) float64, in the contours' plane
    spacing: np.ndarray  # (B,) float64
    admissible: np.ndarray  # (B, R²) bool

    def places(self, points: np.ndarray) -> np.ndarray:
        """Take points (B, 2, M) in grid units to the contours' plane."""
        return self.middle[..., None] + points * self.spacing[:, None, None]


def bounding_boxes(contour: np.ndarray, n_contour: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest coordinates (B, 2) of contours (B, N, 2)."""
    real = (np.arange(contour.shape[1]) < n_contour[:, None])[..., None]
    return np.where(real, contour, np.inf).min(axis=1), np.where(real, contour, -np.inf).max(axis=1)


def steps(resolution: int) -> np.ndarray:
    """Coordinates (R,) float32 of the grid's columns, and of its rows, in grid units."""
    return (np.arange(resolution) - (resolution - 1) / 2).astype(np.float32)


def make_grids(contour: np.ndarray, n_contour: np.ndarray, margin: np.ndarray, resolution: int) -> Grids:
    """Square grids over the bounding boxes; points inside and farther than the margin from the contour are admissible.

    contour: (B, N, 2) float64; margin: (B,), in the contour's plane.
    """
    low, high = bounding_boxes(contour, n_contour)
    middle, spacing = (low + high) / 2, (high - low).max(axis=1) / resolution
    start = ((contour - middle[:, None]) / spacing[:, None, None]).astype(np.float32)
    end = next_vertices(start, n_contour)
    padding = np.arange(contour.shape[1]) >= n_contour[:, None]
    start[padding] = end[padding] = _FAR
    # Contours are the last axis, as operations on long rows are fast.
    start, end = np.ascontiguousarray(start.T), np.ascontiguousarray(end.T)
    closest = (margin / spacing).astype(np.float32) ** 2
    admissible = np.empty((resolution, resolution, len(contour)), dtype=bool)
    step = max(1, _BLOCK_SIZE // (contour.shape[1] * resolution**2))
    for first in range(0, len(contour), step):
        rows = slice(first, first + step)
        away = _squared_distances(start[..., rows], end[..., rows], resolution)
        inside = _is_inside(start[..., rows], end[..., rows], resolution)
        np.logical_and(inside, away > closest[rows], out=admissible[..., rows])
    return Grids(resolution, middle, spacing, np.ascontiguousarray(admissible.reshape(resolution**2, -1).T))


def _squared_distances(start: np.ndarray, end: np.ndarray, resolution: int) -> np.ndarray:
    """(R, R, B) squared distances of grid points to the closest of the edges from start to end (2, N, B).

    Element by element: a product of matrices may round differently from one size of batch to another. What depends on
    a point's column alone, or on its row, is (N, R, B), and added where it is wanted.
    """
    (edge_x, edge_y), grid = end - start, steps(resolution)[:, None]
    length = np.sqrt(edge_x * edge_x + edge_y * edge_y)
    shortest = np.maximum(length, np.float32(1e-30))
    away, rise = grid - start[:, :, None]
    along = (away * (edge_x / shortest)[:, None])[:, None] + (rise * (edge_y / shortest)[:, None])[:, :, None]
    foot = np.maximum(along, np.float32(0))
    np.minimum(foot, length[:, None, None], out=foot)
    # |point - start|² + foot (foot - 2 along)
    along *= np.float32(-2)
    along += foot
    along *= foot
    along += (away * away)[:, None]
    along += (rise * rise)[:, :, None]
    return along.min(axis=0)


def _is_inside(start: np.ndarray, end: np.ndarray, resolution: int) -> np.ndarray:
    """(R, R, B) whether grid points are inside, by the even-odd rule; a row of the grid is a word, a point a bit."""
    rows, (x, y), (end_x, end_y) = steps(resolution)[:, None], start[:, :, None], end[:, :, None]
    # Both edges at a vertex compare the same number, so that a row through it passes one of them or both or none.
    straddles = (rows < y) != (rows < end_y)  # (N, R, B)
    up = end_y - y
    crossing = x + (rows - y) * ((end_x - x) / np.where(up == 0, np.float32(1), up))
    # Points of the row that are left of the crossing: the lowest bits.
    left = np.clip(np.ceil(crossing + np.float32((resolution - 1) / 2)), 0, resolution).astype(np.uint64)
    words = np.where(straddles, (np.uint64(1) << left) - np.uint64(1), np.uint64(0))
    parity = np.bitwise_xor.reduce(words, axis=0)
    return (parity[:, None] & (np.uint64(1) << np.arange(resolution, dtype=np.uint64))[:, None]) != 0
