"""Patches of a large mesh that are to be meshed again: which elements are taken out, and the contours that are left.

A patch is all elements around a few vertices: around the corners of a poor element, or around a vertex that has not six
neighbours, and those. No two patches of a round share an element; where they would, the worse one's stays.
"""

from __future__ import annotations

import numpy as np

from .edges import among
from .scheme import LARGEST_CONTOUR

_IRREGULAR = 0.95  # the quality below which an element at a vertex that has not six neighbours is worth a patch


def find_patches(
    triangles: np.ndarray,
    quality: np.ndarray,
    free: np.ndarray,
    tried: tuple[np.ndarray, np.ndarray],
    poor: float,
    fixed: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The contours of patches (c, N), padded with -1; the patch that each element is in or -1 (m,); their kinds (c,).

    triangles: (m, 3); quality: (m,); free: (n,) which vertices are off the boundary; tried: for patches around elements
    and around vertices, the vertices (n,) that have seen one, and no change since; poor: the quality below which an
    element is worth a patch; fixed: (f, 2) edges that no patch has inside. The poorest come first.
    """
    found = _around_elements(triangles, quality, free, poor), _around_vertices(triangles, quality, free, poor)
    kind = np.repeat([0, 1], [len(worst) for worst, _, _ in found])
    worst, rank = np.concatenate([found[0][0], found[1][0]]), np.empty(len(kind), dtype=np.int64)
    order = np.lexsort((kind, worst))
    rank[order] = np.arange(len(order))
    candidate = np.concatenate([found[0][1], found[1][1] + len(found[0][0])])
    vertex = np.concatenate([found[0][2], found[1][2]])
    fresh = np.where(kind[candidate] == 0, ~tried[0][vertex], ~tried[1][vertex])
    patch = _patches(triangles, rank[candidate], vertex, fresh, len(kind), len(free))
    if fixed is not None:
        patch[np.isin(patch, _swallowing(triangles, patch, fixed))] = -1
    contours, anew, first = _contours_of(triangles, patch)
    return contours, anew, kind[order][first]


def _around_elements(
    triangles: np.ndarray, quality: np.ndarray, free: np.ndarray, poor: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Patches around poor elements: the worst quality (k,) in each, and pairs (p,) of a patch and a vertex it wants.

    Those are the element's free vertices, or all three where none is. The latter patches come last, as there is often
    nothing to gain: a corner of the boundary may force the element.
    """
    chosen = np.flatnonzero(quality < poor)
    wanted = free[triangles[chosen]]
    stuck = ~wanted.any(axis=1)
    place, corner = np.nonzero(wanted | stuck[:, None])
    return np.where(stuck, poor, quality[chosen]), place, triangles[chosen[place], corner]


def _around_vertices(
    triangles: np.ndarray, quality: np.ndarray, free: np.ndarray, poor: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `_around_elements`, around vertices and their neighbours; of those with not six, more are worth a try."""
    corners, n = triangles.ravel(), len(free)
    count, worst = np.bincount(corners, minlength=n), np.ones(n)
    np.minimum.at(worst, corners, np.repeat(quality, 3))
    chosen = np.flatnonzero(free & (count > 0) & (worst < np.where(count == 6, poor, _IRREGULAR)))
    number = np.full(n, -1)
    number[chosen] = np.arange(len(chosen))
    near = triangles[(number[triangles] >= 0).any(axis=1)]
    centre, wanted = np.repeat(near, 3, axis=1).ravel(), np.tile(near, 3).ravel()
    pairs = (number[centre] >= 0) & free[wanted]
    return worst[chosen], number[centre[pairs]], wanted[pairs]


def _patches(
    triangles: np.ndarray, rank: np.ndarray, vertex: np.ndarray, fresh: np.ndarray, count: int, n: int
) -> np.ndarray:
    """(m,) the rank of the patch of each element, or -1: all around the vertices that `count` ranked candidates want.

    rank, vertex: (p,) who wants what; fresh: (p,) a candidate needs one vertex that is. A candidate gets its patch if
    no element of it is wanted by one of lower rank.
    """
    worth = np.zeros(count + 1, dtype=bool)
    worth[rank[fresh]] = True
    rank, vertex = rank[worth[rank]], vertex[worth[rank]]
    rank_at = np.full(n, count)
    np.minimum.at(rank_at, vertex, rank)
    wanted_by = rank_at[triangles]
    best = wanted_by.min(axis=1)
    spoiled = np.zeros(count + 1, dtype=bool)
    for corner in wanted_by.T:
        spoiled[corner[corner > best]] = True
    spoiled[rank[rank_at[vertex] != rank]] = True
    spoiled[-1] = True
    return np.where(spoiled[best], -1, best)


def _half_edges(triangles: np.ndarray, patch: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Start, end and patch of each half-edge of patches' elements (h,), and whether its twin is in the same patch."""
    inside = np.flatnonzero(patch >= 0)
    start = triangles[inside].ravel().astype(np.int64)
    end = np.roll(triangles[inside], -1, axis=1).ravel().astype(np.int64)
    label = np.repeat(patch[inside], 3)
    stride = int(triangles.max(initial=0)) + 1
    here, back = ((label * stride + a) * stride + b for a, b in ((start, end), (end, start)))
    return start, end, label, np.isin(here, back)


def _swallowing(triangles: np.ndarray, patch: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """The patches that have a fixed edge between two of their elements, or one of its vertices amid them."""
    start, end, label, within = _half_edges(triangles, patch)
    stride = int(triangles.max(initial=0)) + 1
    edges = label[within & among(np.column_stack([start, end]), fixed)]
    at = label * stride + start
    on_outline = np.isin(at, np.concatenate([at[~within], (label * stride + end)[~within]]))
    return np.unique(np.concatenate([edges, label[~on_outline & np.isin(start, fixed)]]))


def _contours_of(triangles: np.ndarray, patch: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The contours of patches (c, N), padded with -1, and the patches (m,) numbered anew; the old numbers (c,).

    Unfit ones are dropped: a patch is fit if its boundary is one cycle that visits no vertex twice and has at most 16
    edges.
    """
    start, end, label, within = _half_edges(triangles, patch)
    stride = int(triangles.max(initial=0)) + 1
    label, start, end = label[~within], start[~within], end[~within]
    order = np.lexsort((start, label))
    label, start, end = label[order], start[order], end[order]
    numbers, first, count = np.unique(label, return_index=True, return_counts=True)
    key = label * stride + start
    following = np.minimum(np.searchsorted(key, label * stride + end), len(key) - 1)
    contours = np.full((len(numbers), LARGEST_CONTOUR), -1, dtype=np.int64)
    at, length = first, np.zeros(len(numbers), dtype=np.int64)
    for k in range(LARGEST_CONTOUR):
        contours[:, k] = np.where(k < count, start[at], -1)
        at = following[at]
        length = np.where((length == 0) & (at == first), k + 1, length)
    repeated = np.zeros(len(numbers), dtype=bool)
    repeated[np.searchsorted(numbers, label[1:][key[1:] == key[:-1]])] = True
    fit = (length == count) & ~repeated
    anew = np.full(int(patch.max(initial=-1)) + 2, -1)
    anew[numbers[fit]] = np.arange(fit.sum())
    return contours[fit], anew[patch], numbers[fit]
