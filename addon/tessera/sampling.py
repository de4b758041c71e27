"""Places all over a domain, at which a sizing function is looked at: the leaves of a quadtree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .contour import edges_of

_ROOTS = 64  # cells along the longer side of the domain's box, before any is split
_MOST_LEVELS = 24
_AROUND = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)]


@dataclass(frozen=True)
class Samples:
    """n square cells that cover a domain, each with a place in the domain: its centre, if that is inside.

    corner: (n, 2) int64, the cell's among those of its level; level: (n,); size: (n,) length of a side; inside: (n,)
    bool, whether the centre is inside; points: (n, 2); values: (n,), the function there. piece_start, piece_end: (k, 2)
    pieces of the boundary, each in the cell piece_cell (k,).
    """

    corner: np.ndarray
    level: np.ndarray
    size: np.ndarray
    inside: np.ndarray
    points: np.ndarray
    values: np.ndarray
    piece_start: np.ndarray
    piece_end: np.ndarray
    piece_cell: np.ndarray

    def boundary(self) -> np.ndarray:
        """(n,) length of the boundary in each cell."""
        length = np.linalg.norm(self.piece_end - self.piece_start, axis=1)
        return np.bincount(self.piece_cell, length, minlength=len(self.level))


def sample_domain(
    loops: list[np.ndarray],
    function: Callable[[np.ndarray], np.ndarray],
    too_large: Callable[[Samples], np.ndarray],
) -> Samples:
    """Split cells until none is too large.

    loops: (k, 2), which bound the domain by the even-odd rule; function: (n, 2) points -> (n,); too_large: samples ->
    (n,) bool; it may raise where there are too many.
    """
    outline = edges_of(loops)
    low, extent = outline[0].min(axis=0), np.ptp(outline[0], axis=0)
    size = float(extent.max()) / _ROOTS
    shape = np.clip(np.ceil(extent / size), 1, _ROOTS).astype(np.int64)
    corner = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 2)
    start, end = cut(*outline, np.ceil(2 * np.linalg.norm(outline[1] - outline[0], axis=1) / size))
    x, y = np.clip((0.5 * (start + end) - low) / size, 0, shape - 1).astype(np.int64).T
    pieces = start, end, x * shape[1] + y

    def look(corner: np.ndarray, level: np.ndarray, pieces: tuple) -> Samples:
        """The cells that meet the domain, seen."""
        start, end, cell = pieces
        side = size * 0.5**level
        points = low + (corner + 0.5) * side[:, None]
        inside = _inside(points, *outline)
        first = np.full(len(level), -1)
        first[cell[::-1]] = np.arange(len(cell))[::-1]
        kept = inside | (first >= 0)
        beside = kept & ~inside
        points[beside] = 0.5 * (start + end)[first[beside]]
        number = np.cumsum(kept) - 1
        values = function(points[kept])
        return Samples(
            corner[kept], level[kept], side[kept], inside[kept], points[kept], values, start, end, number[cell]
        )

    samples = look(corner, np.zeros(len(corner), dtype=np.int64), pieces)
    while (split := too_large(samples) & (samples.level < _MOST_LEVELS)).any():
        samples = _join(_rows(samples, ~split), look(*_children(samples, split, low)))
    return samples


def cut(start: np.ndarray, end: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each of the segments (k, 2) in so many equal parts (k,)."""
    parts = np.maximum(parts, 1).astype(np.int64)
    of = np.repeat(np.arange(len(parts)), parts)
    step = (np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts))[:, None]
    along = ((end - start) / parts[:, None])[of]
    return start[of] + step * along, start[of] + (step + 1) * along


def _children(samples: Samples, split: np.ndarray, low: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple]:
    """The four children of each split cell: corners, levels, and the pieces of the boundary, halved."""
    quarters = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])
    corner = (2 * samples.corner[split][:, None] + quarters).reshape(-1, 2)
    level = np.repeat(samples.level[split] + 1, 4)
    number = np.cumsum(split) - 1
    taken = split[samples.piece_cell]
    start, end = cut(samples.piece_start[taken], samples.piece_end[taken], np.full(np.count_nonzero(taken), 2))
    parent = np.repeat(samples.piece_cell[taken], 2)
    within = (0.5 * (start + end) - low) / samples.size[parent][:, None] - samples.corner[parent]
    x, y = (within >= 0.5).astype(np.int64).T
    return corner, level, (start, end, 4 * number[parent] + 2 * x + y)


def _rows(samples: Samples, rows: np.ndarray) -> Samples:
    """The chosen (n,) bool cells."""
    kept = rows[samples.piece_cell]
    return Samples(
        *(getattr(samples, name)[rows] for name in ("corner", "level", "size", "inside", "points", "values")),
        samples.piece_start[kept],
        samples.piece_end[kept],
        (np.cumsum(rows) - 1)[samples.piece_cell[kept]],
    )


def _join(one: Samples, other: Samples) -> Samples:
    columns = {
        name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in Samples.__dataclass_fields__
    }
    columns["piece_cell"][len(one.piece_cell) :] += len(one.level)
    return Samples(**columns)


def _inside(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(n,) whether points (n, 2) are inside what the edges (k, 2) bound, by the even-odd rule; to rounding."""
    order = np.argsort(points[:, 1], kind="stable")
    x, y = points[order].T
    below, above = np.minimum(start[:, 1], end[:, 1]), np.maximum(start[:, 1], end[:, 1])
    first = np.searchsorted(y, below)
    count = np.searchsorted(y, above) - first
    edge = np.repeat(np.arange(len(start)), count)
    point = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + first[edge]
    along = end[edge] - start[edge]
    at = start[edge, 0] + (y[point] - start[edge, 1]) / along[:, 1] * along[:, 0]
    odd = np.bincount(point, at > x[point], minlength=len(points)).astype(np.int64) % 2 == 1
    result = np.zeros(len(points), dtype=bool)
    result[order] = odd
    return result


def neighbours(samples: Samples) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (p,), (p,) of cells that touch, each at least once; the second is at least as large as the first."""
    levels = int(samples.level.max()) + 1
    stride = _ROOTS << levels
    tables = []
    for level in range(levels):
        cells = np.flatnonzero(samples.level == level)
        key = samples.corner[cells, 0] * stride + samples.corner[cells, 1]
        order = np.argsort(key)
        tables.append((key[order], cells[order]))
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    for level in range(levels):
        cells = tables[level][1]
        for step in _AROUND:
            left = cells
            for up in range(level + 1):
                key, number = tables[level - up]
                corner = samples.corner[left] + step >> up
                wanted = corner[:, 0] * stride + corner[:, 1]
                place = np.minimum(np.searchsorted(key, wanted), max(len(key) - 1, 0))
                hit = (
                    (key[place] == wanted) & (corner >= 0).all(axis=1) if len(key) else np.zeros(len(left), dtype=bool)
                )
                pairs.append(np.column_stack([left[hit], number[place[hit]]]))
                left = left[~hit]
    return tuple(np.concatenate(pairs).T)
