"""The networks: one ONNX session a role, and one function a role.

NN1 and NN2 take transformed contours, (B, N, 2) with ``n_contour`` (B,) vertices each and padding after them. Contours
of like size go through a network together; the size they are padded to depends on each contour alone, never on its
neighbours in the batch, so that a contour's answer is the same in every batch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .elements import describe
from .runtime import MODELS, open_session

if TYPE_CHECKING:
    import onnxruntime

# Sizes that contours, inner vertices and grids are padded to.
_PADDED_EDGES = np.array([4, 8, 12, 16, 24, 32, 48, 64])
_PADDED_INNER = np.array([1, 2, 4, 6, 8, 12, 16, 24, 32])
_PADDED_GRID = np.array([16, 32, 48, 64, 96, 128, 192, 256, 400, 48 * 48])
_LEAST_QUALITY = 1e-4  # that NN3's elements are taken to have
_MOST = 1e9  # inner vertices that NN1 may ask for
_KNOWN_TARGETS = 0.25, 20.0  # scaled target edge lengths that NN1 is asked about; it has learnt from 0.25 on
# Points in one call, and entries, so that what a network holds at a time stays in the processor's cache.
_CALL_SIZE = 1 << 12
_CALL_ENTRIES = 1 << 14


@dataclass(frozen=True)
class Execution:
    """How onnxruntime runs the networks: with how many threads, and on what of its providers, if it has that."""

    threads: int = 1
    provider: str = "CPUExecutionProvider"


_execution = Execution()


def use(execution: Execution) -> None:
    """Run the networks like this from now on.

    Another provider than the CPU's, or another number of threads, may add up in another order: the last bits of what
    the networks say, and so now and then an element, may differ.
    """
    global _execution
    if execution != _execution:
        _execution = execution
        session.cache_clear()


@cache
def session(role: str) -> onnxruntime.InferenceSession:
    """The session of ``nn1``, ``nn2_scores``, ``nn2_moves``, ``nn2_star`` or ``nn3``; opened once.

    Raises RuntimeProblem.
    """
    return open_session(MODELS / f"{role}.onnx", _execution.threads, _execution.provider)


def count_inner_vertices(contour: np.ndarray, n_contour: np.ndarray, l_s: np.ndarray) -> np.ndarray:
    """NN1: how many inner vertices each contour needs at its scaled target edge length: (B,) int64."""
    count, known = np.zeros(len(n_contour)), np.clip(l_s, *_KNOWN_TARGETS)
    for rows, n, _ in _groups(n_contour, np.zeros_like(n_contour), _PADDED_INNER):
        (count[rows],) = session("nn1").run(
            None,
            {
                "contour": rings(contour, n_contour, rows, n),
                "n_contour": n_contour[rows].astype(np.int64),
                "l_s": known[rows].astype(np.float32),
            },
        )
    # Far from what the network knows, the number goes with the square.
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        count *= (known / l_s) ** 2
    # Rounded first, so that a last bit, which may depend on the processor, decides less often.
    count = np.nan_to_num(np.round(count, 3), nan=0, posinf=_MOST, neginf=0)
    return np.rint(np.clip(count, 0, _MOST)).astype(np.int64)


def score_grid(
    contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, grid: np.ndarray, n_grid: np.ndarray
) -> np.ndarray:
    """NN2: score of each grid point, its distance to the closest of the inner vertices in even edge lengths.

    grid: (B, 2, M), of which the first n_grid (B,) points count. Returns (B, M) float32, inf beyond n_grid.
    """
    scores = np.full((len(grid), grid.shape[2]), np.inf, dtype=np.float32)
    asked = np.flatnonzero((n_inner > 0) & (n_grid > 0))
    for rows, n, m in _groups(n_contour[asked], n_grid[asked], _PADDED_GRID):
        rows = asked[rows]
        points = np.zeros((len(rows), 2, m), dtype=np.float32)
        size = min(m, grid.shape[2])
        points[..., :size] = grid[rows, :, :size]
        (out,) = session("nn2_scores").run(
            None,
            {
                "contour": rings(contour, n_contour, rows, n),
                "n_contour": n_contour[rows].astype(np.int64),
                "n_inner": n_inner[rows].astype(np.int64),
                "grid": points,
            },
        )
        scores[rows, :size] = out[:, :size]
    scores[np.arange(grid.shape[2]) >= n_grid[:, None]] = np.inf
    return scores


def move_inner_vertices(
    contour: np.ndarray, n_contour: np.ndarray, inner: np.ndarray, n_inner: np.ndarray
) -> np.ndarray:
    """NN2's further passes: better places for inner vertices (B, M, 2), all seen at once."""
    moved = inner.copy()
    chosen = np.flatnonzero(n_inner > 0)
    for rows, n, m in _groups(n_contour[chosen], n_inner[chosen], _PADDED_INNER):
        rows = chosen[rows]
        (out,) = session("nn2_moves").run(
            None,
            {
                "contour": rings(contour, n_contour, rows, n),
                "n_contour": n_contour[rows].astype(np.int64),
                "inner": _single(inner, rows, m),
                "n_inner": n_inner[rows].astype(np.int64),
            },
        )
        size = min(m, inner.shape[1])
        moved[rows, :size] = np.where(np.isfinite(out[:, :size]), out[:, :size], inner[rows, :size])
    return np.where((np.arange(inner.shape[1]) < n_inner[:, None])[..., None], moved, inner)


def centre_stars(ring: np.ndarray, n_ring: np.ndarray) -> np.ndarray:
    """NN2 of stars: the places (2, S) of the only inner vertices of rings that are about as large as 1.

    ring: (2, R + 2, S), counter-clockwise, the last of each one's n_ring (S,) vertices before the first, the first
    after the last, and in the padding.
    """
    if len(n_ring) == 1:  # onnxruntime adds up in another order then
        return centre_stars(np.repeat(ring, 2, axis=2), np.repeat(n_ring, 2))[:, :1]
    share = np.where(np.arange(ring.shape[1] - 2)[:, None] < n_ring, 1 / n_ring, 0).astype(np.float32)
    found = [
        session("nn2_star").run(None, {"ring": ring[..., part].astype(np.float32, "C"), "share": share[:, part]})[0]
        for part in _pieces(len(n_ring), ring.shape[1])
    ]
    return np.concatenate(found, axis=1).astype(np.float64)


def _pieces(count: int, size: int, call: int = _CALL_SIZE) -> list[slice]:
    """Slices of `count` rows of so many points each, a call's worth at a time."""
    ends = np.linspace(0, count, 1 + max(1, min(count, -(-count * size // call)))).astype(np.int64)
    return [slice(start, end) for start, end in pairwise(ends.tolist())]


def rate_connections(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, entries: np.ndarray) -> np.ndarray:
    """NN3: values (q_worst, q_mean) (P, 2) float64 of entries of the connection tables.

    points: (B, V, 2) contour vertices, then inner vertices, not transformed; entries: (P, 3) int64, sorted (contour,
    facet, vertex). Those that NN3 is not told of (`elements.py`) get 0; values are rounded to four digits. Where NN3
    sees no good in a contour, its q_mean still tells which of the poor elements to take.
    """
    first = np.searchsorted(entries[:, 0], np.arange(len(points) + 1))
    values = np.zeros((2, len(entries))).T  # each column in one piece
    for part in _pieces(len(points), max(1, len(entries) // max(1, len(points))), _CALL_ENTRIES):
        rows = slice(first[part.start], first[part.stop])
        own = entries[rows] - [part.start, 0, 0]
        told, described = describe(points[part], n_contour[part], n_inner[part], own)
        # Rounded, so that a last bit, which may depend on the processor, decides less often.
        found = np.round(session("nn3").run(None, vars(described))[0], 4)
        # What is possible has some quality, though less than NN3 may err by.
        row = own[told, 0]
        hopeless = np.bincount(row, ~(found[:, 0] <= 0))[row] == 0
        found[hopeless, 0] = _LEAST_QUALITY
        values[rows][told] = found
    return values


def _groups(n_contour: np.ndarray, n_other: np.ndarray, sizes: np.ndarray) -> Iterator[tuple[np.ndarray, int, int]]:
    """Rows of like size, with the numbers of edges and of other points to pad them to, a call at a time.

    sizes: that the numbers of other points are padded to, ascending.
    """
    n_padded = _PADDED_EDGES[np.searchsorted(_PADDED_EDGES, n_contour)]
    m_padded = sizes[np.searchsorted(sizes, n_other)]
    key = n_padded * 10000 + m_padded
    for value in sorted(set(key.tolist())):
        rows = np.flatnonzero(key == value)
        n, m = divmod(value, 10000)
        step = max(1, _CALL_SIZE // (n + m))
        for start in range(0, len(rows), step):
            yield rows[start : start + step], n, m


def rings(contour: np.ndarray, n_contour: np.ndarray, rows: np.ndarray, size: int) -> np.ndarray:
    """Rows of contours as (len(rows), 2, size + 2) float32: the last vertex before the first, the first after the last.

    What is behind that is of no meaning, but finite, as contours' padding is.
    """
    count, width = n_contour[rows], min(size, contour.shape[1])
    out = np.zeros((len(rows), 2, size + 2), dtype=np.float32)
    out[:, :, 1 : width + 1] = contour[rows, :width].swapaxes(1, 2)
    out[:, :, 0] = contour[rows, count - 1]
    out[np.arange(len(rows)), :, count + 1] = contour[rows, 0]
    return out


def _single(points: np.ndarray, rows: np.ndarray, size: int) -> np.ndarray:
    """Rows of padded points as (len(rows), size, 2) float32."""
    out = np.zeros((len(rows), size, 2), dtype=np.float32)
    width = min(size, points.shape[1])
    out[:, :width] = points[rows, :width]
    return out
