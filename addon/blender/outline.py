"""What is read from an object: closed loops in one plane, and what each of them brings. No `bpy` is called here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..tessera.constraints import Domain
from ..tessera.uncrossed import uncrossed
from .errors import OutlineError
from .plane import Plane, fit_plane

if TYPE_CHECKING:
    import bpy

# What outlines face in their object's space, where nothing else is known.
UP = np.array([0.0, 0.0, 1.0])
NOTHING = "There is no outline in it, or none that its modifiers leave. Draw or type something first."


@dataclass(frozen=True)
class Polyline:
    """points: (k, 3) float64 in the object's space; spline: its number as the user counts it, from 1, or 0.

    region: of an `Outline`, where there are several.
    """

    points: np.ndarray
    closed: bool
    spline: int = 0
    material: int = 0
    smooth: bool = True
    region: int = 0


@dataclass(frozen=True)
class Part:
    """The flat part of a mesh that loops bound.

    faces: (f,) int32, those that are to be replaced; vertices: (k,) int32 for each loop, the mesh vertex at each of its
    points, or -1 for one that is to be made on the edge between the nearest others.
    """

    faces: np.ndarray
    vertices: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Outline:
    """One plane: what one call of `tessera.mesh` takes.

    loops: (k, 2) float64 each, in the plane and in world units, none repeating its first point; plane: between them and
    the object's space; splines: (l,) int32, the number of the spline of each loop as the user counts it, from 1, or 0
    for what is no spline; materials: (l,) int32, in slots; smooth: (l,) bool; slots: the object's materials; part: set
    for a part of a mesh in Edit Mode, whose boundary must be kept; regions: (l,) int32, by which loops bound regions
    with common vertices, as faces of several materials do; or None, and loops inside each other are holes and islands.
    """

    loops: tuple[np.ndarray, ...]
    plane: Plane
    splines: np.ndarray
    materials: np.ndarray
    smooth: np.ndarray
    slots: tuple[bpy.types.Material | None, ...] = ()
    part: Part | None = None
    regions: np.ndarray | None = None

    @property
    def size(self) -> float:
        """The longer side of the bounding box of the largest loop, or of all regions together, in world units."""
        if self.regions is not None:
            return float(np.ptp(np.concatenate(self.loops), axis=0).max())
        return max(float(np.ptp(loop, axis=0).max()) for loop in self.loops)

    @property
    def domain(self) -> Sequence[np.ndarray] | Domain:
        """What the library takes for it."""
        return self.loops if self.regions is None else Domain(self.loops, self.regions.tolist(), None, ())

    def loops_of(self, region: np.ndarray) -> np.ndarray:
        """(m,) for each triangle, by the region that the library gives it, the index of a loop that has its traits."""
        if self.regions is None:
            return region
        first = np.unique(self.regions, return_index=True)[1]
        return first[region].astype(np.int32)

    def loop_near(self, place: Sequence[float]) -> int:
        """The index of the loop that passes closest to a place (2,), such as a ContourError's."""
        return int(np.argmin([_distance(loop, np.asarray(place)) for loop in self.loops]))

    def uncrossed(self) -> Outline:
        """Loops that cross or touch united, as fonts mean them: with the outlines of what they wind around."""
        loops, of = uncrossed(self.loops)
        own = (each[of] for each in (self.splines, self.materials, self.smooth))
        return Outline(tuple(loops), self.plane, *own, self.slots, self.part)

    def subdivided(self, edge_length: float) -> Outline:
        """Long edges of a part's boundary divided evenly, so that none is much longer than edge_length.

        Both parts beside an edge divide it alike, and the vertices that there are all stay.
        """
        pairs = [
            _divided(loop, vertices, edge_length) for loop, vertices in zip(self.loops, self.part.vertices, strict=True)
        ]
        part = replace(self.part, vertices=tuple(vertices for _, vertices in pairs))
        return replace(self, loops=tuple(loop for loop, _ in pairs), part=part)


def make_outline(
    polylines: Sequence[Polyline],
    to_world: np.ndarray,
    slots: tuple[bpy.types.Material | None, ...] = (),
    up: Sequence[float] = UP,
) -> Outline:
    """Closed polylines of one plane.

    to_world: (3, 3), the linear part of the object's world matrix; up: the side of the plane that the mesh faces.
    Raises OutlineError: "open", "too-few-points", "not-planar", "zero-area", "not-finite".
    """
    if not polylines:
        raise OutlineError("too-few-points", NOTHING)
    points = np.concatenate([polyline.points for polyline in polylines])
    tolerance = 1e-6 * float(np.ptp(points, axis=0).max())
    loops = [_closed(polyline, tolerance) for polyline in polylines]
    plane = fit_plane(np.concatenate(loops), to_world, up)
    regions = np.array([polyline.region for polyline in polylines], dtype=np.int32)
    return Outline(
        tuple(plane.flatten(loop) for loop in loops),
        plane,
        np.array([polyline.spline for polyline in polylines], dtype=np.int32),
        np.array([polyline.material for polyline in polylines], dtype=np.int32),
        np.array([polyline.smooth for polyline in polylines], dtype=bool),
        slots,
        regions=regions if len(np.unique(regions)) > 1 else None,
    )


def _closed(polyline: Polyline, tolerance: float) -> np.ndarray:
    """The points (k, 3) of a closed polyline; one whose ends meet is closed."""
    points, name = polyline.points, f"Spline {polyline.spline}" if polyline.spline else "An outline"
    if not np.isfinite(points).all():
        message = f"{name} has a point whose coordinate or weight is not a finite number. Correct it, or delete it."
        raise OutlineError("not-finite", message, None, polyline.spline)
    if not polyline.closed and len(points) > 1 and np.abs(points[0] - points[-1]).max() > tolerance:
        remedy = "so that its edges lead back to where they start"
        if polyline.spline:
            remedy = "with Curve (or Stroke) > Toggle Cyclic"
        message = f"{name} is open. Close it in Edit Mode, {remedy}."
        raise OutlineError("open", message, points[0], polyline.spline)
    if len(points) < 3:
        count = "1 point" if len(points) == 1 else f"{len(points)} points"
        message = f"{name} has {count}, and an outline needs at least 3. Add points, or delete it."
        raise OutlineError("too-few-points", message, points[0] if len(points) else None, polyline.spline)
    if polyline.closed:
        return points
    if len(points) < 4:
        message = f"{name} has 2 different points, and an outline needs at least 3. Add points, or delete it."
        raise OutlineError("too-few-points", message, points[0], polyline.spline)
    return points[:-1]


def _distance(loop: np.ndarray, place: np.ndarray) -> float:
    """How far a place (2,) is from a loop (k, 2)."""
    along = np.roll(loop, -1, axis=0) - loop
    squared = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    fraction = np.clip(((place - loop) * along).sum(axis=1) / squared, 0.0, 1.0)
    return float(np.linalg.norm(loop + fraction[:, None] * along - place, axis=1).min())


def _divided(loop: np.ndarray, vertices: np.ndarray, edge_length: float) -> tuple[np.ndarray, np.ndarray]:
    """The points (k, 2) of a loop, and those that divide its edges evenly; the vertices (k,), -1 for the new ones."""
    following = np.roll(loop, -1, axis=0)
    count = np.maximum(np.rint(np.linalg.norm(following - loop, axis=1) / edge_length), 1).astype(int)
    edge = np.repeat(np.arange(len(loop)), count)
    step = np.arange(len(edge)) - (np.cumsum(count) - count)[edge]
    points = loop[edge] + (step / count[edge])[:, None] * (following - loop)[edge]
    return points, np.where(step == 0, vertices[edge], -1).astype(np.int32)
