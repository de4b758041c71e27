"""The cavities that elements leave open: their boundaries, and the sub-contours that they become.

A contour's 2 F places hold the edges of all its cavities. Place 2 f holds facet f or, once f is connected to a vertex
v, the edge from f's start to v; place 2 f + 1 then holds the edge from v to f's end. The cavity lies on their left, and
going through the places in cyclic order is a walk around all cavities together.

The walk may pass a vertex several times: a passage is an arrival and the departure after it. Around the vertex the
passages lie counter-clockwise in the order of the walk, as facets do and edges do not cross, and between two of them in
turn lies a cavity. So what arrives in one passage is followed by what left in the passage before, cyclically; that
makes the groups of the listing, whatever the order in which the elements came. The passages of two vertices never take
turns (x, y, x, y), because the elements at one of them part the walk between those of the other. So a cavity is one
stretch of the walk with whole stretches left out, and its places in ascending order are its edges in order.
"""

from dataclasses import dataclass

import numpy as np

from .visibility import as_bools, edge_starts

_NOWHERE = 1 << 40  # start of an empty place, behind all vertices


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


def sub_contours(
    contours: Contours, apex: np.ndarray, sides: np.ndarray, not_lower: np.ndarray, bits: np.ndarray
) -> Contours:
    """What elements leave of every contour: its cavities as contours, with the inner vertices that lie in them.

    apex: (B, F) int64, the vertex that each facet is connected to, -1 where there is none; sides: `edge_sides`;
    not_lower: (B, V) words, the vertices not lower than each; bits: (B, V) words of the vertices.
    """
    parent, row, place = _cavities(contours.n_contour, apex)
    facet, odd = place >> 1, place & 1
    apex = np.where(apex < 0, edge_starts(contours.n_contour)[:, 1:], apex)
    first = np.searchsorted(row, np.arange(len(parent)))
    n_contour = np.bincount(row, minlength=len(parent))
    inside = _free_vertices(contours.n_contour, apex, bits)[parent]
    at, apex = row, apex[parent[row], facet]
    vertex = np.where(odd, apex, facet)
    (open_ones,) = np.nonzero(inside)
    if len(open_ones):
        # A cavity holds the vertices from which a ray along x passes its boundary's edges an odd number of times.
        (edges,) = np.nonzero((inside != 0)[at])
        owner, start, apex = parent[at[edges]], (facet + odd)[edges], apex[edges]
        left, right = sides[owner, apex, start].T
        over_start, over_apex = not_lower[owner, start % contours.n_contour[owner]], not_lower[owner, apex]
        passed = (over_start & ~over_apex & left) | (~over_start & over_apex & right)
        size = n_contour[open_ones]
        inside[open_ones] &= np.bitwise_xor.reduceat(passed, np.cumsum(size) - size)
    inner_cavity, inner = np.nonzero(as_bools(inside, bits[parent]))
    n_inner = np.bincount(inner_cavity, minlength=len(parent))
    local = np.zeros((len(parent), int((n_contour + n_inner).max(initial=3))), dtype=np.int64)
    local[at, np.arange(len(at)) - first[at]] = vertex
    before = np.cumsum(n_inner) - n_inner - n_contour
    local[inner_cavity, np.arange(len(inner)) - before[inner_cavity]] = inner
    return Contours(
        contours.points[parent[:, None], local],
        contours.slots[parent[:, None], local],
        contours.owner[parent],
        n_contour,
        n_inner,
    )


def _cavities(n_contour: np.ndarray, apex: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cavities: the contours (c,) that they are in, and of all their edges (e,) the cavity and the place, in order."""
    (n_rows, n_facets), n_places = apex.shape, 2 * apex.shape[1]
    facet = np.broadcast_to(np.arange(n_facets), apex.shape)
    present = facet < n_contour[:, None]
    active = np.stack([present, present & (apex >= 0)], axis=2).reshape(n_rows, -1)
    start = np.where(active, np.stack([facet, apex], axis=2).reshape(n_rows, -1), _NOWHERE)
    # Places count through all contours from here on; `first` is each contour's first.
    index = np.arange(n_places)
    first = n_places * np.arange(n_rows)[:, None]
    order = first + np.argsort(start * n_places + index, axis=1)
    departure = np.empty_like(order)
    departure.put(order, order.take(first + _previous_alike(start.take(order))))
    # After each place comes the next one in use; what follows it is the departure before that.
    after = np.minimum.accumulate(np.where(active, index, n_places)[:, ::-1], axis=1)[:, -2::-1]
    after = np.concatenate([after, np.full((n_rows, 1), n_places)], axis=1) % n_places
    following = departure.take(first + after)
    # Two edges there and back are one edge with an element on either side: nothing of the cavity is left.
    active &= following.take(following) != first + index
    # A cavity's number is its lowest place.
    number = first + index
    for _ in range(n_places.bit_length()):
        number = np.minimum(number, number.take(following))
        following = following.take(following)
    place = np.flatnonzero(active)
    number = number.take(place)
    order = np.argsort(number, kind="stable")
    number, place = number[order], place[order]
    begins = np.diff(number, prepend=-1) != 0
    return number[begins] // n_places, np.cumsum(begins) - 1, place % n_places


def _previous_alike(values: np.ndarray) -> np.ndarray:
    """For each of the ascending values (B, n), where the one before it of the same value is, cyclic: (B, n)."""
    index = np.arange(values.shape[1])
    changes = np.ones((len(values), values.shape[1] + 1), dtype=bool)
    np.not_equal(values[:, 1:], values[:, :-1], out=changes[:, 1:-1])
    last = np.where(changes[:, 1:], index, values.shape[1])
    last = np.minimum.accumulate(last[:, ::-1], axis=1)[:, ::-1]
    return np.where(changes[:, :-1], last, index - 1)


def _free_vertices(n_contour: np.ndarray, apex: np.ndarray, bits: np.ndarray) -> np.ndarray:
    """Inner vertices that no element uses yet: words (B,). apex: (B, F), of unconnected facets a contour vertex."""
    index = np.arange(bits.shape[1])
    free = bits * (index >= n_contour[:, None])
    np.put_along_axis(free, apex, free[:, :1], axis=1)
    return np.bitwise_or.reduce(free, axis=1)
