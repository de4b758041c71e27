"""The triangulation algorithm (section 2.5.1, Algorithm 3): connection tables lead from contours to meshes, in batches.

All contours of a batch advance together: in one step, each connects the facet of its best entry with that entry's
vertex, and of the next best ones as many as would follow it (`overlaps.compatible`), and closes the entries that this
makes impossible. Beside the paper's listing:

- Line 7 (order of rows and columns): the best entry of each facet is kept, and the best of them is taken
  (`_connect_facets`, `entries.score_entries`).
- Line 9 (validate): an entry is possible if its triangle is counter-clockwise, holds no other vertex of the contour, on
  its sides neither, and its new edges cross no facet (`visibility.possible_elements`). After each new element the
  entries that overlap it are closed, so that the best entry left needs no validation (`overlaps.excluded_entries`). A
  facet whose best entry is closed takes its next best one (lines 11 and 14).
- Lines 10-12, 18-21 (group ids): found in the end, from where each facet's element goes (`cavities._cavities`); until
  then no decision needs them, as an entry whose facet and vertex are in different groups overlaps an element.
- Lines 13-15, 22-26 (V_locked, F_locked): a vertex is locked when no edge of any cavity starts from it, a facet when it
  is a side of an element. Their entries overlap an element too, so that there is no list of them: all three are in
  the words of entries that are still possible (`possible` in `_connect_facets`).
- Lines 28-30 (sub-contours): `cavities.sub_contours`; those of three edges without inner vertices are elements, and
  those of a few more get the best of all their triangulations (`closing.close`).
- Lines 31-34 (recursion): the others of all contours are the next level's batch: one call of NN3 for all (`_ask`).

Departures from the listing:

- It orders by q_worst, with q_mean for ties. But very often an entry's q_worst is due to an element elsewhere, so that
  any error of the table decides between entries that should tie. Here the order is that of the sum min(q_worst, q of
  the element itself) + q_mean. Calculated tables on 1 200 contours with Gmsh's inner vertices, against CDT: ē_worst and
  ē_mean are -0.1 and 0.0 % either way, but with normal errors of 0.02 in the tables 0.2 and 2.2 % by the paper's order,
  0.1 and 0.5 % by the sum. Near ties go to the better element; flat elements come last.
- It tries all vertices of a row before the next row. Here a facet whose best entry is closed waits until its next best
  one is the best left.

Why it always ends with a valid mesh, whatever the tables are:

1. Every decision is an exact sign. A possible element lies in its contour: beside its facet it does, and a facet that
   entered it would have an end in it that is no corner, cross a new edge, or start from a corner and leave across the
   opposite side, which is a new edge, or a facet that it would cross. Two possible elements overlap only if two of
   their edges cross properly or they lie on the same side of a common edge. For neither triangle holds a vertex of the
   other in its closure, apart from common ones: without proper crossing, edges could only meet in a vertex, or along
   each other with an end of one on the other. So one triangle would lie in the other, or a corner they share would have
   an edge of one enter the other, which it could leave only across the opposite side. These two cases are what
   `excluded_entries` closes. New edges start from contour vertices, as the third edge of every entry is a facet. If the
   common edge is a facet, new edges cross, as neither triangle holds the other's third vertex; or it is the same
   triangle, which has new edges in common too. So an entry that is left lies in one cavity, as its facet does.
2. What is left beside the elements is a set of simple polygons with the remaining vertices strictly inside, by
   induction. An element on facet (a, b) of such a polygon with apex v inside it leaves one: a, v, b replaces a, b, and
   v was not on it. With v on its boundary, it leaves the part from b to v and that from v to a. Each vertex but v is
   in one of them, each part visits it once, and a part of two edges is empty: they are one edge, common to two
   elements, or a facet and the side of the element that locks it. No vertex lies on a new edge, as elements hold no
   other vertex.
3. In a simple polygon with vertices strictly inside, every facet has a possible element. A simple polygon of more than
   three vertices has a diagonal, also with straight angles: with a convex vertex v and its neighbours u and w, either
   uw or the segment from v to the vertex in the closed triangle u, v, w farthest from uw. By induction it has a
   triangulation with elements of positive area, into which inner vertices can be put one after the other, splitting one
   element, or two if they lie on an edge. Its element on the facet is possible.
4. So every sub-contour always gets at least one element: if the table has no acceptable entry (finite, q_worst above
   0, the element not flat) for any possible element, the best one that a constrained Delaunay triangulation would have
   on a facet (ties by index), counted as a fallback. A full triangulation has exactly N_C + 2 N_I - 2 elements and
   those left to make go down with each one, so the recursion ends; elements that do not overlap, lie in the contour and
   reach this number cover it once and use every vertex.

Contours of a batch share nothing but array operations that treat each alone, and triangles are sorted in the end, so a
mesh does not depend on the batch that its contour is in.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .cavities import Contours, join, sub_contours
from .closing import close
from .entries import list_entries, score_entries
from .overlaps import compatible, excluded_entries
from .visibility import bits_of, edge_sides, pack_words, padded_size, possible_elements, vertex_sides

Connect = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]

# Where contours are divided by their number of vertices into groups of a level.
_SIZES = (5, 7, 10, 14, 18, 22, 26)
# Best entries of a contour that are looked at in a step: of many contours, and of few, whose calls cost more.
_TOGETHER = 3, 8
# So few contours join those of the next size, as calls cost more than padding.
_FEW = 128
# Size in bytes of the words of sides that are held at a time.
_CHUNK_SIZE = 1 << 27
_NOT_AS_DESCRIBED = "contour {} is no simple counter-clockwise polygon with its inner vertices inside"


@dataclass(frozen=True)
class Triangulation:
    """Meshes of a batch of contours, in the order of the contours."""

    triangles: np.ndarray  # (t, 3) int32, counter-clockwise slots of the owner's point row
    owner: np.ndarray  # (t,) int32
    fallbacks: np.ndarray  # (B,) int32: elements that were chosen by their own quality, as the table led nowhere


def triangulate(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, connect: Connect) -> Triangulation:
    """Mesh contours with inner vertices, led by connection tables (Algorithm 3).

    points: (B, V, 2) float64, each row n_contour vertices of a simple counter-clockwise polygon, then n_inner distinct
    vertices strictly inside, then padding of any value; n_contour, n_inner: (B,) int. connect: NN3, a function of
    points, n_contour and n_inner of contours in the same form, and of the entries that are possible elements (P, 3)
    int64, sorted (contour, facet, vertex) -> (P, 2) float64, their (q_worst, q_mean). It is asked once for all contours
    of a level of the recursion that `close` leaves, whose edges can be as many as a contour has vertices; contours of
    up to 32, up to 64 and more vertices, and parts of a large batch, go separately. Coordinates are within 1e±100, as
    `contour.py` sees to. Raises ValueError where no element is possible or the number of elements is not
    N_C + 2 N_I - 2, which is so only if a contour is not as described; other such contours may go unnoticed.
    """
    n_rows, width = points.shape[:2]
    n_contour, n_inner = np.asarray(n_contour, dtype=np.int64), np.asarray(n_inner, dtype=np.int64)
    elements, owners = [np.zeros((0, 3), dtype=np.int32)], [np.zeros(0, dtype=np.int32)]
    fallbacks = np.zeros(n_rows, dtype=np.int32)
    for rows in _chunks(n_contour + n_inner):
        triangles, owner, fallbacks[rows] = _triangulate(points[rows], n_contour[rows], n_inner[rows], rows, connect)
        elements.append(triangles)
        owners.append(rows[owner])
    triangles, owner = _in_order(np.concatenate(elements), np.concatenate(owners), width)
    wrong = np.flatnonzero(np.bincount(owner, minlength=n_rows) != n_contour + 2 * n_inner - 2)
    if len(wrong):
        raise ValueError(_NOT_AS_DESCRIBED.format(wrong[0]))
    return Triangulation(triangles, owner, fallbacks)


def _chunks(size: np.ndarray) -> Iterator[np.ndarray]:
    """Rows of contours of so many vertices (B,) that share a type of words, in pieces that are not too large."""
    word = np.digitize(size, (33, 65))
    for value in np.unique(word):
        rows = np.flatnonzero(word == value)
        width = int(size[rows].max())
        step = max(1, _CHUNK_SIZE // (width * width * 2 * bits_of(width).itemsize))
        for first in range(0, len(rows), step):
            yield rows[first : first + step]


def _triangulate(
    points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, number: np.ndarray, connect: Connect
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elements (t, 3), their rows (t,) and the fallbacks (B,) of some contours; number (B,): theirs in the batch."""
    n_rows, width = len(points), int((n_contour + n_inner).max())
    slots = np.broadcast_to(np.arange(width, dtype=np.int32), (n_rows, width))
    level = Contours(points[:, :width].astype(np.float64), slots, np.arange(n_rows, dtype=np.int32), n_contour, n_inner)
    bits = bits_of(width)
    sides, not_lower = _look_around(level, bits)
    elements, owners, fallbacks = [], [], np.zeros(n_rows, dtype=np.int32)
    while True:
        last, of, closed = close(level)
        elements.append(level.slots[of[:, None], last])
        owners.append(level.owner[of])
        level = level.rows(~closed)
        if not len(level.owner):
            break
        level, groups = _by_size(level)
        views = [_view(group, sides, bits) for group in groups]
        tables = _ask(level, groups, views, number, connect)
        rest = []
        for group, view, table in zip(groups, views, tables, strict=True):
            triangles, row, stuck, apex = _connect_facets(group, *view, *table)
            elements.append(np.take_along_axis(group.slots[row], triangles, axis=1))
            owners.append(group.owner[row])
            fallbacks += np.bincount(group.owner[stuck], minlength=n_rows).astype(np.int32)
            rest.append(sub_contours(group, apex, view[0], not_lower[group.owner[:, None], group.slots], view[1]))
        level = join(rest)
    return np.concatenate(elements), np.concatenate(owners), fallbacks


def _look_around(contours: Contours, bits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All `vertex_sides`, words (B, V, V, 2), and for each vertex those not lower than it, words (B, V)."""
    n_rows, width = contours.slots.shape
    sides = np.zeros((n_rows, width, width, 2), dtype=bits.dtype)
    for group in _by_size(contours)[1]:
        size = group.slots.shape[1]
        sides[group.owner, :size, :size] = vertex_sides(group.points, group.n_contour + group.n_inner)
    height = contours.points[..., 1]
    others = np.zeros((n_rows, padded_size(width)))
    others[:, :width] = height
    return sides, pack_words(height[:, :, None] <= others[:, None], bits.dtype)


def _view(contours: Contours, sides: np.ndarray, bits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The `edge_sides` of (sub-)contours, and the bits of their vertices, words (B, V), 0 for padding."""
    present = np.arange(contours.slots.shape[1]) < (contours.n_contour + contours.n_inner)[:, None]
    return edge_sides(sides, contours.owner, contours.slots, contours.n_contour), bits[contours.slots] * present


def _by_size(contours: Contours) -> tuple[Contours, list[Contours]]:
    """The contours, those of similar size one after the other, and in groups, so that padding wastes little."""
    if len(contours.owner) < _FEW:
        return contours, [contours]
    size = np.digitize(contours.n_contour + contours.n_inner, _SIZES)
    contours = contours.rows(np.argsort(size, kind="stable"))
    ends = [0]
    for end in np.cumsum(np.bincount(size)):
        if end - ends[-1] >= _FEW or end == len(size) > ends[-1]:
            ends.append(end)
    return contours, [contours.rows(slice(*pair)) for pair in pairwise(ends)]


def _ask(
    level: Contours,
    groups: list[Contours],
    views: list[tuple[np.ndarray, np.ndarray]],
    number: np.ndarray,
    connect: Connect,
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Of each group the possible elements, words (F, B), as entries (3, p), and their values (p, 2), in one call."""
    possible, entries = [], []
    for group, (sides, bits) in zip(groups, views, strict=True):
        words = possible_elements(sides, bits, group.n_contour)
        hopeless = ~(words != 0).any(axis=0)
        if hopeless.any():
            contour = number[group.owner[hopeless][0]]
            raise ValueError(_NOT_AS_DESCRIBED.format(contour))
        possible.append(words)
        entries.append(list_entries(words, bits))
    together = np.concatenate(entries, axis=1)
    sizes = [part.shape[1] for part in entries]
    together[0] += np.repeat(np.cumsum([0] + [len(group.owner) for group in groups[:-1]]), sizes)
    values = connect(level.points, level.n_contour, level.n_inner, together.T)
    return list(zip(possible, entries, np.split(values, np.cumsum(sizes[:-1])), strict=True))


def _connect_facets(
    contours: Contours,
    sides: np.ndarray,
    bits: np.ndarray,
    possible: np.ndarray,
    entries: np.ndarray,
    values: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Connect the facets of each contour, best entry first, as long as an entry is left.

    Returns the elements (t, 3) and their rows (t,), the rows (s,) that had no acceptable entry
    and took the one element of best quality, and the vertex that each facet is connected to (B, F), -1 where none.
    """
    n_contour = contours.n_contour
    scores, stuck = score_entries(contours.points, n_contour, entries, values)
    # The best entry of each facet, kept up to date.
    vertices = scores.argmax(axis=2)
    rows = np.arange(len(scores))
    best = scores[rows[:, None], np.arange(scores.shape[1]), vertices].T.copy()
    chosen = bits[rows[:, None], vertices].T.copy()
    vertices = vertices.T.copy()
    together = _TOGETHER[len(rows) < _FEW]
    elements = []
    for number in range(1, len(best) + 1):
        facet = np.argsort(-best, axis=0, kind="stable")[:together]
        going = best[facet[0], np.arange(len(rows))] > 0
        if not going.all():
            rows, facet = rows[going], facet[:, going]
            best, vertices, chosen, possible = (part[:, going] for part in (best, vertices, chosen, possible))
        if not len(rows):
            break
        index = np.arange(len(rows))
        vertex, end = vertices[facet, index], (facet + 1) % n_contour[rows]
        closed = excluded_entries(sides, bits, rows, facet, end, vertex, n_contour)
        taken = compatible(closed, facet, end, vertex, chosen[facet, index]) & (best[facet, index] > 0)
        if number == 1 and len(stuck):
            taken[1:, stuck] = False
        place, row = np.nonzero(taken)
        made = facet[place, row]
        elements.append([rows[row], made, end[place, row], vertex[place, row]])
        possible = possible & ~np.bitwise_or.reduce(closed * taken, axis=1)
        possible[made, row] = 0
        best = best * (possible != 0)
        # Facets whose best entry is closed take their next best one.
        facet, index = np.nonzero((possible & chosen == 0) & (best > 0))
        if len(index):
            row = rows[index]
            rest = scores[row, facet] * ((possible[facet, index, None] & bits[row]) != 0)
            vertices[facet, index] = vertex = rest.argmax(axis=1)
            chosen[facet, index] = bits[row, vertex]
            best[facet, index] = rest[np.arange(len(rest)), vertex]
        if number == 1 and len(stuck):
            best[:, stuck] = 0
    row, *corners = np.concatenate(elements, axis=1)
    apex = np.full((len(scores), len(best)), -1)
    apex[row, corners[0]] = corners[2]
    return np.stack(corners, axis=1), row, stuck, apex


def _in_order(triangles: np.ndarray, owner: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles sorted by owner, then by vertices, whatever way they were found; the smallest vertex comes first."""
    a, b, c = triangles.astype(np.int64).T
    code = np.minimum(np.minimum((a * width + b) * width + c, (b * width + c) * width + a), (c * width + a) * width + b)
    key = np.sort(owner.astype(np.int64) * width**3 + code)
    parts = []
    for _ in range(3):
        rest = key // width
        parts.append(key - rest * width)
        key = rest
    return np.stack(parts[::-1], axis=1).astype(np.int32), key.astype(np.int32)
