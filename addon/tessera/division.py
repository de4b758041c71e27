"""Coarse division: simple polygons into cells of 3 to 16 edges by cutting them in two, again and again (section 4).

The paper samples at most 16 vertices of the contour and meshes those; a curve that is finer than its sample then leaves
the coarse mesh. Cutting keeps the contour's vertices and works for every simple polygon. It ends, because every simple
polygon of four vertices or more has a diagonal (so a chord is always found), and a chord has fewer segments than the
arcs between its ends have edges (so both parts have fewer edges than the polygon).
"""

from dataclasses import dataclass

import numpy as np

from .chords import Chords, choose_chords
from .spacing import Target, points_between, wanted_along

MAX_EDGES = 16
# Vertices of polygons that are processed together: bounds the memory.
_BLOCK = 200_000
# In polygons of no more edges, cuts are short, and the target is asked for at every so many of their steps only.
_FEW_EDGES, _EVERY = 64, 4


@dataclass(frozen=True)
class Polygons:
    """Simple counter-clockwise polygons of common points, one behind the other.

    corners (n,) point numbers; size (m,); owner (m,): which domain each polygon is a part of.
    """

    corners: np.ndarray
    size: np.ndarray
    owner: np.ndarray


@dataclass(frozen=True)
class Division:
    """Cells that partition polygons exactly and share vertices and edges.

    points (p, 2) float64, the polygons' own first and in their order; cells (c, 16) int32, counter-clockwise, padded
    with -1; owner (c,) int32, that of the polygon which a cell is part of.
    """

    points: np.ndarray
    cells: np.ndarray
    owner: np.ndarray


def divide(
    points: np.ndarray, polygons: Polygons, edge_length: float | np.ndarray, target: Target | None = None
) -> Division:
    """Divide polygons of points (p, 2), spaced as wanted, into cells that are such polygons, too.

    Polygons that share edges get cells that share them. edge_length: one, or one for each owner; target: where it is
    not the same everywhere, and edge_length the longest. New vertices along a cut follow the spacing at its ends and go
    to the target away from them.
    """
    edge_length = np.asarray(edge_length, dtype=np.float64)
    if edge_length.ndim == 0:
        edge_length = np.broadcast_to(edge_length, polygons.owner.max(initial=-1) + 1)
    cells, cell_owner = [], []
    while len(polygons.size):
        small = polygons.size <= MAX_EDGES
        cells.append(_padded(polygons, np.nonzero(small)[0], MAX_EDGES))
        cell_owner.append(polygons.owner[small])
        new_points, parts = [points], [Polygons(*(np.zeros(0, dtype=np.int64),) * 3)]
        n_points = len(points)
        for rows in _batches(polygons.size, ~small):
            added, part = _cut(points, n_points, polygons, rows, edge_length, target)
            new_points.append(added)
            parts.append(part)
            n_points += len(added)
        points = np.concatenate(new_points)
        polygons = Polygons(*(np.concatenate([getattr(p, f) for p in parts]) for f in ("corners", "size", "owner")))
    return Division(points, *(np.concatenate(a).astype(np.int32) for a in (cells, cell_owner)))


def _batches(size: np.ndarray, chosen: np.ndarray) -> list[np.ndarray]:
    """Polygons of about the same size (padded to the same width), not too many of them at once."""
    rows = np.nonzero(chosen)[0]
    width = _padded_width(size[rows])
    return [
        part
        for w in np.unique(width)
        for part in np.array_split(rows[width == w], 1 + int(w) * np.count_nonzero(width == w) // _BLOCK)
    ]


def _padded_width(size: np.ndarray) -> np.ndarray:
    """The next of 24, 32, 40, 48, 56, 64, 80, 96, ...: at most a quarter more from 32 on."""
    unit = np.maximum(2 ** (np.frexp(size - 1)[1].astype(np.int64) - 3), 8)
    return -(-size // unit) * unit


def _padded(polygons: Polygons, rows: np.ndarray, width: int) -> np.ndarray:
    """Point numbers (r, width) of some polygons, padded with -1."""
    slot = np.arange(width)
    first = (np.cumsum(polygons.size) - polygons.size)[rows]
    inside = slot < polygons.size[rows, None]
    return np.where(inside, polygons.corners[np.where(inside, first[:, None] + slot, 0)], -1)


def _cut(
    points: np.ndarray,
    n_points: int,
    polygons: Polygons,
    rows: np.ndarray,
    edge_length: np.ndarray,
    target: Target | None,
):
    """Cut the polygons `rows` in two -> points to add, numbered from n_points, and the parts."""
    corners = _padded(polygons, rows, int(_padded_width(polygons.size[rows[:1]])[0]))
    size, owner = polygons.size[rows], polygons.owner[rows]
    chords = choose_chords(points[corners], size, edge_length[owner])
    n_segments, added = _chord_points(points, corners, size, chords, edge_length, owner, target)
    n_new = n_segments - 1
    first_new = n_points + np.cumsum(n_new) - n_new

    forward = chords.end - chords.start
    part_size = np.stack([forward + n_segments, size - forward + n_segments], axis=1).ravel()
    part = np.repeat(np.arange(2 * len(rows)), part_size)
    place = np.arange(len(part)) - np.repeat(np.cumsum(part_size) - part_size, part_size)
    row, second = part // 2, part % 2 == 1
    # Each part: an arc of the polygon from one end of the chord to the other, then back along the chord.
    begin = np.where(second, chords.end[row], chords.start[row])
    arc = np.where(second, size[row] - forward[row], forward[row])
    step = place - arc - 1
    on_chord = first_new[row] + np.where(second, step, n_new[row] - 1 - step)
    numbers = np.where(place <= arc, corners[row, (begin + place) % size[row]], on_chord)
    return added, Polygons(numbers, part_size, np.repeat(owner, 2))


def _chord_points(points, corners, size, chords: Chords, edge_length, owner, target: Target | None):
    """How many segments each chord has, and the new points of all, each chord's from its start to its end."""
    row = np.arange(len(size))

    def spacing_at(slot: np.ndarray) -> np.ndarray:
        before, here, after = (points[corners[row, (slot + s) % size]] for s in (-1, 0, 1))
        return 0.5 * (np.linalg.norm(here - before, axis=1) + np.linalg.norm(after - here, axis=1))

    start, end = points[corners[row, chords.start]], points[corners[row, chords.end]]
    if target is None:
        wanted = edge_length[owner, None]
    else:
        wanted = wanted_along(start, end, owner, target, _EVERY if corners.shape[1] <= _FEW_EDGES else 1)
    return points_between(start, end, spacing_at(chords.start), spacing_at(chords.end), chords.most, wanted)
