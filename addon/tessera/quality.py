"""Element quality."""

import numpy as np


def element_quality(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The paper's q = 4 area / (sqrt(3) l_rms²), l_rms² = (l1² + l2² + l3²) / 3, of every triangle.

    vertices (n, 2) float64, triangles (m, 3) int -> (m,) float64: 1 is equilateral, 0 degenerate (also three equal
    points), negative clockwise. Independent of scale.
    """
    a, b, c = np.moveaxis(np.asarray(vertices, dtype=np.float64)[np.asarray(triangles, dtype=np.int64)], 1, 0)
    sides = np.stack([b - a, c - b, a - c])
    # Relative to the longest side, so that squares neither overflow nor vanish.
    largest = np.abs(sides).max(axis=(0, 2))
    sides = sides / np.where(largest > 0, largest, 1.0)[:, None]
    double_area = sides[0, :, 0] * sides[1, :, 1] - sides[0, :, 1] * sides[1, :, 0]
    squared = np.einsum("sij,sij->i", sides, sides)
    return 2.0 * np.sqrt(3.0) * double_area / np.where(squared > 0, squared, 1.0)


def quality_of_sides(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """q of triangles (...) by two sides u and v (..., 2) from one corner, of moderate lengths; negative if clockwise.

    A few times as fast as that function, which looks after extreme coordinates too.
    """
    squares = (u * u).sum(-1) + (v * v).sum(-1) + ((u - v) ** 2).sum(-1)
    return 2 * np.sqrt(3) * (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]) / np.maximum(squares, 1e-300)
