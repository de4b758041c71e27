"""Entries of connection tables: listing those of possible elements, and the order in which they are taken."""

from __future__ import annotations

import numpy as np

from .visibility import as_bools

# Entries are compared to this many bits. What differs by less is a tie, so that rounding rarely decides.
BITS = 20
# Weight of the element's own quality beside the table's entry: it decides between near ties.
OWN_WEIGHT = 0.005
# Flatter elements, on vertices that are collinear but for rounding, are made only where there is no other.
FLAT = 1e-5


def list_entries(possible: np.ndarray, bits: np.ndarray) -> np.ndarray:
    """Words (F, B) as rows, facets and vertices (3, p), sorted."""
    width = bits.shape[1]
    place = np.flatnonzero(as_bools(possible.T, bits[:, None]))
    cell = place // width
    row = cell // len(possible)
    return np.array([row, cell - row * len(possible), place - cell * width])


def score_entries(
    points: np.ndarray, n_contour: np.ndarray, entries: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Possible entries as integers, the better the larger and above 0: (B, F, V) int32.

    An entry is acceptable if its q_worst is finite and positive, and its element not flat; others are 0. Rows
    without any are returned too (s,): there each facet's bluntest apexes count, by the element's own quality.
    """
    n_facets, width = int(n_contour.max()), points.shape[1]
    row, facet, vertex = entries
    place = (row * n_facets + facet) * width + vertex
    scores = np.zeros(len(points) * n_facets * width, dtype=np.int32)
    (hopeful,) = np.nonzero((values[:, 0] > 0) & (values[:, 0] < np.inf))
    own = quality(*_corners(points, n_contour, entries[:, hopeful]))
    hopeful, own = hopeful[own > FLAT], own[own > FLAT]
    worst, mean = values[hopeful].T
    value = np.minimum(worst, own) + np.clip(np.where(np.isfinite(mean), mean, 0), 0, 1) + OWN_WEIGHT * own
    scores[place[hopeful]] = (value * 2**BITS).astype(np.int32) + 1
    stuck = np.bincount(row[hopeful], minlength=len(points)) == 0
    (left,) = np.nonzero(stuck[row])
    if len(left):
        corners = _corners(points, n_contour, entries[:, left])
        (blunt,) = np.nonzero(_is_bluntest(*corners, row[left] * n_facets + facet[left]))
        left, own = left[blunt], quality(*corners)[blunt]
        # Beside the best of them in the contour, so that flat elements are told apart too.
        best = np.zeros(len(points))
        np.maximum.at(best, row[left], own)
        value = own / np.maximum(best[row[left]], np.finfo(float).tiny)
        scores[place[left]] = (value * 2**BITS).astype(np.int32) + 1
    return scores.reshape(-1, n_facets, width), np.flatnonzero(stuck)


def _corners(points: np.ndarray, n_contour: np.ndarray, entries: np.ndarray) -> tuple[np.ndarray, ...]:
    """The corners (p,) of entries' elements, complex numbers, the apex last."""
    row, facet, vertex = entries
    end = facet + 1
    end[end == n_contour[row]] = 0
    flat, first = np.ascontiguousarray(points).view(np.complex128).reshape(-1), row * points.shape[1]
    return flat.take(first + facet), flat.take(first + end), flat.take(first + vertex)


def quality(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """`element_quality` of triangles with corners (P,), complex numbers, 0 where it is not positive: (P,) float64.

    Not by that function, which is nine times slower, as it looks after extreme coordinates too.
    """
    ab, ac, bc = b - a, c - a, c - b
    double_area = ac.real * bc.imag - bc.real * ac.imag
    squared = sum(side.real**2 + side.imag**2 for side in (ac, bc, ab))
    return 2 * np.sqrt(3) * np.maximum(double_area, 0) / np.maximum(squared, np.finfo(float).tiny)


def _is_bluntest(a: np.ndarray, b: np.ndarray, c: np.ndarray, facet: np.ndarray) -> np.ndarray:
    """(P,) whether an entry's apex angle is its facet's largest: the element of the constrained Delaunay triangulation.

    a, b, c: (P,) corners, the apex last, complex numbers; facet: (P,) int, ascending.
    """
    product = (a - c) * np.conj(b - c)
    with np.errstate(over="ignore"):  # infinite is as good as large
        cotangent = product.real / np.maximum(np.abs(product.imag), np.finfo(float).tiny)
    first = np.flatnonzero(np.diff(facet, prepend=-1))
    smallest = np.repeat(np.minimum.reduceat(cotangent, first), np.diff(first, append=len(facet)))
    return cotangent <= smallest
