"""What could not be meshed, in the words that the user sees, and where it is."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np
from mathutils import Vector

from .errors import OutlineError

if TYPE_CHECKING:
    import bpy

    from ..tessera.errors import ContourError
    from .outline import Outline

_STROKES = "Grease pencil"
_KINDS = {"FONT": "Text", "MESH": "Mesh", "EMPTY": "Instances", "GREASEPENCIL": _STROKES, "GPENCIL": _STROKES}
# The library knows places in the outline's plane only, and loops by no name that the user would know.
_SENTENCES = {
    "self-intersection": "crosses or touches itself near {place}: move points there to keep its edges apart.",
    "crossing": "crosses or touches another near {place}: move them apart, or join them into one.",
}
# What the library calls by the names of its arguments.
_LABELS = {"min_edge_length": "Shortest Edge"}
_PLACE = re.compile(r"\((-?[\d.]+(?:e[+-]?\d+)?), (-?[\d.]+(?:e[+-]?\d+)?)\)")


class Failure(Exception):
    """An object's ContourError as one sentence: object, spline, cause, place and remedy.

    reason: the ContourError's; spline: its number from 1, or 0 where it is not known; place: in the world, or None.
    """

    def __init__(self, obj: bpy.types.Object, error: ContourError, outline: Outline | None = None) -> None:
        self.obj, self.reason, self.spline, self.place = obj.name, error.reason, 0, None
        if outline is not None and error.place is not None:
            self.spline = int(outline.splines[outline.loop_near(error.place)])
            self.place = _in_world(obj, outline, error.place)
        elif isinstance(error, OutlineError) and error.point is not None:
            self.spline, self.place = error.spline, tuple(obj.matrix_world @ Vector(error.point))
        super().__init__(_sentence(obj, error, self.spline, self.place, outline))


def with_world_places(sentence: str, obj: bpy.types.Object, outline: Outline) -> str:
    """What the library says of an outline, with its places in the world."""

    def lifted(found: re.Match) -> str:
        return _where(_in_world(obj, outline, tuple(map(float, found.groups()))))

    return _PLACE.sub(lifted, sentence)


def _in_world(obj: bpy.types.Object, outline: Outline, place: tuple[float, float]) -> tuple[float, float, float]:
    return tuple(obj.matrix_world @ Vector(outline.plane.lift(np.array([place], dtype=np.float64))[0]))


def _where(place: tuple[float, float, float]) -> str:
    return f"({', '.join(f'{x:.4g}' for x in place)})"


def _sentence(
    obj: bpy.types.Object, error: ContourError, spline: int, place: tuple | None, outline: Outline | None
) -> str:
    # Errors of reading name the spline themselves, and nobody knows those of a text.
    spline = 0 if isinstance(error, OutlineError) or obj.type == "FONT" else spline
    name = f"{_KINDS.get(obj.type, 'Curve')} '{obj.name}'"
    if spline:
        name += f", spline {spline}"
    where = _where(place) if place else ""
    if place and error.reason in _SENTENCES:
        return f"{name} {_SENTENCES[error.reason].format(place=where)}"
    text = str(error) if outline is None else with_world_places(str(error), obj, outline)
    for python, label in _LABELS.items():
        text = text.replace(python, label)
    return f"{name}: {text}" + (f" That is at {where}." if place and where not in text else "")
