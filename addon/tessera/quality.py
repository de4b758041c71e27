"""Element quality."""

import numpy as np


def element_quality(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The paper's q = 4 area / (sqrt(3) l_rms²), l_rms² = (l1² + l2² + l3²) / 3, of every triangle.

    vertices (n, 2) float64, triangles (m, 3) int -> (m,) float64: 1 is equilateral, 0 degenerate (also three equal
    points), negative clockwise. Independent of scale.
    """
    corners = np.asarray(triangles, dtype=np.int64).T
    x, y = (np.asarray(vertices, dtype=np.float64)[:, axis][corners] for axis in (0, 1))
    x, y = x[[1, 2, 0]] - x, y[[1, 2, 0]] - y
    # Relative to the longest side, so that squares neither overflow nor vanish.
    largest = np.maximum(np.abs(x).max(axis=0), np.abs(y).max(axis=0))
    scale = np.where(largest > 0, largest, 1.0)
    x, y = x / scale, y / scale
    squared = (x * x + y * y).sum(axis=0)
    return 2.0 * np.sqrt(3.0) * (x[0] * y[1] - y[0] * x[1]) / np.where(squared > 0, squared, 1.0)


def quality_of_sides(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """q of triangles (...) by two sides u and v (2, ...) from one corner, of moderate lengths; negative if clockwise.

    A few times as fast as that function, which looks after extreme coordinates too.
    """
    (ux, uy), (vx, vy) = u, v
    # u² + v² + (u - v)², halved.
    squares = ux * ux + uy * uy + vx * vx + vy * vy - (ux * vx + uy * vy)
    return np.sqrt(3) * (ux * vy - uy * vx) / np.maximum(squares, 1e-300)
