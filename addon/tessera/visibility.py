"""Which elements are possible: exact signs of all triangles on contour vertices, and the tests made of them.

Every decision of the triangulation is taken from exact signs, so no two decisions can contradict each other. They are
computed once a recursion level, as batched products of small matrices in single precision; what the error bound leaves
open goes to `predicates.orientation`.
"""

import numpy as np

from .predicates import orientation

# Signs are first taken in single precision, u = 2^-24, with a contour's largest offset as unit. An offset is off by at
# most 2 u of itself, one of them is scaled (another u), a product adds u, their difference u: 6 u (|left| + |right|) in
# all. The bound is 8 u = 2^-21 of a number that is at least |left| + |right|.
_ERROR_BOUND = 2.0**-21
# Signs computed at a time, so that the temporaries stay in the processor's cache.
_BLOCK_SIZE = 1 << 17


def edge_starts(n_contour: np.ndarray) -> np.ndarray:
    """Contour vertices from which edges start: (B, max n_contour + 1), 0 to n_contour - 1, then 0 again (and padding).

    Facet f of a contour runs from entry f to entry f + 1.
    """
    index = np.arange(int(n_contour.max()) + 1)
    return np.where(index < n_contour[:, None], index, 0)


def edge_signs(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """Side of every vertex relative to every line through a contour vertex and another vertex, exact.

    points: (B, V, 2) float64, rows of contour vertices, then inner vertices, then padding; n_contour, n_inner: (B,).
    Returns signs (B, V, F + 1, V) int8, F = max n_contour: `signs[:, x, k, v]` is +1 if x lies left of the line from
    the k-th of `edge_starts` to v, 0 on it. Entries of padding are 0.
    """
    starts = edge_starts(n_contour)
    n_rows, width = points.shape[:2]
    vertex = np.arange(width)
    present = vertex < (n_contour + n_inner)[:, None]
    points = np.where(present[..., None], points, points[:, :1])
    pair = (starts[..., None] != vertex) & present[:, None]
    pair &= (np.arange(starts.shape[1]) <= n_contour[:, None])[..., None]
    signs = np.empty((n_rows, width, starts.shape[1], width), dtype=np.int8)
    block = max(1, _BLOCK_SIZE // (signs[:1].size))
    for first in range(0, n_rows, block):
        rows = slice(first, first + block)
        _block_signs(points[rows], starts[rows], pair[rows], signs[rows])
    return signs


def _block_signs(points: np.ndarray, starts: np.ndarray, pair: np.ndarray, signs: np.ndarray) -> None:
    """Fill `signs`, the result of `edge_signs`, for a few contours; pair (B, F + 1, V): two different vertices."""
    x, y = np.ascontiguousarray(points.transpose(2, 0, 1))
    unit = np.maximum(np.ptp(x, axis=1), np.ptp(y, axis=1))[:, None, None]
    n_rows, width, n_starts = signs.shape[:3]
    to_vertex = np.empty((n_rows, width, 2, width), dtype=np.float32)
    to_vertex[:, :, 0] = (y[:, None] - y[:, :, None]) / unit
    to_vertex[:, :, 1] = (x[:, None] - x[:, :, None]) / unit
    start_x = (np.take_along_axis(x, starts, axis=1)[:, None] - x[:, :, None]) / unit
    start_y = (np.take_along_axis(y, starts, axis=1)[:, None] - y[:, :, None]) / unit
    bound = _ERROR_BOUND * (np.abs(start_x) + np.abs(start_y))
    bound[bound == 0] = 1
    to_start = np.empty((n_rows, width, n_starts, 2), dtype=np.float32)
    to_start[..., 0] = start_x / bound
    to_start[..., 1] = -start_y / bound
    # (start - x) × (vertex - x), in units of the error bound
    determinant = to_start @ to_vertex
    np.subtract((determinant > 1).view(np.int8), (determinant < -1).view(np.int8), out=signs)
    distinct = pair[:, None] & pair.transpose(0, 2, 1)[..., None]
    vertex = np.arange(width)
    distinct[:, vertex, :, vertex] = False
    signs *= distinct.view(np.int8)
    distinct &= signs == 0
    doubtful = np.flatnonzero(distinct)
    if len(doubtful):
        row, third, k, v = np.unravel_index(doubtful, signs.shape)
        signs[row, third, k, v] = orientation(points[row, starts[row, k]], points[row, v], points[row, third])


def facet_sides(signs: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Side of every vertex relative to every facet: (B, V, F) int8, +1 on the inner side, 0 for padding."""
    return np.take_along_axis(signs[:, :, :-1], starts[:, None, 1:, None], axis=3)[..., 0]


def possible_elements(signs: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """Which entries of the connection table can be elements: (B, F, V) bool.

    Facet f and vertex v form an element if the triangle has positive area, its closure holds no vertex but its own
    three, and its two new edges cross no facet.
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
