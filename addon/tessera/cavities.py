"""The cavities that elements leave open: groups of edges, their splitting, and the sub-contours that they become.

A contour's 2 F edge places hold the boundaries of all its cavities. Place 2 f holds facet f or, once f is connected to
a vertex v, the edge from f's start to v; place 2 f + 1 then holds the edge from v to f's end. The cavity lies on their
left. Going around a cavity is going through its places in cyclic order: connecting facet f puts its two new edges
where f was, and if v already is on the cavity's boundary, the places after f and before v's become a cavity of their
own.
"""

from dataclasses import dataclass

import numpy as np

from .visibility import edge_starts


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

    apex: np.ndarray  # (B, F) int16: the vertex that facet f is connected to, or else the end of f
    start: np.ndarray  # (B, 2 F) int16: the vertex that the edge in each place starts from
    group: np.ndarray  # (B, 2 F) int16: the cavity's number, -1 where the place is empty


def join(parts: list[Contours]) -> Contours:
    """One batch of several, padded to the widest."""
    width = max(part.points.shape[1] for part in parts)
    padding = [((0, 0), (0, width - part.points.shape[1])) for part in parts]
    return Contours(
        np.concatenate([np.pad(part.points, (*pad, (0, 0))) for part, pad in zip(parts, padding, strict=True)]),
        np.concatenate([np.pad(part.slots, pad) for part, pad in zip(parts, padding, strict=True)]),
        np.concatenate([part.owner for part in parts]),
        np.concatenate([part.n_contour for part in parts]),
        np.concatenate([part.n_inner for part in parts]),
    )


def open_contours(n_contour: np.ndarray) -> Boundaries:
    """One cavity for every contour: the contour itself."""
    starts = edge_starts(n_contour).astype(np.int16)
    n_rows, n_facets = len(n_contour), starts.shape[1] - 1
    group = np.full((n_rows, 2 * n_facets), -1, dtype=np.int16)
    group[:, ::2] = np.where(np.arange(n_facets) < n_contour[:, None], 0, -1)
    return Boundaries(starts[:, 1:].copy(), np.repeat(starts[:, :-1], 2, axis=1), group)


def add_elements(
    boundaries: Boundaries, row: np.ndarray, facet: np.ndarray, vertex: np.ndarray, number: int
) -> np.ndarray:
    """Add element (facet, vertex) to each of the contours `row` (n,); a cavity that it splits off becomes `number`.

    Returns which facets are used up: no cavity is left at their place: (n, F) bool.
    """
    boundaries.apex[row, facet] = vertex
    start, group = boundaries.start[row], boundaries.group[row]
    n, n_places = start.shape
    index, place = np.arange(n), 2 * facet
    own = group[index, place]
    same = group == own[:, None]
    meeting = same & (start == vertex[:, None])
    splits = meeting.any(axis=1)
    start[index, place + 1] = vertex
    group[index, place + 1] = own
    same[index, place + 1] = True
    # Distance in places from the facet, cyclic.
    distance = np.arange(n_places, dtype=np.int16) - place[:, None].astype(np.int16)
    distance += np.where(distance < 0, np.int16(n_places), np.int16(0))
    reach = np.where(splits, distance[index, meeting.argmax(axis=1)], 0)
    beyond = same & (distance > 0) & (distance < reach[:, None])
    group[beyond] = number
    # Two edges there and back are an edge between two elements: nothing of the cavity is left.
    group[beyond & (beyond.sum(axis=1) == 2)[:, None]] = -1
    rest = same & ~beyond
    group[rest & (rest.sum(axis=1) == 2)[:, None]] = -1
    boundaries.start[row], boundaries.group[row] = start, group
    return group[:, ::2] < 0


def sub_contours(contours: Contours, boundaries: Boundaries, signs: np.ndarray) -> Contours:
    """What is left of every contour: its cavities as contours, with the inner vertices that lie in them."""
    row, place = np.nonzero(boundaries.group >= 0)
    n_groups = int(boundaries.group.max(initial=0)) + 1
    key = row * n_groups + boundaries.group[row, place]
    order = np.argsort(key, kind="stable")
    row, place, key = row[order], place[order], key[order]
    vertex = boundaries.start[row, place]
    first = np.flatnonzero(np.diff(key, prepend=-1))
    n_contour = np.diff(first, append=len(key))
    cavity = np.repeat(np.arange(len(first)), n_contour)
    free_row, free_vertex = _free_vertices(contours, boundaries)
    inside = _group_around(contours, boundaries, signs, free_row, free_vertex)
    free_cavity = np.searchsorted(key[first], free_row * n_groups + inside)
    order = np.argsort(free_cavity, kind="stable")
    free_vertex, free_cavity = free_vertex[order], free_cavity[order]
    n_inner = np.bincount(free_cavity, minlength=len(first))
    position = np.arange(len(key)) - first[cavity]
    before = np.cumsum(n_inner) - n_inner
    free_position = n_contour[free_cavity] + np.arange(len(free_cavity)) - before[free_cavity]
    local = np.zeros((len(first), int((n_contour + n_inner).max(initial=3))), dtype=np.int64)
    local[cavity, position] = vertex
    local[free_cavity, free_position] = free_vertex
    parent = row[first]
    return Contours(
        contours.points[parent[:, None], local],
        contours.slots[parent[:, None], local],
        contours.owner[parent],
        n_contour,
        n_inner,
    )


def _free_vertices(contours: Contours, boundaries: Boundaries) -> tuple[np.ndarray, np.ndarray]:
    """Inner vertices that no element uses yet, as (row, vertex)."""
    index = np.arange(contours.points.shape[1])
    free = (index >= contours.n_contour[:, None]) & (index < (contours.n_contour + contours.n_inner)[:, None])
    np.put_along_axis(free, boundaries.apex.astype(np.int64), False, axis=1)
    return np.nonzero(free)


def _group_around(
    contours: Contours, boundaries: Boundaries, signs: np.ndarray, row: np.ndarray, vertex: np.ndarray
) -> np.ndarray:
    """Number of the cavity in which each vertex (row, vertex) (k,) lies: (k,).

    Every cavity's boundary winds once around the vertices in it and not around others, so the sum of winding times
    number over all edges is the number sought.
    """
    starts = edge_starts(contours.n_contour)[row]
    apex = boundaries.apex[row].astype(np.int64)
    height = contours.points[row, :, 1]
    below = height <= height[np.arange(len(row)), vertex][:, None]
    total = np.zeros(len(row), dtype=np.int64)
    facet = np.arange(apex.shape[1])
    for first, begin, direction in ((0, facet, 1), (1, facet + 1, -1)):
        # Even places: from the facet's start to the apex. Odd ones: from the apex to the facet's end.
        side = signs[row[:, None], vertex[:, None], begin, apex]
        start_below = np.take_along_axis(below, starts[:, begin], axis=1)
        apex_below = np.take_along_axis(below, apex, axis=1)
        winding = (start_below & ~apex_below & (side > 0)).astype(np.int64)
        winding -= ~start_below & apex_below & (side < 0)
        total += direction * np.sum(winding * np.maximum(boundaries.group[row, first::2], 0), axis=1)
    return total
