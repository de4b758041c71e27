"""Which elements overlap: the entries that new elements close, and which of the best entries go together."""

from __future__ import annotations

from functools import cache

import numpy as np

from .visibility import crossing, lines_to


def excluded_entries(
    sides: np.ndarray,
    bits: np.ndarray,
    rows: np.ndarray,
    facet: np.ndarray,
    end: np.ndarray,
    vertex: np.ndarray,
    n_contour: np.ndarray,
) -> np.ndarray:
    """Entries of other facets that are impossible beside each of k elements (facet, vertex) of contours `rows` (n,).

    facet, end, vertex (k, n); end: the facets' second vertices. Returns words (F, k, n).
    """
    shape, rows = facet.shape, np.broadcast_to(rows, facet.shape).ravel()
    facet, end, vertex = facet.ravel(), end.ravel(), vertex.ravel()
    to_corners = lines_to(sides, rows, np.array([facet, end, vertex]))
    place = (rows * sides.shape[1] + vertex) * sides.shape[2] + facet
    edges = sides.reshape(-1, 2).take([place, place + 1], axis=0).transpose(0, 2, 1)
    crossed = crossing(to_corners[:2], to_corners[2:], edges, bits[rows, vertex][None])
    excluded = crossed[:-1] | crossed[1:]
    # Elements on the same side of one of the new edges; an inner vertex has no facets.
    (index,) = np.nonzero(vertex < n_contour[rows])
    if len(index):
        row, vertex = rows[index], vertex[index]
        excluded[vertex, index] |= bits[row, end[index]]
        excluded[(vertex - 1) % n_contour[row], index] |= bits[row, facet[index]]
    return excluded.reshape(-1, *shape)


def compatible(
    closed: np.ndarray, facet: np.ndarray, end: np.ndarray, vertex: np.ndarray, chosen: np.ndarray
) -> np.ndarray:
    """Which of the best entries (k, n), best first, would be taken one after the other: (k, n) bool.

    That is all before the first that overlaps a better one, but for the same element on another facet, which closes
    that facet and no more. closed (F, k, n): what each excludes; end, vertex, chosen (k, n): its facet's second vertex,
    its own vertex and that one's bit.
    """
    k, n = facet.shape
    taken = np.ones((k, n), dtype=bool)
    if k > 1:
        one, other, first = _pairs(k)
        overlap = closed[facet[one], other[:, None], np.arange(n)] & chosen[one] != 0
        follows = (facet[one] == end[other]) & (vertex[other] == end[one]) & (vertex[one] == facet[other])
        precedes = (end[one] == facet[other]) & (vertex[one] == end[other]) & (vertex[other] == facet[one])
        same = overlap & (follows | precedes)
        taken[1:] = ~np.logical_or.accumulate(np.logical_or.reduceat(overlap & ~same, first), axis=0)
        taken[1:] &= ~np.logical_or.reduceat(same, first)
    return taken


@cache
def _pairs(k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each of k entries (p,) with all better ones (p,), and where those of each but the best begin (k - 1,)."""
    return *np.tril_indices(k, -1), np.arange(1, k) * np.arange(k - 1) // 2
