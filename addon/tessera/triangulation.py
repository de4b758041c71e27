"""The triangulation algorithm (section 2.5.1, Algorithm 3): connection tables lead from contours to meshes, in batches.

All contours of a batch advance together: in one step, each connects the facet of its best entry with that entry's
vertex, and closes the entries that this makes impossible. The rows are not sorted beforehand: taking the best entry
left is the same as going through the rows in the order of their best entries. Beside the paper's listing:

- Lines 9-16 (connect, validate): an entry is possible if its triangle is counter-clockwise, holds no other vertex of
  the contour, on its sides neither, and its new edges cross no facet (`visibility.possible_elements`). After each new
  element the entries that overlap it are closed, so that the best entry left needs no validation (`_exclude`).
- Group ids (lines 10-12, 18-21): `cavities.Boundaries.group`, for the places of edges; a vertex may be in several
  groups.
- V_locked, F_locked (lines 13-15, 22-26): a vertex is locked when no edge of any cavity starts from it, a facet when
  its element was made or its place is used up (`cavities.add_elements`). All their entries overlap an element.
- Lines 28-34 (sub-contours, recursion): `cavities.sub_contours`. Those of three edges without inner vertices are
  elements; the others of all contours are the next level's batch: one call of NN3 for all of them.

Two departures from the listing, both found by measuring (1 200 contours with Gmsh's inner vertices, against CDT). The
paper orders by q_worst, with q_mean only for ties; but very often an entry's q_worst is due to an element elsewhere,
so that any error of the table decides between entries that should tie: with errors of 0.02 in a calculated table,
ē_mean was 4.4 %. Ordering by the sum min(q_worst, q of the element itself) + q_mean + 0.05 q makes that 0.8 %, and
with calculated tables -0.1 and 0.04 % (ē_worst, ē_mean). And a facet whose best entry has become impossible takes its
next best one: leaving it to the recursion, if its entry falls below any share of its best one, changed nothing that
could be measured.

Why it always ends with a valid mesh, whatever the tables are:

1. Every decision is an exact sign. Two possible elements of one contour overlap only if two of their edges cross
   properly or they lie on the same side of a common edge. For neither triangle holds a vertex of the other in its
   closure, apart from common ones: without proper crossing, edges could only meet in a vertex, or along each other
   with an end of one on the other. So one triangle would lie in the other, or a corner they share would have an edge
   of one enter the other, which it could leave only across the opposite side. These two cases are what `_exclude`
   closes; all new edges start from contour vertices, as the third edge of every entry is a facet.
2. What is left beside the elements is a set of simple polygons with the remaining vertices strictly inside, by
   induction. An element on facet (a, b) of such a polygon with apex v inside it leaves one: a, v, b replaces a, b, and
   v was not on it. With v on its boundary, it leaves the part from b to v and that from v to a. Each vertex but v is
   in one of them, each part visits it once, and a part of two edges is empty: its edge is common to two elements. No
   vertex lies on a new edge, as elements hold no other vertex.
3. In a simple polygon with vertices strictly inside, every facet has a possible element. A simple polygon of more than
   three vertices has a diagonal, also with straight angles: with a convex vertex v and its neighbours u and w, either
   uw or the segment from v to the vertex in triangle u, v, w farthest from uw. By induction it has a triangulation
   with elements of positive area, into which inner vertices can be put one after the other, splitting one element, or
   two if they lie on an edge. Its element on the facet is possible.
4. So every sub-contour always gets at least one element: if the table has no acceptable entry (finite, q_worst above
   0, the element not flat) for any possible element, the one of best quality (ties by index), counted as a fallback. A
   full triangulation has exactly N_C + 2 N_I - 2 elements and those left to make go down with each one, so the
   recursion ends; elements that do not overlap and reach this number cover the contour once and use every vertex.

Contours of a batch share nothing but array operations that treat each alone, and triangles are sorted in the end, so a
mesh does not depend on the batch that its contour is in.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .cavities import Contours, add_elements, join, open_contours, sub_contours
from .visibility import crossed_edges, edge_signs, edge_starts, possible_elements

Connect = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]

# Entries are compared to this many bits. What differs by less is a tie, so that rounding rarely decides.
_BITS = 20
# Weight of the element's own quality beside the table's entry.
_OWN_WEIGHT = 0.05
# Flatter elements, on vertices that are collinear but for rounding, are made only where there is no other.
_FLAT = 1e-5
# Where contours are divided by their number of vertices into groups of a level.
_SIZES = (5, 7, 10, 14, 20)
# Size in bytes of the sign tensor that is held at a time.
_CHUNK_SIZE = 1 << 26


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
    of a level of the recursion, whose edges can be as many as a contour has vertices. Raises ValueError where no
    element is possible, which is so only if a contour is not as described; other such contours may go unnoticed.
    """
    n_rows, width = points.shape[:2]
    contours = Contours(
        np.asarray(points, dtype=np.float64),
        np.broadcast_to(np.arange(width, dtype=np.int32), (n_rows, width)),
        np.arange(n_rows, dtype=np.int32),
        np.asarray(n_contour, dtype=np.int64),
        np.asarray(n_inner, dtype=np.int64),
    )
    elements, owners = [np.zeros((0, 3), dtype=np.int32)], [np.zeros(0, dtype=np.int32)]
    fallbacks = np.zeros(n_rows, dtype=np.int32)
    for rows in _chunks(contours):
        level = [contours.rows(rows)]
        while level:
            groups = list(_by_size(join(level)))
            signs = [edge_signs(group.points, group.n_contour, group.n_inner) for group in groups]
            tables = _ask(groups, signs, connect)
            level = []
            for group, group_signs, (entries, values) in zip(groups, signs, tables, strict=True):
                triangles, row, stuck, left = _connect_facets(group, group_signs, entries, values)
                single = (left.n_contour == 3) & (left.n_inner == 0)
                elements += [np.take_along_axis(group.slots[row], triangles, axis=1), left.slots[single, :3]]
                owners += [group.owner[row], left.owner[single]]
                np.add.at(fallbacks, group.owner[stuck], 1)
                if not single.all():
                    level.append(left.rows(~single))
    return Triangulation(*_in_order(np.concatenate(elements), np.concatenate(owners), width), fallbacks)


def _by_size(contours: Contours) -> Iterator[Contours]:
    """Contours of similar size together, so that padding wastes little."""
    size = np.digitize(contours.n_contour + contours.n_inner, _SIZES)
    for value in np.unique(size):
        yield contours.rows(size == value)


def _chunks(contours: Contours) -> list[slice]:
    """Rows, in pieces whose sign tensor is not too large."""
    n_rows, width = contours.slots.shape
    each = width**2 * (int(contours.n_contour.max(initial=0)) + 1)
    step = max(1, _CHUNK_SIZE // each) if n_rows else 1
    return [slice(start, start + step) for start in range(0, n_rows, step)]


def _ask(groups: list[Contours], signs: list[np.ndarray], connect: Connect) -> list[tuple[np.ndarray, np.ndarray]]:
    """Possible entries (p, 3) of each group and their values (p, 2), by one call for all of them."""
    entries = []
    for group, group_signs in zip(groups, signs, strict=True):
        possible = possible_elements(group_signs, group.n_contour, group.n_inner)
        hopeless = ~possible.any(axis=(1, 2))
        if hopeless.any():
            contour = group.owner[hopeless][0]
            raise ValueError(f"contour {contour} is no simple counter-clockwise polygon with its inner vertices inside")
        entries.append(np.argwhere(possible))
    first = np.cumsum([0] + [len(group.owner) for group in groups])
    level = join(groups)
    shifted = [part + [[row, 0, 0]] for part, row in zip(entries, first, strict=False)]
    values = connect(level.points, level.n_contour, level.n_inner, np.concatenate(shifted))
    ends = np.cumsum([len(part) for part in entries])
    return list(zip(entries, np.split(values, ends[:-1]), strict=True))


def _connect_facets(
    contours: Contours, signs: np.ndarray, entries: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, Contours]:
    """Connect the facets of each contour, best entry first, as long as an entry is left.

    Returns the elements (t, 3) and their rows (t,), the rows (s,) that had no acceptable entry
    and took the one element of best quality, and the sub-contours that are left.
    """
    n_contour = contours.n_contour
    starts = edge_starts(n_contour)
    n_facets, width = starts.shape[1] - 1, contours.points.shape[1]
    scores, stuck = _scores(contours.points, starts, entries, values)
    rows = np.arange(len(scores))
    boundaries = open_contours(n_contour)
    elements, element_rows = [], []
    for number in range(1, n_facets + 1):
        best = scores.reshape(len(rows), -1).argmax(axis=1)
        going = scores.reshape(len(rows), -1)[np.arange(len(rows)), best] > 0
        if not going.all():
            rows, scores, best = rows[going], scores[going], best[going]
        if not len(rows):
            break
        facet, vertex = np.divmod(best, width)
        elements.append(np.stack([starts[rows, facet], starts[rows, facet + 1], vertex], axis=1))
        element_rows.append(rows)
        used_up = add_elements(boundaries, rows, facet, vertex, number)
        _exclude(scores, signs, starts, rows, facet, vertex, used_up, n_contour[rows])
        if number == 1:
            scores[stuck] = 0
    left = sub_contours(contours, boundaries, signs)
    return np.concatenate(elements), np.concatenate(element_rows), stuck, left


def _scores(
    points: np.ndarray, starts: np.ndarray, entries: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Possible entries as integers, the better the larger and above 0: (B, F, V) int32.

    An entry is acceptable if its q_worst is finite and positive, and its element not flat; others are at most 0. Rows
    without any are returned too (s,): there every possible entry counts by its own quality.
    """
    row, facet, vertex = entries.T
    own = _facet_quality(points, starts)[row, facet, vertex]
    worst, mean = np.nan_to_num(values, nan=0, posinf=0, neginf=0).T
    acceptable = (worst > 0) & (own > _FLAT)
    stuck = np.bincount(row[acceptable], minlength=len(points)) == 0
    value = np.minimum(worst, own) + np.clip(mean, 0, 1) + _OWN_WEIGHT * own
    value = np.where(stuck[row], own, np.where(acceptable, value, -1))
    scores = np.zeros((len(points), starts.shape[1] - 1, points.shape[1]), dtype=np.int32)
    scores[row, facet, vertex] = (value * 2**_BITS).astype(np.int32) + 1
    return scores, np.flatnonzero(stuck)


def _facet_quality(points: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """`element_quality` of each facet with each vertex, 0 where it is not positive: (B, F, V) float64."""
    x, y = points.transpose(2, 0, 1)
    dx = x[:, None] - np.take_along_axis(x, starts, axis=1)[..., None]
    dy = y[:, None] - np.take_along_axis(y, starts, axis=1)[..., None]
    double_area = dx[:, :-1] * dy[:, 1:] - dx[:, 1:] * dy[:, :-1]
    squared = dx * dx + dy * dy
    sides = squared[:, :-1] + squared[:, 1:] + np.take_along_axis(squared[:, :-1], starts[:, 1:, None], axis=2)
    return 2 * np.sqrt(3) * np.maximum(double_area, 0) / np.maximum(sides, np.finfo(float).tiny)


def _exclude(
    scores: np.ndarray,
    signs: np.ndarray,
    starts: np.ndarray,
    rows: np.ndarray,
    facet: np.ndarray,
    vertex: np.ndarray,
    used_up: np.ndarray,
    n_contour: np.ndarray,
) -> None:
    """Set to 0 the entries (n, F, V) that are impossible beside the new element (facet, vertex) of each contour."""
    index = np.arange(len(rows))
    crossed = crossed_edges(signs, starts, rows, facet, vertex)
    crossed |= crossed_edges(signs, starts, rows, facet + 1, vertex)
    excluded = crossed[:, :-1] | crossed[:, 1:] | used_up[..., None]
    excluded[index, facet] = True
    # Elements on the same side of one of the new edges.
    index = np.flatnonzero(vertex < n_contour)
    a, b, v, n = (values[index] for values in (facet, starts[rows, facet + 1], vertex, n_contour))
    excluded[index, v, b] = True
    excluded[index, (v - 1) % n, a] = True
    scores[excluded] = 0


def _in_order(triangles: np.ndarray, owner: np.ndarray, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles sorted by owner, then by vertices, whatever way they were found; the smallest vertex comes first."""
    first = triangles.argmin(axis=1)
    triangles = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1).astype(np.int32)
    key = ((owner.astype(np.int64) * width + triangles[:, 0]) * width + triangles[:, 1]) * width + triangles[:, 2]
    order = np.argsort(key)
    return triangles[order], owner[order]
