"""Diagonals of simple polygons by exact predicates alone: the last resort, where no chord is safe from rounding."""

import numpy as np

from .predicates import orientation, segments_cross

# Vertices to start from, and for each so many of the vertices closest to it.
_STARTS = 8
_CLOSEST = 8


def balanced_diagonal(polygon: np.ndarray) -> tuple[int, int]:
    """A diagonal of a simple counter-clockwise polygon (n, 2), n >= 4, that leaves many vertices on both sides.

    Where rounding rules every chord out, the polygon is as thin as a hair, and what lies across is closest. Cutting off
    one ear after the other instead would take time by the square of the number of vertices.
    """
    n = len(polygon)
    after = np.roll(polygon, -1, axis=0)
    best, most = None, 1
    for v in np.unique(np.arange(_STARTS) * n // _STARTS):
        away = np.abs(polygon - polygon[v]).max(axis=1)
        for w in np.argsort(away, kind="stable")[: _CLOSEST + 3]:
            behind = min(abs(int(w) - int(v)), n - abs(int(w) - int(v)))
            if behind > most and _is_diagonal(polygon, after, v, w):
                best, most = (int(v), int(w)), behind
    return best or any_diagonal(polygon)


def _is_diagonal(polygon: np.ndarray, after: np.ndarray, v: int, w: int) -> bool:
    """Whether the segment from v to w, which are no neighbours, lies inside and meets nothing but its ends."""
    here, there, before = polygon[v], polygon[w], polygon[v - 1]
    left_of_after = orientation(here, after[v], there) > 0
    right_of_before = orientation(before, here, there) > 0
    if orientation(before, here, after[v]) > 0:
        inside = left_of_after and right_of_before
    else:
        inside = left_of_after or right_of_before
    return bool(inside) and not segments_cross(here, there, polygon, after).any()


def any_diagonal(polygon: np.ndarray) -> tuple[int, int]:
    """A diagonal of a simple counter-clockwise polygon (n, 2), n >= 4; there always is one.

    v is the leftmost (then lowest) vertex, which is strictly convex, u and w its neighbours. If uw is no diagonal,
    other vertices lie in the triangle uvw, and v sees the one of them that is farthest from uw: anything in between
    would have an end still farther.
    """
    n = len(polygon)
    v = int(np.lexsort((polygon[:, 1], polygon[:, 0]))[0])
    u, w = (v - 1) % n, (v + 1) % n
    pu, pv, pw = polygon[[u, v, w]]
    within = np.logical_and.reduce([orientation(p, q, polygon) >= 0 for p, q in ((pu, pv), (pv, pw), (pw, pu))])
    within[[u, v, w]] = False
    if not within.any():
        return u, w
    candidates = np.nonzero(within)[0]
    offset, base = polygon[candidates] - pw, pu - pw
    distance = base[0] * offset[:, 1] - base[1] * offset[:, 0]
    # Rounding may confuse nearly equal distances, so each is checked, the farthest first.
    edges = np.arange(n)
    for candidate in candidates[np.argsort(-distance, kind="stable")]:
        if not segments_cross(pv, polygon[candidate], polygon, polygon[(edges + 1) % n]).any():
            return v, int(candidate)
    raise AssertionError("a simple polygon has a diagonal")
