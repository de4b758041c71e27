"""Sizing functions: the edge length that is wanted at a point.

What a user gives as ``sizing=`` is a number, a function of points (n, 2) that returns lengths (n,), or what one of the
functions here returns; `smallest` joins any of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .cones import Places, build_cones, lowest, within
from .contour import edges_of, nesting, real_numbers
from .errors import ContourError
from .noding import TOLERANCE as NODING_TOLERANCE
from .thickness import thin_parts

# How fast the wanted length may fall off beside an edge that is longer than the target, in length per length.
GRADATION = 0.5
LONG = 1.5  # times the target edge length, from which an edge is longer than it could be
_BLOCK = 1 << 22  # distances held at a time


def grade_from_edges(
    starts: np.ndarray, ends: np.ndarray, of: np.ndarray, target: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """The target everywhere, but larger beside boundary edges that are longer and may not be split.

    starts, ends: (e, 2) of the edges; of: (e,) the number of the mesh that each is part of; target: points (n, 2) of
    meshes (n,) -> (n,) wanted edge lengths. A mesh knows nothing of the others' edges, wherever they are. Without long
    edges the function is the target.
    """
    lengths = np.linalg.norm(ends - starts, axis=1)
    long = np.flatnonzero(lengths > LONG * target(0.5 * (starts + ends), of))
    if not len(long):
        return target
    # The largest of length - slope · distance is what is left of the longest by the lowest of cones.
    longest = np.zeros(of.max() + 1)
    np.maximum.at(longest, of[long], lengths[long])
    slope = np.full(len(long), GRADATION)
    cones = build_cones(Places(starts[long], ends[long], longest[of[long]] - lengths[long], slope, of[long]))

    def sizing(points: np.ndarray, owner: np.ndarray) -> np.ndarray:
        """(k, 2) points of meshes (k,) -> (k,) wanted edge lengths."""
        wanted = target(points, owner)
        left = longest[owner] - wanted
        least = lowest(cones, points, owner, left)
        return np.where(least < left, longest[owner] - least, wanted)

    return sizing


@dataclass(frozen=True)
class Limits:
    """What holds for all sizings of a call: longest and shortest (or None) edge length, slope, corner angle in radians.

    slope: by how much the wanted length may grow in a unit of length.
    """

    longest: float
    shortest: float | None
    slope: float
    corner_angle: float

    @property
    def shortest_found(self) -> float:
        """The least that is made of a contour's shape, where sharp corners would ask for nothing at all."""
        return self.longest / 100 if self.shortest is None else self.shortest


def checked_limits(edge_length: float, min_edge_length: float | None, gradation: float, corner_angle: float) -> Limits:
    """The limits that a user gives; corner_angle: in radians. Raises ContourError "edge-length" for lengths that are
    none."""
    longest = checked_edge_length(edge_length, "target edge length")
    shortest = None if min_edge_length is None else checked_edge_length(min_edge_length, "min_edge_length")
    if shortest is not None and shortest > longest:
        message = (
            f"The min_edge_length {shortest:g} is longer than the target edge length {longest:g}. Give a shorter one."
        )
        raise ContourError("edge-length", message)
    return Limits(longest, shortest, float(np.log(gradation)), corner_angle)


def checked_edge_length(edge_length: float, name: str = "target edge length") -> float:
    """A length as a float; raises ContourError "edge-length" unless it is a positive finite number."""
    if not np.isfinite(value := _as_positive(edge_length)):
        message = f"The {name} is {edge_length}; it must be a positive number. Give one in the curve's unit."
        raise ContourError("edge-length", message)
    return value


def _as_positive(number: float) -> float:
    """The number as a float, or NaN if it is no positive finite number."""
    try:
        value = float(number)
    except (TypeError, ValueError, OverflowError):
        return np.nan
    return value if 0 < value < np.inf else np.nan


# What a sizing comes to once the loops are known: a number, a function of points, or places from which it grows.
Part = float | Callable[[np.ndarray], np.ndarray] | Places


@dataclass(frozen=True)
class FromLoops:
    """A sizing made when meshing starts: `prepare` takes a domain's loops, counter-clockwise, and the limits."""

    prepare: Callable[[list[np.ndarray], Limits], list[Part]]


Sizing = float | Callable[[np.ndarray], np.ndarray] | FromLoops


def parts_of(sizing: Sizing, loops: list[np.ndarray], limits: Limits) -> list[Part]:
    """What the smallest of is the sizing, for one domain."""
    if isinstance(sizing, FromLoops):
        return sizing.prepare(loops, limits)
    return [sizing if callable(sizing) else positive(sizing, "sizing")]


def positive(number: float, name: str) -> float:
    """A positive finite number as a float; raises ContourError "sizing" for anything else."""
    if not np.isfinite(value := _as_positive(number)):
        raise ContourError("sizing", f"{name} is {number!r}; it must be a positive number. Give one.")
    return value


def smallest(*sizings: Sizing) -> FromLoops:
    """The smallest of several sizings, everywhere."""
    return FromLoops(lambda loops, limits: [part for one in sizings for part in parts_of(one, loops, limits)])


def by_curvature(ratio: float = 0.3) -> FromLoops:
    """Edges of `ratio` times the contour's radius of curvature, where that is less than wanted otherwise.

    0.3 makes about 21 edges of a full circle. Corners have no radius. Where `mesh` is given no `min_edge_length`, no
    edge is asked to be shorter than a hundredth of the longest.
    """
    ratio = positive(ratio, "by_curvature's ratio")

    def prepare(loops: list[np.ndarray], limits: Limits) -> list[Part]:
        return [_curved(loop, ratio, limits) for loop in loops]

    return FromLoops(prepare)


def by_thickness(elements: float = 3) -> FromLoops:
    """At least so many elements across thin parts, measured straight across from one side of the domain to the other.

    Two sides that meet at a corner of more than 45 degrees are no thin part. Where `mesh` is given no
    `min_edge_length`, no edge is asked to be shorter than a hundredth of the longest.
    """
    elements = positive(elements, "by_thickness's number of elements")

    def prepare(loops: list[np.ndarray], limits: Limits) -> list[Part]:
        # A hole that another region fills is none, and there is nothing across between the two.
        places = [frozenset(map(tuple, loop.tolist())) for loop in loops]
        count = Counter(places)
        loops = [loop for loop, own in zip(loops, places, strict=True) if count[own] % 2]
        holes = set(nesting(loops).holes.tolist())
        turned = [loop[::-1] if number in holes else loop for number, loop in enumerate(loops)]
        start, end = edges_of(turned)
        here, there = thin_parts(start, end, elements, limits.longest, limits.shortest_found)
        # Contours that lie beside each other have nothing in between.
        apart = np.linalg.norm(there - here, axis=1) > 2 * NODING_TOLERANCE * np.ptp(start, axis=0).max()
        here, there = here[apart], there[apart]
        across = np.linalg.norm(there - here, axis=1) / elements
        return [_places(here, there, np.maximum(across, limits.shortest_found), limits.slope)]

    return FromLoops(prepare)


def by_distance(near: float, points: ArrayLike | None = None, *, reach: float | None = None) -> FromLoops:
    """Edges of length `near` at some points (k, 2), or at the contour if none are given, and longer away from there.

    They grow as fast as the gradation allows, or so that the longest edge length is wanted at the distance `reach`.
    """
    near = positive(near, "by_distance's near")
    reach = np.inf if reach is None else positive(reach, "by_distance's reach")
    given = None if points is None else _checked_points(points, "by_distance")

    def prepare(loops: list[np.ndarray], limits: Limits) -> list[Part]:
        if given is None:
            start, end = edges_of(loops)
        else:
            start = end = given
        slope = limits.slope
        if np.isfinite(reach):
            slope = min(slope, max(limits.longest - near, 0) / reach)
        return [_places(start, end, np.full(len(start), near), slope)]

    return FromLoops(prepare)


def from_values(points: ArrayLike, values: ArrayLike) -> Callable[[np.ndarray], np.ndarray]:
    """Edge lengths (k,) that are known at points (k, 2), and means of the nearest in between."""
    points, values = _checked_points(points, "from_values"), real_numbers(values, "values")
    if values.shape != points.shape[:1]:
        place = tuple(map(float, points[0]))
        message = f"from_values has {len(points)} points, the first at ({place[0]:g}, {place[1]:g}), and values of "
        raise ContourError("sizing", message + f"shape {values.shape}. Give one value for each point.", place)
    checked_lengths(values, points, "from_values")
    tree = build_cones(_places(points, points, np.zeros(len(points)), 1.0))

    def interpolated(x: np.ndarray) -> np.ndarray:
        """(n, 2) points -> (n,) lengths: weights 1 / distance, that vanish at three times that of the nearest."""
        nearest = lowest(tree, x, np.zeros(len(x), dtype=np.int64), np.full(len(x), np.inf))
        found = np.zeros(len(x))
        for rows in np.array_split(np.arange(len(x)), 1 + len(x) * len(points) // _BLOCK):
            query, number, away = within(tree, x[rows], 3 * nearest[rows])
            ratio = np.where(nearest[rows][query] > 0, away / np.where(away > 0, nearest[rows][query], 1), 1)
            weight = np.maximum(3 / ratio - 1, 0)
            found[rows] = np.bincount(query, weight * values[number]) / np.bincount(query, weight)
        return found

    return interpolated


def _checked_points(points: ArrayLike, name: str) -> np.ndarray:
    points = real_numbers(points, "points")
    if points.ndim != 2 or points.shape[1] != 2 or not len(points):
        message = f"{name} takes points as an array of shape (k, 2), k at least 1, not of shape {points.shape}. "
        raise ContourError("sizing", message + "Give x and y of each point.")
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        x, y = points[bad[0]]
        message = f"{name} takes finite numbers; its point {bad[0]} (counting from 0) is ({x:g}, {y:g}). "
        raise ContourError("sizing", message + "Leave it out or mend it.")
    return points


def checked_lengths(values: np.ndarray, points: np.ndarray, name: str) -> None:
    """Raise ContourError "sizing" if one of the lengths (n,) at points (n, 2) is not positive; infinity is."""
    bad = np.flatnonzero(~(values > 0))
    if len(bad):
        place = tuple(map(float, points[bad[0]]))
        message = f"{name} is {values[bad[0]]:g} at ({place[0]:g}, {place[1]:g}); an edge length is a positive number. "
        raise ContourError("sizing", message + "Give one there, or infinity where any length will do.", place)


def _places(start: np.ndarray, end: np.ndarray, value: np.ndarray, slope: float) -> Places:
    """Places of the domain 0, all of one slope."""
    return Places(start, end, value, np.full(len(value), float(slope)), np.zeros(len(value), dtype=np.int64))


def _curved(loop: np.ndarray, ratio: float, limits: Limits) -> Places:
    """`ratio` times the radius of curvature, at each vertex of a loop and at the edges between two that are curved."""
    came, goes = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    turning = np.abs(np.arctan2(came[:, 0] * goes[:, 1] - came[:, 1] * goes[:, 0], np.sum(came * goes, axis=1)))
    length = 0.5 * (np.linalg.norm(came, axis=1) + np.linalg.norm(goes, axis=1))
    with np.errstate(divide="ignore"):
        value = np.where(turning > limits.corner_angle, np.inf, ratio * length / turning)
    value = np.maximum(value, limits.shortest_found)
    after = np.roll(loop, -1, axis=0)
    value = np.concatenate([value, np.maximum(value, np.roll(value, -1))])
    start, end = np.concatenate([loop, loop]), np.concatenate([loop, after])
    wanted = value < limits.longest
    return _places(start[wanted], end[wanted], value[wanted], limits.slope)
