"""The cavities that elements leave open: their boundaries, their splitting, and the sub-contours that they become.

A contour's 2 F edge places hold the boundaries of all its cavities. Place 2 f holds facet f or, once f is connected to
a vertex v, the edge from f's start to v; place 2 f + 1 then holds the edge from v to f's end. The cavity lies on their
left. Going around a cavity is going through its places in cyclic order: connecting facet f puts its two new edges
where f was, and if v already is on the cavity's boundary, the places after f and before v's become a cavity of their
own. Sets of places are words, one bit for each.
"""

from dataclasses import dataclass

import numpy as np

from .visibility import as_bools, bits_of, edge_starts


@dataclass(frozen=True)
class Contours:
    """A batch of (sub-)contours, contour vertices first: `slots` are their vertices in the point row `owner`."""

    points: np.ndarray  # (B, V, 2) float64
    slots: np.ndarray  # (B, V) int32
    owner: np.ndarray  # (B,) int32
    n_contour: np.ndarray  # (B,) int64
    n_inner: np.ndarray  # (B,) int64

    def rows(self, rows: np.ndarray | slice) -> "Contours":
        """The chosen contours, their padding trimmed."""
        n_contour, n_inner = self.n_contour[rows], self.n_inner[rows]
        width = int((n_contour + n_inner).max(initial=0))
        return Contours(self.points[rows, :width], self.slots[rows, :width], self.owner[rows], n_contour, n_inner)


@dataclass(frozen=True)
class Boundaries:
    """State of a batch's cavities. Filled in place by `add_elements` while a level is triangulated."""

    bits: np.ndarray  # (2 F,) words: the places
    apex: np.ndarray  # (B, F) int64: the vertex that facet f is connected to, or else the end of f
    from_vertex: np.ndarray  # (B, V) words: places whose edge starts, or started, from the vertex
    cavity: np.ndarray  # (B, F + 1) words: the places of each cavity, by its number; 0 where nothing of it is left


def join(parts: list[Contours]) -> Contours:
    """One batch of several, padded to the widest."""
    if len(parts) == 1:
        return parts[0]
    ends = np.cumsum([len(part.owner) for part in parts])
    width = max(part.points.shape[1] for part in parts)
    points, slots = np.zeros((ends[-1], width, 2)), np.zeros((ends[-1], width), dtype=np.int32)
    for part, end in zip(parts, ends, strict=True):
        place = slice(end - len(part.owner), end), slice(part.points.shape[1])
        points[place], slots[place] = part.points, part.slots
    return Contours(
        points,
        slots,
        np.concatenate([part.owner for part in parts]),
        np.concatenate([part.n_contour for part in parts]),
        np.concatenate([part.n_inner for part in parts]),
    )


def open_contours(n_contour: np.ndarray, width: int) -> Boundaries:
    """One cavity, of number 0, for every contour of `width` vertices with padding: the contour itself."""
    starts = edge_starts(n_contour)
    n_rows, n_facets = len(n_contour), starts.shape[1] - 1
    bits = bits_of(2 * n_facets)
    of_facets = bits[::2]
    from_vertex = np.zeros((n_rows, width), dtype=of_facets.dtype)
    from_vertex[:, :n_facets] = of_facets
    cavity = np.zeros((n_rows, n_facets + 1), dtype=of_facets.dtype)
    cavity[:, 0] = np.bitwise_or.accumulate(of_facets)[n_contour - 1]
    return Boundaries(bits, starts[:, 1:].copy(), from_vertex, cavity)


def add_elements(boundaries: Boundaries, row: np.ndarray, facet: np.ndarray, vertex: np.ndarray, number: int) -> None:
    """Add element (facet, vertex) to each of the contours `row` (n,); a cavity that it splits off becomes `number`."""
    bit = boundaries.bits[2 * facet]
    own = (boundaries.cavity[row, :number] & bit[:, None] != 0).argmax(axis=1)
    cavity = boundaries.cavity[row, own]
    at = boundaries.from_vertex[row, vertex] & cavity
    after = bit << 1
    # The places after the facet's and before the vertex's, cyclic; none if the vertex is not on the boundary.
    between = (at - 1) ^ (after - 1)
    between = np.where(at < bit, ~between, between)
    cavity |= after
    part = np.where(at != 0, cavity & between, at)
    left = np.array([cavity ^ part, part])
    # Two edges there and back are an edge between two elements: nothing of the cavity is left.
    without_lowest = left & (left - 1)
    left *= without_lowest & (without_lowest - 1) != 0
    boundaries.cavity[row, own], boundaries.cavity[row, number] = left
    boundaries.from_vertex[row, vertex] |= after
    boundaries.apex[row, facet] = vertex


def sub_contours(
    contours: Contours, boundaries: Boundaries, sides: np.ndarray, below: np.ndarray, bits: np.ndarray
) -> Contours:
    """What is left of every contour: its cavities as contours, with the inner vertices that lie in them.

    sides: `edge_sides`; below: (B, V) words, the vertices not lower than each; bits: (B, V) words of the vertices.
    """
    parent, number = np.nonzero(boundaries.cavity)
    cavity, place = np.nonzero(as_bools(boundaries.cavity[parent, number], boundaries.bits))
    n_contour = np.bincount(cavity, minlength=len(parent))
    first = np.cumsum(n_contour) - n_contour
    row, facet, odd = parent[cavity], place >> 1, place & 1
    apex = boundaries.apex[row, facet]
    vertex = np.where(odd, apex, facet)
    inside = _free_vertices(contours.n_contour, boundaries, bits)[parent]
    (open_ones,) = np.nonzero(inside)
    if len(open_ones):
        # A cavity holds the vertices from which a ray along x passes its boundary's edges an odd number of times.
        (edges,) = np.nonzero((inside != 0)[cavity])
        row, start, apex = row[edges], (facet + odd)[edges], apex[edges]
        left, right = sides[row, apex, start].T
        start_below, apex_below = below[row, start % contours.n_contour[row]], below[row, apex]
        passed = (start_below & ~apex_below & left) | (~start_below & apex_below & right)
        size = n_contour[open_ones]
        inside[open_ones] &= np.bitwise_xor.reduceat(passed, np.cumsum(size) - size)
    inner_cavity, inner = np.nonzero(as_bools(inside, bits[parent]))
    n_inner = np.bincount(inner_cavity, minlength=len(parent))
    local = np.zeros((len(parent), int((n_contour + n_inner).max(initial=3))), dtype=np.int64)
    local[cavity, np.arange(len(cavity)) - first[cavity]] = vertex
    before = np.cumsum(n_inner) - n_inner - n_contour
    local[inner_cavity, np.arange(len(inner)) - before[inner_cavity]] = inner
    return Contours(
        contours.points[parent[:, None], local],
        contours.slots[parent[:, None], local],
        contours.owner[parent],
        n_contour,
        n_inner,
    )


def _free_vertices(n_contour: np.ndarray, boundaries: Boundaries, bits: np.ndarray) -> np.ndarray:
    """Inner vertices that no element uses yet: words (B,)."""
    index = np.arange(bits.shape[1])
    free = bits * (index >= n_contour[:, None])
    np.put_along_axis(free, boundaries.apex, free[:, :1], axis=1)
    return np.bitwise_or.reduce(free, axis=1)
