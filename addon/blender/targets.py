"""What a sizing is made of in the scene: painted weights and the points of another object, in an outline's plane."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from .. import tessera
from ..tessera.sampling import cut
from .errors import OutlineError
from .outline import Outline
from .points import object_edges, weighted_points
from .settings import Settings

# An edge of another object is looked at in so many places at most.
_MOST_PLACES = 256


@dataclass(frozen=True)
class Targets:
    """weights: places (k, 2) and weights (k,); near: start and end (k, 2) of edges, for a point both are the same.

    All in an outline's plane; None where the settings ask for none.
    """

    weights: tuple[np.ndarray, np.ndarray] | None = None
    near: tuple[np.ndarray, np.ndarray] | None = None


def read_targets(
    obj: bpy.types.Object, outline: Outline, settings: Settings, depsgraph: bpy.types.Depsgraph
) -> Targets:
    """Read what the settings name. Raises ContourError "sizing" where there is none or it is no number.

    Nothing is named between switching a sizing on and choosing what it refers to: that is `unnamed`, and no error.
    """
    weights = near = None
    if settings.use_weight and settings.weight_name:
        points, values = weighted_points(obj, settings.weight_name, depsgraph)
        _check_finite(values, f"A weight of '{settings.weight_name}'")
        weights = outline.plane.flatten(points), values
    if settings.use_object and settings.object_name:
        ends = _near_ends(settings.object_name, depsgraph)
        into = np.array(obj.matrix_world.inverted_safe(), dtype=np.float64)
        near = tuple(outline.plane.flatten(points @ into[:3, :3].T + into[:3, 3]) for points in ends)
    return Targets(weights, near)


def unnamed(settings: Settings) -> list[str]:
    """A sentence for each sizing that is switched on and has nothing to refer to yet."""
    missing = []
    if settings.use_weight and not settings.weight_name:
        missing.append("By Weight has no effect yet: give the name of a vertex group or an attribute")
    if settings.use_object and not settings.object_name:
        missing.append("By Object has no effect yet: choose the object")
    return missing


def _near_ends(name: str | tuple[str, str], depsgraph: bpy.types.Depsgraph) -> tuple[np.ndarray, np.ndarray]:
    other = bpy.data.objects.get(name)
    if other is None:
        message = f"The sizing refers to an object, and there is none named '{name}'. Choose one."
        raise tessera.ContourError("sizing", message)
    try:
        ends = object_edges(other, depsgraph)
    except OutlineError as error:
        raise tessera.ContourError(
            "sizing", f"Of the object '{other.name}' that the sizing refers to: {error}"
        ) from error
    _check_finite(np.concatenate(ends), f"A place of '{other.name}'")
    return ends


def _check_finite(values: np.ndarray, what: str) -> None:
    if not np.isfinite(values).all():
        message = f"{what} is not a finite number. Correct it, or choose another for the sizing."
        raise tessera.ContourError("sizing", message)


def sizing_of(settings: Settings, targets: Targets, edge_length: float, automatic: float):
    """The sizing for `tessera.mesh`: the smallest of all that are chosen, or None.

    automatic: what an edge length of 0 is, at the boundary, under full weight and at an object.
    """
    chosen = []
    if settings.use_curvature:
        chosen.append(tessera.by_curvature(settings.curvature_ratio))
    if settings.use_distance:
        near = settings.distance_length or automatic
        chosen.append(tessera.by_distance(near, reach=settings.distance_reach or None))
    if settings.use_thickness:
        chosen.append(tessera.by_thickness(settings.thickness_elements))
    if targets.weights is not None:
        points, weights = targets.weights
        shorter = (settings.weight_length or automatic) / edge_length
        chosen.append(tessera.from_values(points, edge_length * shorter ** np.clip(weights, 0, 1)))
    if targets.near is not None:
        near = settings.object_length or automatic
        start, end = targets.near
        pieces = np.minimum(np.linalg.norm(end - start, axis=1) / near, _MOST_PLACES)
        points = np.concatenate([cut(start, end, np.ceil(pieces))[0], end])
        chosen.append(tessera.by_distance(near, points, reach=settings.object_reach or None))
    return tessera.smallest(*chosen) if chosen else None
