"""Which elements are possible: on which side of all lines through a contour vertex all vertices lie, and the tests.

Every decision of the triangulation is taken from these sides, so no two decisions can contradict each other. They are
computed once for all levels of the recursion, as batched products of small matrices in single precision, by
onnxruntime, whose products of such matrices take a third of numpy's time; what the error bound leaves open goes to
`predicates.orientation`. They are kept as words, one bit for each vertex, and one operation on words tests a line or a
triangle against all vertices at once. Arrays of words that much is done with have the contours last, as operations on
long rows are fast.

Words are unsigned integers or, for more than 64 bits, Python's own in object arrays: the same operators, only slower.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from .predicates import orientation
from .runtime import MODELS, open_session

if TYPE_CHECKING:
    import onnxruntime

# Single precision, u = 2^-24, with every contour moved and stretched into [-1, 1]² (up to twice that if it is a few
# ulps wide, which the rest of the bound covers). Rounding a vertex changes a determinant by at most 4 u, so three do
# by 12 u. Of its three products, those of a coordinate and a coefficient are below 2 with an error of 4 u each, the
# constant term has 4 u, and adding them, in whatever order, has less than 12 u. The bound is nearly twice the sum, 36
# u.
_ERROR_BOUND = np.float32(2.0**-18)
# Determinants computed at a time, so that they stay in the processor's cache.
_BLOCK_SIZE = 1 << 17


@cache
def bits_of(n_bits: int) -> np.ndarray:
    """Words (n_bits,), the i-th with bit i set; of the smallest type that holds them all. Not to be written to."""
    bits = np.array([1 << bit for bit in range(n_bits)], dtype=object)
    for dtype in (np.uint64, np.uint32, np.uint16, np.uint8):
        if n_bits <= 8 * np.dtype(dtype).itemsize:
            bits = bits.astype(dtype)
    bits.setflags(write=False)
    return bits


def as_bools(words: np.ndarray, bits: np.ndarray) -> np.ndarray:
    """Words (...) as (..., len(bits)) bool."""
    return (words[..., None] & bits) != 0


def edge_starts(n_contour: np.ndarray) -> np.ndarray:
    """Contour vertices from which edges start: (B, max n_contour + 1), 0 to n_contour - 1, then 0 again (and padding).

    Facet f of a contour runs from entry f to entry f + 1.
    """
    index = np.arange(int(n_contour.max()) + 1)
    return np.where(index < n_contour[:, None], index, 0)


def vertex_sides(points: np.ndarray, n_vertices: np.ndarray) -> np.ndarray:
    """Which vertices lie left and which right of every line through two vertices, exact.

    points: (B, V, 2) float64, rows of n_vertices (B,) distinct vertices, then padding. Returns words (B, V, V, 2): bit
    x of `sides[:, v, u, 0]` is set if vertex x lies strictly left of the line from u to v, and of `sides[:, v, u, 1]`
    if strictly right. Padding is on no side; lines through padding mean nothing.
    """
    n_rows, width = points.shape[:2]
    bits = bits_of(width)
    present = np.arange(width) < n_vertices[:, None]
    coordinates = np.where(present[:, None], points.transpose(0, 2, 1), points[:, 0, :, None])
    low, high = coordinates.min(axis=2, keepdims=True), coordinates.max(axis=2, keepdims=True)
    middle, half = low + (high - low) / 2, (high - low) / 2
    vertices = np.zeros((n_rows, 3, padded_size(width)), dtype=np.float32)
    vertices[:, :2, :width] = (coordinates - middle) / np.where(half > 0, half, 1) * present[:, None]
    vertices[:, 2, :width] = present
    u, v, place = _lines(width)
    n_lines = len(u)
    # Left of all lines, right of them, and nothing.
    words = np.zeros((n_rows, 2 * n_lines + 1), dtype=bits.dtype)
    block = max(1, _BLOCK_SIZE // (n_lines * vertices.shape[2]))
    for first in range(0, n_rows, block):
        rows = slice(first, first + block)
        determinant = _determinants(vertices[rows], u, v)
        words[rows, :n_lines] = pack_words(determinant > _ERROR_BOUND, bits.dtype)
        words[rows, n_lines:-1] = pack_words(determinant < -_ERROR_BOUND, bits.dtype)
    _decide_doubtful(words[:, :n_lines], words[:, n_lines:-1], points, u, v, present, bits)
    return words.take(place, axis=1)


@lru_cache(64)
def _lines(width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The lines (L,) between two of so many vertices, each in one direction, from the first to the second.

    And where the words of what lies left and right of the line to each vertex from each other one (V, V, 2) are, in
    those left of all lines, then right of them, then none.
    """
    u, v = np.triu_indices(width, 1)
    n_lines = len(u)
    place = np.full((width, width, 2), 2 * n_lines)
    place[v, u, 0] = place[u, v, 1] = np.arange(n_lines)
    place[v, u, 1] = place[u, v, 0] = n_lines + np.arange(n_lines)
    for array in (u, v, place):
        array.setflags(write=False)
    return u, v, place


def _determinants(vertices: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(B, L, V) twice the signed areas of the triangles of lines from u to v (L,), and vertices (x, y, 1) (B, 3, V).

    A line has (x, y) on its left if (b - d) x + (c - a) y + (a d - b c) > 0.
    """
    (a, b), (c, d) = (vertices[:, :2].take(end, axis=2).swapaxes(0, 1) for end in (u, v))
    lines = np.empty((len(vertices), 3, len(u)), dtype=np.float32)
    np.subtract(b, d, out=lines[:, 0])
    np.subtract(c, a, out=lines[:, 1])
    np.subtract(a * d, b * c, out=lines[:, 2])
    return _product().run(None, {"lines": lines, "vertices": vertices})[0]


@cache
def _product() -> onnxruntime.InferenceSession:
    """Products (B, L, V) of lines (B, 3, L) and vertices (B, 3, V).

    Always on the processor, as the error bound is that of single precision. Raises RuntimeProblem.
    """
    return open_session(MODELS / "determinants.onnx")


def padded_size(n_bits: int) -> int:
    """How many bools `pack_words` wants for a word of so many bits."""
    return max(8, 1 << (n_bits - 1).bit_length())


def pack_words(bools: np.ndarray, dtype: np.dtype) -> np.ndarray:
    """Words (...) of contiguous bools (..., `padded_size`)."""
    packed = np.packbits(bools.reshape(-1), bitorder="little")
    if not dtype.hasobject:
        return packed.view(dtype.newbyteorder("<")).reshape(bools.shape[:-1])
    parts = packed.view("<u8").reshape(-1, bools.shape[-1] // 64).astype(object)
    return np.bitwise_or.reduce(parts << np.arange(0, bools.shape[-1], 64), axis=1).reshape(bools.shape[:-1])


def _decide_doubtful(
    left: np.ndarray,
    right: np.ndarray,
    points: np.ndarray,
    u: np.ndarray,
    v: np.ndarray,
    present: np.ndarray,
    bits: np.ndarray,
) -> None:
    """Set the bits in `left` and `right` (B, L) of lines u -> v (L,) that single precision has left open.

    present: (B, V), which vertices are no padding.
    """
    width = len(bits)
    doubtful = ~(left | right)
    doubtful &= np.bitwise_or.reduce(present * bits, axis=1)[:, None]
    doubtful &= ~(bits[u] | bits[v])
    # Most lines have nothing doubtful, or run through padding.
    open_lines = np.flatnonzero((doubtful != 0) & present.take(v, axis=1))
    if not len(open_lines):
        return
    row, line = np.unravel_index(open_lines, left.shape)
    index, third = np.nonzero(as_bools(doubtful[row, line], bits))
    # Each triangle is looked at once, whatever line and vertex it comes from.
    a, b = u[line[index]], v[line[index]]
    even = (third < a) == (third < b)
    a, b, c = np.minimum(a, third), np.clip(third, a, b), np.maximum(b, third)
    key, place = np.unique(((row[index] * width + a) * width + b) * width + c, return_inverse=True)
    key, c = np.divmod(key, width)
    key, b = np.divmod(key, width)
    owner, a = np.divmod(key, width)
    turn = orientation(points[owner, a], points[owner, b], points[owner, c])[place] * np.where(even, 1, -1)
    for side, sign in ((left, 1), (right, -1)):
        found = np.zeros((len(row), width), dtype=bool)
        found[index, third] = turn == sign
        side[row, line] |= np.bitwise_or.reduce(found * bits, axis=1)


def edge_sides(sides: np.ndarray, owner: np.ndarray, slots: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """The part of `vertex_sides` that is about lines from contour vertices of (sub-)contours: words (B, V, K, 2).

    owner (B,), slots (B, V): whose vertices they have, and which. `[:, v, k]` is about the line from the k-th of
    `edge_starts` to vertex v, K = max n_contour + 1; the bits stay those of the owner's vertices.
    """
    width = sides.shape[1]
    starts = np.take_along_axis(slots, edge_starts(n_contour), axis=1)
    place = ((owner[:, None] * width + slots) * width)[..., None] + starts[:, None]
    return sides.reshape(-1, 2).take(place, axis=0)


def lines_to(sides: np.ndarray, rows: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """The part of `edge_sides` that is about lines to `vertices` (m, n) of contours `rows` (n,): words (m, K, 2, n)."""
    found = sides.reshape(-1, 2 * sides.shape[2]).take((rows * sides.shape[1] + vertices).T, axis=0)
    return _contours_last(found).reshape(-1, *sides.shape[2:], len(rows))


def _contours_last(words: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(words.reshape(len(words), -1).T)


def possible_elements(sides: np.ndarray, bits: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """Which entries of the connection table can be elements: words (F, B), the bit of vertex v of facet f.

    Facet f and vertex v form an element if the triangle has positive area, its closure holds no vertex but its own
    three, and its two new edges cross no facet. sides: `edge_sides`; bits: (B, V) words of the vertices, 0 for padding.
    """
    ends = edge_starts(n_contour)[:, 1:].T
    n_rows, n_facets = len(sides), len(ends)
    rows, facets, bits = np.arange(n_rows), np.arange(n_facets), bits.T.copy()
    to_ends = lines_to(sides, rows, ends)
    end_bits = bits[ends, rows]
    edges = to_ends[facets, facets]
    # x is in the closed triangle (a, b, v) if it is on the left of or on a -> b, and v neither left of b -> x nor right
    # of a -> x. So the vertices that x leaves free are:
    to_all = _contours_last(sides).reshape(*sides.shape[1:], n_rows)
    free = to_all[:, 1:, 0] | to_all[:, :-1, 1]
    free |= bits[:, None]
    on_side = ~(edges[:, 1] | bits[:n_facets] | end_bits)
    # All bits where it is on no side: 0 less 1.
    free |= np.minimum(on_side & bits[:, None], 1) - 1
    crossed = crossing(to_all[:n_facets], to_ends, edges, end_bits)
    possible = edges[:, 0] & np.bitwise_and.reduce(free, axis=0) & ~(crossed[:-1] | crossed[1:])
    return possible & np.bitwise_or.reduce(bits, axis=0)


def crossing(to_start: np.ndarray, to_end: np.ndarray, edges: np.ndarray, end_bits: np.ndarray) -> np.ndarray:
    """Which lines from contour vertices properly cross one of m edges: words (K, n), the bit of v of start k.

    to_start, to_end (m, K, 2, n): `lines_to` the edges' vertices; edges (m, 2, n): the vertices left and right of the
    edge; end_bits (m, n): the bit of its second vertex.
    """
    # With k left of s -> e, the line from k to v crosses if v is right of s -> e, left of k -> s and right of k -> e;
    # k is left if e is left of k -> s.
    crossed = np.minimum(to_start & end_bits[:, None, None], 1)
    crossed *= to_start
    crossed &= to_end[:, :, ::-1]
    crossed &= edges[:, None, ::-1]
    crossed = np.bitwise_or.reduce(crossed, axis=0)
    return crossed[:, 0] | crossed[:, 1]
