"""Splines that touch, such as neighbours on a map: outlines that can each be meshed. No `bpy` here."""

import numpy as np

from ..tessera.contour import points_inside, signed_area
from .outline import Outline
from .welding import same_place

# What counts as the same place, as a fraction of the outline's size.
TOLERANCE = 1e-6


def apart(outline: Outline) -> list[Outline]:
    """The regions of an outline, one outer contour and its holes each, in as few outlines as keep apart what touches.

    The mesher refuses loops that touch, as between them it could not say what is inside; but regions that do may lie
    side by side. A hole that touches its own outer contour stays with it, and the mesher names the place.
    """
    if len(outline.loops) == 1:
        return [outline]
    loop = np.repeat(np.arange(len(outline.loops)), [len(points) for points in outline.loops])
    points = np.concatenate(outline.loops)
    size = float(np.ptp(points, axis=0).max())
    if size == 0.0:
        return [outline]
    place = same_place(points, TOLERANCE * size)
    touching = _touching(place, loop)
    if not len(touching):
        return [outline]
    region = _regions(outline.loops, place, loop)
    pairs = region[touching]
    colour = _colours(pairs[pairs[:, 0] != pairs[:, 1]], len(outline.loops))[region]
    return [outline.of(np.flatnonzero(colour == c)) for c in range(colour.max() + 1)]


def _touching(place: np.ndarray, loop: np.ndarray) -> np.ndarray:
    """Pairs (k, 2) of loops that have a point in the same place."""
    order = np.lexsort((loop, place))
    pairs = []
    for shift in range(1, int(np.bincount(place).max())):
        one, other = order[:-shift], order[shift:]
        meet = (place[one] == place[other]) & (loop[one] != loop[other])
        pairs.append(np.column_stack([loop[one[meet]], loop[other[meet]]]))
    return np.unique(np.concatenate(pairs), axis=0) if pairs else np.zeros((0, 2), dtype=np.int64)


def _regions(loops: tuple[np.ndarray, ...], place: np.ndarray, loop: np.ndarray) -> np.ndarray:
    """For each loop (l,), the outer contour of its region: itself, or the deepest around a hole."""
    around = _containment(loops, place, loop)
    depth = around.sum(axis=1)
    region = np.arange(len(loops))
    holes = np.flatnonzero(depth % 2 == 1)
    region[holes] = np.argmax(np.where(around[holes], depth + 1, 0), axis=1)
    return region


def _containment(loops: tuple[np.ndarray, ...], place: np.ndarray, loop: np.ndarray) -> np.ndarray:
    """(l, l) bool: whether the second loop is around the first; most points that they do not share decide.

    Of loops that share all their points, the earlier is around the later.
    """
    points = np.concatenate(loops)
    area = np.array([abs(signed_area(points)) for points in loops])
    low, high = (np.array([extreme(p, axis=0) for p in loops]) for extreme in (np.min, np.max))
    slack = 2 * TOLERANCE * float(np.ptp(points, axis=0).max())
    around = np.zeros((len(loops), len(loops)), dtype=bool)
    for outer, polygon in enumerate(loops):
        inner = (low >= low[outer] - slack).all(axis=1) & (high <= high[outer] + slack).all(axis=1)
        inner[outer] = False
        asked = np.flatnonzero(inner[loop])
        asked = asked[~np.isin(place[asked], place[loop == outer])]
        votes = np.where(points_inside(points[asked], polygon), 1, -1)
        score = np.bincount(loop[asked], votes, minlength=len(loops))
        undecided = inner & (np.bincount(loop[asked], minlength=len(loops)) == 0)
        same = np.isclose(area, area[outer], rtol=1e-6)
        later = np.arange(len(loops)) > outer
        around[:, outer] = inner & np.where(undecided, np.where(same, later, area < area[outer]), score > 0)
    return around


def _colours(pairs: np.ndarray, n: int) -> np.ndarray:
    """The first colour (n,) for each that none of its earlier neighbours has; pairs (k, 2)."""
    colour = np.zeros(n, dtype=np.int64)
    for i in np.unique(pairs.max(axis=1)) if len(pairs) else []:
        beside = np.concatenate([pairs[pairs[:, 0] == i, 1], pairs[pairs[:, 1] == i, 0]])
        taken = set(colour[beside[beside < i]].tolist())
        colour[i] = next(c for c in range(n) if c not in taken)
    return colour
