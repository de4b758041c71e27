"""What makes the teacher of the reference's mesh: its inner vertices move and its edges are flipped; compiled.

Triangulations are as in `meshing.py`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .meshing import area2, flip, is_convex, quality


@njit(cache=True)
def energy(q):
    """q^-4, continued linearly below 0.1 so that inverted elements can be mended."""
    if q > 0.1:
        return 1 / (q * q * q * q)
    return 1e4 + 4e5 * (0.1 - q)


@njit(cache=True)
def ball_energy(points, opposite, n, v):
    """Sum of the energy of the elements around v."""
    total = 0.0
    for a in range(n):
        b = opposite[v, a]
        if b >= 0:
            total += energy(quality(points, v, a, b))
    return total


@njit(cache=True)
def move(points, opposite, n, v, step):
    """Move one vertex downhill in its ball's energy by at most ``step``. Returns the step to try next."""
    before = ball_energy(points, opposite, n, v)
    gx, gy, size, count = 0.0, 0.0, 0.0, 0
    for a in range(n):
        b = opposite[v, a]
        if b < 0:
            continue
        squares = 0.0
        for u, w in ((v, a), (a, b), (b, v)):
            squares += (points[u, 0] - points[w, 0]) ** 2 + (points[u, 1] - points[w, 1]) ** 2
        double = area2(points, v, a, b)
        q = 2 * np.sqrt(3.0) * double / squares
        slope = -4 / (q * q * q * q * q) if q > 0.1 else -4e5
        for axis in range(2):
            d_area = points[a, 1] - points[b, 1] if axis == 0 else points[b, 0] - points[a, 0]
            d_squares = 2 * (2 * points[v, axis] - points[a, axis] - points[b, axis])
            d = slope * 2 * np.sqrt(3.0) * (d_area * squares - double * d_squares) / squares**2
            if axis == 0:
                gx += d
            else:
                gy += d
        size += np.sqrt(squares / 3)
        count += 1
    norm = np.sqrt(gx * gx + gy * gy)
    if count == 0 or norm < 1e-12:
        return step
    x, y = points[v, 0], points[v, 1]
    length = step * size / count / norm
    for _ in range(5):
        points[v, 0], points[v, 1] = x - length * gx, y - length * gy
        if ball_energy(points, opposite, n, v) < before:
            return min(0.3, 1.5 * step)
        length *= 0.4
        step *= 0.4
    points[v, 0], points[v, 1] = x, y
    return max(step, 1e-4)


@njit(cache=True)
def flip_for_quality(points, opposite, n):
    """Flip edges where that lowers the energy of their two elements. Returns whether any was."""
    changed = False
    for u in range(n):
        for v in range(u + 1, n):
            w, x = opposite[u, v], opposite[v, u]
            if w < 0 or x < 0 or not is_convex(points, opposite, u, v):
                continue
            now = energy(quality(points, u, v, w)) + energy(quality(points, v, u, x))
            then = energy(quality(points, u, x, w)) + energy(quality(points, x, v, w))
            if then < now * (1 - 1e-9):
                flip(opposite, u, v)
                changed = True
    return changed


@njit(cache=True)
def improve(points, opposite, n_contour, n, sweeps):
    """Move the inner vertices and flip edges, in place, to lower the sum of q^-4: the teacher's mesh."""
    steps = np.full(n, 0.1)
    for sweep in range(sweeps):
        flipped = flip_for_quality(points, opposite, n)
        largest = 0.0
        for v in range(n_contour, n):
            steps[v] = move(points, opposite, n, v, steps[v])
            largest = max(largest, steps[v])
        if not flipped and largest < 1e-3 and sweep > 4:
            return
