"""Small triangulations, compiled: constrained Delaunay and forced elements.

A triangulation of n vertices is its matrix ``opposite`` (n, n) int64: ``opposite[u, v]`` is the third vertex of the
element on the left of the directed edge (u, v), or -1. Contours are counter-clockwise and come first among the
vertices.
"""

from __future__ import annotations

import numpy as np
from numba import njit

TINY = 1e-12


@njit(cache=True)
def area2(points, a, b, c):
    """Twice the signed area of (a, b, c)."""
    return (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1]) - (points[b, 1] - points[a, 1]) * (
        points[c, 0] - points[a, 0]
    )


@njit(cache=True)
def quality(points, a, b, c):
    """The paper's element quality, negative where inverted."""
    squares = 0.0
    for u, v in ((a, b), (b, c), (c, a)):
        squares += (points[u, 0] - points[v, 0]) ** 2 + (points[u, 1] - points[v, 1]) ** 2
    return 2 * np.sqrt(3.0) * area2(points, a, b, c) / max(squares, 1e-300)


@njit(cache=True)
def add(opposite, a, b, c):
    """Add the counter-clockwise element (a, b, c)."""
    opposite[a, b] = c
    opposite[b, c] = a
    opposite[c, a] = b


@njit(cache=True)
def is_within(points, a, b, c, v):
    """Whether v lies in the closed triangle (a, b, c), give or take a rounding."""
    return area2(points, a, b, v) >= -TINY and area2(points, b, c, v) >= -TINY and area2(points, c, a, v) >= -TINY


@njit(cache=True)
def cut_ears(points, n, opposite):
    """Triangulate the contour's own n vertices. Returns whether it worked."""
    ring = np.arange(n)
    left = n
    while left > 3:
        best, best_quality = -1, 0.0
        for i in range(left):
            a, b, c = ring[i - 1 if i else left - 1], ring[i], ring[(i + 1) % left]
            q = quality(points, a, b, c)
            if q <= max(best_quality, 1e-9):
                continue
            clear = True
            for k in range(left):
                v = ring[k]
                if v not in (a, b, c) and is_within(points, a, b, c, v):
                    clear = False
                    break
            if clear:
                best, best_quality = i, q
        if best < 0:
            return False
        add(opposite, ring[best - 1 if best else left - 1], ring[best], ring[(best + 1) % left])
        for k in range(best, left - 1):
            ring[k] = ring[k + 1]
        left -= 1
    add(opposite, ring[0], ring[1], ring[2])
    return area2(points, ring[0], ring[1], ring[2]) > TINY


@njit(cache=True)
def insert(points, opposite, n_before, v):
    """Split the element that holds vertex v. Returns whether one was found."""
    for a in range(n_before):
        for b in range(n_before):
            c = opposite[a, b]
            if c > a and b > a:
                wa, wb, wc = area2(points, b, c, v), area2(points, c, a, v), area2(points, a, b, v)
                if wa > TINY and wb > TINY and wc > TINY:
                    add(opposite, a, b, v)
                    add(opposite, b, c, v)
                    add(opposite, c, a, v)
                    return True
                if wa >= -TINY and wb >= -TINY and wc >= -TINY:  # on an edge: split both its elements
                    if wa <= TINY:
                        a, b, c = b, c, a
                    elif wb <= TINY:
                        a, b, c = c, a, b
                    d = opposite[b, a]
                    if d < 0:
                        return False
                    opposite[a, b] = opposite[b, a] = -1
                    add(opposite, b, c, v)
                    add(opposite, c, a, v)
                    add(opposite, a, d, v)
                    add(opposite, d, b, v)
                    return True
    return False


@njit(cache=True)
def flip(opposite, u, v):
    """Exchange the diagonal (u, v) of its two elements."""
    w, x = opposite[u, v], opposite[v, u]
    opposite[u, v] = opposite[v, u] = -1
    add(opposite, u, x, w)
    add(opposite, x, v, w)


@njit(cache=True)
def is_convex(points, opposite, u, v):
    """Whether the two elements on the edge (u, v) form a convex quadrilateral."""
    w, x = opposite[u, v], opposite[v, u]
    return area2(points, u, x, w) > TINY and area2(points, x, v, w) > TINY


@njit(cache=True)
def in_circle(points, a, b, c, d):
    """Positive where d is inside the circle through the counter-clockwise (a, b, c)."""
    ax, ay = points[a, 0] - points[d, 0], points[a, 1] - points[d, 1]
    bx, by = points[b, 0] - points[d, 0], points[b, 1] - points[d, 1]
    cx, cy = points[c, 0] - points[d, 0], points[c, 1] - points[d, 1]
    return (
        (ax * ax + ay * ay) * (bx * cy - by * cx)
        - (bx * bx + by * by) * (ax * cy - ay * cx)
        + (cx * cx + cy * cy) * (ax * by - ay * bx)
    )


@njit(cache=True)
def legalise(points, opposite, n, fixed):
    """Flip to the constrained Delaunay triangulation; edges in ``fixed`` (n, n) stay."""
    for _ in range(4 * n):
        changed = False
        for u in range(n):
            for v in range(u + 1, n):
                w, x = opposite[u, v], opposite[v, u]
                if w < 0 or x < 0 or fixed[u, v]:
                    continue
                if in_circle(points, u, v, w, x) > 1e-10 and is_convex(points, opposite, u, v):
                    flip(opposite, u, v)
                    changed = True
        if not changed:
            return


@njit(cache=True)
def delaunay(points, n_contour, n, opposite):
    """Constrained Delaunay triangulation of a contour and its inner vertices, into ``opposite``. Returns success."""
    opposite[:n, :n] = -1
    if not cut_ears(points, n_contour, opposite):
        return False
    for v in range(n_contour, n):
        if not insert(points, opposite, v, v):
            return False
    legalise(points, opposite, n, np.zeros((n, n), np.bool_))
    return True


@njit(cache=True)
def qualities(points, opposite, n):
    """(q_worst, q_mean) of a triangulation."""
    worst, total, count = 1.0, 0.0, 0
    for a in range(n):
        for b in range(a + 1, n):
            for c in (opposite[a, b], opposite[b, a]):
                if c > b:
                    q = quality(points, a, b, c) if opposite[a, b] == c else quality(points, b, a, c)
                    worst = min(worst, q)
                    total += q
                    count += 1
    return worst, total / max(count, 1)


@njit(cache=True)
def triangles(opposite, n):
    """(m, 3) int64 elements, counter-clockwise."""
    out = np.empty((2 * n, 3), np.int64)
    m = 0
    for a in range(n):
        for b in range(n):
            c = opposite[a, b]
            if c > a and b > a:
                out[m, 0], out[m, 1], out[m, 2] = a, b, c
                m += 1
    return out[:m]


@njit(cache=True)
def crosses(points, a, b, c, d):
    """Whether the open segments (a, b) and (c, d) cross properly."""
    if a in (c, d) or b in (c, d):
        return False
    return area2(points, a, b, c) * area2(points, a, b, d) < 0 and area2(points, c, d, a) * area2(points, c, d, b) < 0


@njit(cache=True)
def force_edge(points, opposite, n, a, b):
    """Flip until the edge (a, b) is there. Returns success."""
    for _ in range(4 * n):
        if opposite[a, b] >= 0 or opposite[b, a] >= 0:
            return True
        flipped = False
        for u in range(n):
            for v in range(u + 1, n):
                if opposite[u, v] < 0 or opposite[v, u] < 0 or not crosses(points, a, b, u, v):
                    continue
                if not is_convex(points, opposite, u, v):
                    continue
                w, x = opposite[u, v], opposite[v, u]
                # A flip that leaves a crossing edge is taken only where it brings the crossing nearer to a's side.
                if crosses(points, a, b, w, x) and flipped:
                    continue
                flip(opposite, u, v)
                flipped = True
        if not flipped:
            return False
    return False
