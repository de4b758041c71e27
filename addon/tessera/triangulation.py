"""Triangulation."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .cavities import Contours, add_elements, join, open_contours, sub_contours
from .quality import element_quality
from .visibility import crossed_edges, edge_signs, edge_starts, possible_elements

Connect = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]

# Entries are compared to this many bits: what differs by less is a tie, whatever rounding the tables have seen.
_BITS = 20
# Where contours are divided by their number of vertices into groups of a level.
_SIZES = (5, 7, 10, 14, 20)
# Bytes of sign tensor that are held at a time.
_CHUNK_SIZE = 1 << 25


@dataclass(frozen=True)
class Triangulation:
    """Meshes of a batch of contours, in the order of the contours."""

    triangles: np.ndarray  # (t, 3) int32, counter-clockwise slots of the owner's point row
    owner: np.ndarray  # (t,) int32
    fallbacks: np.ndarray  # (B,) int32: elements that were chosen by their own quality, as the table led nowhere


def triangulate(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, connect: Connect) -> Triangulation:
    """Mesh contours with inner vertices, led by connection tables (Algorithm 3).

    points: (B, V, 2) float64, each row n_contour vertices of a simple counter-clockwise polygon, then n_inner distinct
    vertices strictly inside, then padding of any value; n_contour, n_inner: (B,) int. connect: NN3, points, n_contour and
    n_inner of contours in the same form -> their tables (B, >= max n_contour, V, 2) of (q_worst, q_mean).
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
    level = [contours]
    while level:
        rest = []
        for group in _by_size(join(level)):
            tables = connect(group.points, group.n_contour, group.n_inner)
            for rows in _chunks(group):
                chunk = group.rows(rows)
                triangles, row, stuck, left = _connect_facets(chunk, tables[rows])
                single = (left.n_contour == 3) & (left.n_inner == 0)
                elements += [np.take_along_axis(chunk.slots[row], triangles, axis=1), left.slots[single, :3]]
                owners += [chunk.owner[row], left.owner[single]]
                np.add.at(fallbacks, chunk.owner[stuck], 1)
                if not single.all():
                    rest.append(left.rows(~single))
        level = rest
    return Triangulation(*_in_order(np.concatenate(elements), np.concatenate(owners), width), fallbacks)


def _by_size(contours: Contours) -> Iterator[Contours]:
    """Contours of similar size together, so that padding wastes little."""
    size = np.digitize(contours.n_contour + contours.n_inner, _SIZES)
    for value in np.unique(size):
        yield contours.rows(size == value)


def _chunks(contours: Contours) -> list[np.ndarray]:
    """Row numbers, in pieces whose sign tensor is not too large."""
    n_rows, width = contours.slots.shape
    each = width**2 * (int(contours.n_contour.max(initial=0)) + 1)
    return np.array_split(np.arange(n_rows), 1 + n_rows * each // _CHUNK_SIZE)


def _connect_facets(contours: Contours, tables: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, Contours]:
    """Connect the facets of each contour, best entry first, as long as an entry is left.

    tables: (B, F, V, 2). Returns the elements (t, 3) and their rows (t,), the rows that had no acceptable entry and took
    their element of best own quality (s,), and the sub-contours that are left.
    """
    n_contour = contours.n_contour
    signs = edge_signs(contours.points, n_contour, contours.n_inner)
    starts = edge_starts(n_contour)
    possible = possible_elements(signs, n_contour, contours.n_inner)
    n_facets, width = possible.shape[1:]
    scores = _scores(tables[:, :n_facets, :width], possible)
    rows = np.arange(len(scores))
    stuck = np.flatnonzero(~scores.any(axis=(1, 2)))
    if len(stuck):
        scores[stuck] = _own_scores(contours.points[stuck], starts[stuck], possible[stuck])
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


def _scores(tables: np.ndarray, possible: np.ndarray) -> np.ndarray:
    """Table entries as integers that order them by q_worst, then q_mean: (B, F, V) int64, 0 where not acceptable."""
    worst, mean = (np.nan_to_num(tables[..., k], nan=0, posinf=0, neginf=0) for k in (0, 1))
    scores = (np.minimum(worst, 1) * 2**_BITS).astype(np.int64) << (_BITS + 1)
    scores += (np.clip(mean, 0, 1) * 2**_BITS).astype(np.int64) + 1
    return np.where(possible & (worst > 0), scores, 0)


def _own_scores(points: np.ndarray, starts: np.ndarray, possible: np.ndarray) -> np.ndarray:
    """The same from the quality of each possible element itself: (B, F, V) int64."""
    row, facet, vertex = np.nonzero(possible)
    corners = np.stack([starts[row, facet], starts[row, facet + 1], vertex], axis=1) + row[:, None] * points.shape[1]
    quality = np.zeros(possible.shape)
    quality[row, facet, vertex] = np.maximum(element_quality(points.reshape(-1, 2), corners), 0)
    return np.where(possible, (quality * 2**_BITS).astype(np.int64) + 1, 0)


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
