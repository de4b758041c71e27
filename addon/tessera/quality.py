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
