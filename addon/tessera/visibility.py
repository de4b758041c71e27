"""Which elements are possible: exact signs of all triangles on contour vertices, and the tests made of them.

Every decision of the triangulation is taken from one tensor of exact signs, so no two decisions can contradict each
other. It is computed once a recursion level, in floating point with an error bound; entries below the bound go to
`predicates.orientation`.
"""

import numpy as np

from .predicates import orientation

# |det - exact| <= 2^-50 * (|dx| + |dy|) * largest |d|: each of the two products is off by at most (1 + u)^3 - 1 of
# itself, the difference by u, u = 2^-53 (Shewchuk 1997, section 4.3), and the bound leaves a factor of two.
_ERROR_BOUND = 2.0**-50
# Numbers in a temporary: contours are taken in blocks of about this size, which stay in the processor's cache.
_BLOCK_SIZE = 1 << 17


def edge_starts(n_contour: np.ndarray) -> np.ndarray:
    """Contour vertices from which edges start: (B, max n_contour + 1), 0 to n_contour - 1, then 0 again (and padding).

    Facet f of a contour runs from entry f to entry f + 1.
    """
    index = np.arange(int(n_contour.max()) + 1)
    return np.where(index < n_contour[:, None], index, 0)


def edge_signs(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """Side of every vertex relative to every line through a contour vertex and another vertex.

    points: (B, V, 2) float64, rows of contour vertices, then inner vertices, then padding; n_contour, n_inner: (B,).
    Returns signs (B, V, F + 1, V) int8, F = max n_contour: `signs[:, x, k, v]` is +1 if x lies left of the line from the
    k-th of `edge_starts` to v, 0 on it. Entries of padding are 0.
    """
    n_rows, width = points.shape[:2]
    n_starts = int(n_contour.max()) + 1
    starts = edge_starts(n_contour)
    index = np.arange(n_starts)
    # Padding is NaN: it compares as neither sign, nor as uncertain.
    used = np.arange(width) < (n_contour + n_inner)[:, None]
    vertices = np.where(used[..., None], points, np.nan)
    origins = np.take_along_axis(points, starts[..., None], axis=1)
    origins[index > n_contour[:, None]] = np.nan
    signs = np.empty((n_rows, width, n_starts, width), dtype=np.int8)
    block = max(1, _BLOCK_SIZE // (width * n_starts * width))
    for first in range(0, n_rows, block):
        rows = slice(first, first + block)
        _block_signs(vertices[rows], origins[rows], starts[rows], signs[rows])
    return signs


def _block_signs(vertices: np.ndarray, origins: np.ndarray, starts: np.ndarray, signs: np.ndarray) -> None:
    """Fill `signs`, the result of `edge_signs`, for a few contours."""
    dx = vertices[:, None, :, 0] - origins[:, :, None, 0]
    dy = vertices[:, None, :, 1] - origins[:, :, None, 1]
    for offset in (dx, dy):
        np.put_along_axis(offset, starts[..., None], np.nan, axis=2)
    size = np.abs(dx) + np.abs(dy)
    largest = np.fmax.reduce(size, axis=(1, 2))[:, None, None]
    # (v - a) × (x - a) for all x, a, v
    determinant = dx[:, None] * dy.transpose(0, 2, 1)[..., None]
    determinant -= dy[:, None] * dx.transpose(0, 2, 1)[..., None]
    np.subtract((determinant > 0).view(np.int8), (determinant < 0).view(np.int8), out=signs)
    doubtful = np.abs(determinant, out=determinant) <= (_ERROR_BOUND * largest * size)[:, None]
    vertex = np.arange(signs.shape[1])
    doubtful[:, vertex, :, vertex] = False
    if doubtful.any():
        row, x, k, v = np.nonzero(doubtful)
        signs[row, x, k, v] = orientation(origins[row, k], vertices[row, v], vertices[row, x])


def facet_sides(signs: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Side of every vertex relative to every facet: (B, V, F) int8, +1 on the inner side, 0 for padding."""
    return np.take_along_axis(signs[:, :, :-1], starts[:, None, 1:, None], axis=3)[..., 0]


def possible_elements(signs: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """Which entries of the connection table can be elements: (B, F, V) bool.

    Facet f and vertex v form an element if the triangle has positive area, its closure holds no vertex but its own three,
    and its two new edges cross no facet.
    """
    starts = edge_starts(n_contour)
    sides = facet_sides(signs, starts)
    facet, vertex = np.arange(sides.shape[2]), np.arange(signs.shape[1])
    present = vertex < (n_contour + n_inner)[:, None]
    other = (vertex[:, None] != facet) & (vertex[:, None] != starts[:, None, 1:]) & present[..., None]
    # x in the closed triangle (a, b, v): on the left of or on a -> b, b -> v and v -> a.
    within = (signs[:, :, :-1] <= 0) & (signs[:, :, 1:] >= 0)
    within &= ((sides >= 0) & other)[..., None]
    within[:, vertex, :, vertex] = False
    crossed = _crossing_contour(signs, sides, starts)
    return (sides.transpose(0, 2, 1) > 0) & ~within.any(axis=1) & ~crossed[:, :-1] & ~crossed[:, 1:]


def _crossing_contour(signs: np.ndarray, sides: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Which edges from a contour vertex a to a vertex v properly cross a facet: (B, F + 1, V) bool."""
    # Do the facet's ends lie on different sides of edge (a, v), and a and v on different sides of the facet?
    rows = np.arange(len(starts))[:, None]
    ends_apart = signs[:, : sides.shape[2]] * signs[rows, starts[:, 1:]] < 0
    sides_of = sides.transpose(0, 2, 1)
    ends_apart &= sides[rows, starts].transpose(0, 2, 1)[..., None] * sides_of[:, :, None] < 0
    return ends_apart.any(axis=1)


def crossed_edges(
    signs: np.ndarray, starts: np.ndarray, row: np.ndarray, start: np.ndarray, end: np.ndarray
) -> np.ndarray:
    """Which edges (a, v) of contours `row` properly cross the contour's edge from `start` to `end`: (n, F + 1, V) bool.

    row, start, end: (n,); start: index into `edge_starts`; end: vertex.
    """
    side = signs[row, :, start, end]
    side_of_starts = np.take_along_axis(side, starts[row], axis=1)
    end_vertex = signs[row, end]
    start_vertex = signs[row, starts[row, start]]
    return (start_vertex * end_vertex < 0) & (side_of_starts[..., None] * side[:, None] < 0)
