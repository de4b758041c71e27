"""Coarse division: simple polygons into cells of 3 to 16 edges by cutting them in two, again and again (section 4).

The paper samples at most 16 vertices of the contour and meshes those; a curve that is finer than its sample then leaves
the coarse mesh. Cutting keeps the contour's vertices and works for every simple polygon. It ends, because every simple
polygon of four vertices or more has a diagonal (so a chord is always found), and a chord has fewer segments than the
arcs between its ends have edges (so both parts have fewer edges than the polygon).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .chords import Chords, choose_chords, graded_spacing

MAX_EDGES = 16
# Vertices of polygons that are processed together: bounds the memory.
_BLOCK = 200_000
# Places along a chord between which its spacing is taken to be constant.
_STEPS = 64
# In polygons of fewer edges, chords are short, and a sizing function is asked at every fourth of these places only.
_MANY_EDGES = 64


@dataclass(frozen=True)
class Division:
    """Cells that partition polygons exactly and share vertices and edges.

    points (p, 2) float64, the polygons' own first and in their order; cells (c, 16) int32, counter-clockwise, padded
    with -1; owner (c,) int32, the polygon that a cell is part of; point_owner (p,) int32.
    """

    points: np.ndarray
    cells: np.ndarray
    owner: np.ndarray
    point_owner: np.ndarray


@dataclass(frozen=True)
class _Polygons:
    """Polygons one behind the other: `corners` (n,) point numbers, `size` (m,), `owner` (m,)."""

    corners: np.ndarray
    size: np.ndarray
    owner: np.ndarray


def divide(
    loops: Sequence[np.ndarray],
    edge_length: float | np.ndarray,
    target: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None,
) -> Division:
    """Divide simple counter-clockwise polygons (n_i, 2), spaced as wanted, into cells that are such polygons, too.

    edge_length: one, or one for each polygon (m,); target: where it is not the same everywhere, a function of points
    (n, 2) and the polygon of each (n,), and edge_length the longest. New vertices along a cut follow the spacing at its
    ends and go to the target away from them.
    """
    size = np.array([len(loop) for loop in loops], dtype=np.int64)
    edge_length = np.broadcast_to(np.asarray(edge_length, dtype=np.float64), len(loops))
    points = np.concatenate([np.asarray(loop, dtype=np.float64) for loop in loops])
    owner = np.arange(len(loops))
    point_owner = np.repeat(owner, size)
    polygons = _Polygons(np.arange(len(points)), size, owner)
    cells, cell_owner = [], []
    while len(polygons.size):
        small = polygons.size <= MAX_EDGES
        cells.append(_padded(polygons, np.nonzero(small)[0], MAX_EDGES))
        cell_owner.append(polygons.owner[small])
        new_points, new_owner, parts = [points], [point_owner], [_Polygons(*(np.zeros(0, dtype=np.int64),) * 3)]
        n_points = len(points)
        for rows in _batches(polygons.size, ~small):
            added, added_owner, part = _cut(points, n_points, polygons, rows, edge_length, target)
            new_points.append(added)
            new_owner.append(added_owner)
            parts.append(part)
            n_points += len(added)
        points, point_owner = np.concatenate(new_points), np.concatenate(new_owner)
        polygons = _Polygons(*(np.concatenate([getattr(p, f) for p in parts]) for f in ("corners", "size", "owner")))
    as_int32 = (np.concatenate(a).astype(np.int32) for a in (cells, cell_owner))
    return Division(points, *as_int32, point_owner.astype(np.int32))


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
    """The next of 20, 24, 28, 32, 40, 48, 56, 64, 80, ...: at most a quarter more."""
    unit = 2 ** (np.frexp(size - 1)[1].astype(np.int64) - 3)
    return -(-size // unit) * unit


def _padded(polygons: _Polygons, rows: np.ndarray, width: int) -> np.ndarray:
    """Point numbers (r, width) of some polygons, padded with -1."""
    slot = np.arange(width)
    first = (np.cumsum(polygons.size) - polygons.size)[rows]
    inside = slot < polygons.size[rows, None]
    return np.where(inside, polygons.corners[np.where(inside, first[:, None] + slot, 0)], -1)


def _cut(
    points: np.ndarray, n_points: int, polygons: _Polygons, rows: np.ndarray, edge_length: np.ndarray, target: Callable
):
    """Cut the polygons `rows` in two -> points to add, numbered from n_points, their owners, and the parts."""
    corners = _padded(polygons, rows, int(_padded_width(polygons.size[rows[:1]])[0]))
    size, owner = polygons.size[rows], polygons.owner[rows]
    chords = choose_chords(points[corners], size, edge_length[owner])
    start, end = (points[corners[np.arange(len(rows)), slot]] for slot in (chords.start, chords.end))
    wanted = (
        edge_length[owner][:, None] if target is None else _wanted_along(start, end, owner, target, corners.shape[1])
    )
    n_segments, added = _chord_points(points, corners, size, chords, wanted)
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
    return added, np.repeat(owner, n_new), _Polygons(numbers, part_size, np.repeat(owner, 2))


def _wanted_along(start: np.ndarray, end: np.ndarray, owner: np.ndarray, target: Callable, width: int) -> np.ndarray:
    """(P, _STEPS) the target along chords from start (P, 2) to end (P, 2); between fewer stations in small polygons."""
    each = 1 if width > _MANY_EDGES else 4
    share = (np.arange(_STEPS // each) + 0.5) * each / _STEPS
    stations = start[:, None] + share[:, None] * (end - start)[:, None]
    wanted = target(stations.reshape(-1, 2), np.repeat(owner, len(share))).reshape(len(owner), -1)
    if each == 1:
        return wanted
    at = np.clip(((np.arange(_STEPS) + 0.5) / each - 0.5), 0, len(share) - 1)
    before = np.minimum(at.astype(np.int64), len(share) - 2)
    return wanted[:, before] + (at - before) * (wanted[:, before + 1] - wanted[:, before])


def _chord_points(points, corners, size, chords: Chords, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How many segments each chord has, and the new points of all, each chord's from its start to its end.

    wanted: the target along each chord (P, _STEPS), or (P, 1). The spacing is graded from that at the ends.
    """
    row = np.arange(len(size))

    def spacing_at(slot: np.ndarray) -> np.ndarray:
        before, here, after = (points[corners[row, (slot + s) % size]] for s in (-1, 0, 1))
        return 0.5 * (np.linalg.norm(here - before, axis=1) + np.linalg.norm(after - here, axis=1))

    start, end = points[corners[row, chords.start]], points[corners[row, chords.end]]
    length = np.linalg.norm(end - start, axis=1)[:, None]
    middle = (np.arange(_STEPS) + 0.5) / _STEPS
    spacing = graded_spacing(
        middle * length,
        length,
        spacing_at(chords.start)[:, None],
        spacing_at(chords.end)[:, None],
        wanted,
    )
    passed = np.concatenate([np.zeros((len(size), 1)), np.cumsum(1 / spacing, axis=1)], axis=1)
    natural = passed[:, -1] * length[:, 0] / _STEPS
    n_segments = np.clip(np.rint(natural), 1, chords.most).astype(np.int64)

    n_new = n_segments - 1
    chord = np.repeat(row, n_new)
    number = np.arange(len(chord)) - np.repeat(np.cumsum(n_new) - n_new, n_new) + 1
    reached = passed[chord, -1] * number / n_segments[chord]
    step = np.minimum(np.sum(passed[chord] <= reached[:, None], axis=1) - 1, _STEPS - 1)
    share = (step + (reached - passed[chord, step]) * spacing[chord, step]) / _STEPS
    return n_segments, (1 - share)[:, None] * start[chord] + share[:, None] * end[chord]
