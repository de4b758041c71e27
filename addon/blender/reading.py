"""From an object, as modifiers and animation leave it, to outlines: the one way in. Nothing of the scene is changed."""

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np

from .errors import OutlineError
from .evaluating import evaluated_object
from .kinds import shows_collection
from .outline import NOTHING, UP, Outline, Polyline, make_outline
from .plane import inverse
from .reading_curve import read_curve
from .reading_instances import has_instances, node_curves, node_meshes, placed_objects
from .reading_mesh import read_mesh
from .reading_part import read_parts
from .reading_strokes import read_curves, read_grease_pencil, read_old_grease_pencil


def read_outlines(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[Outline]:
    """The closed outlines of an object, at the resolution that Blender shows, all in the object's own space.

    Usually one, with holes and islands by the even-odd rule as in Blender's own fill, but of splines of all materials
    together. More than one where there are instances, or a mesh's flat parts selected in Edit Mode: each is to be
    meshed by itself, and all are to be written together. Raises OutlineError: "open", "not-planar", "too-few-points",
    "zero-area", "not-finite", "not-evaluated".
    """
    if obj.type == "MESH" and obj.mode == "EDIT":
        return read_parts(obj)
    if obj.type == "CURVE" and obj.mode == "EDIT" and obj.modifiers:
        _bring_edits(obj, depsgraph)
    evaluated, world = evaluated_object(obj, depsgraph)
    outlines = []
    if not shows_collection(obj):
        polylines, up = _own(evaluated, depsgraph)
        if polylines or not has_instances(obj):
            outline = make_outline(polylines, world[:3, :3], slots(obj), up)
            outlines.append(outline.uncrossed() if obj.type == "FONT" else outline)
    if has_instances(obj):
        outlines += _instances(evaluated, depsgraph, world)
    if not outlines:
        raise OutlineError("too-few-points", NOTHING)
    return outlines


def slots(obj: bpy.types.Object) -> tuple[bpy.types.Material | None, ...]:
    """The materials of an object's slots."""
    return tuple(slot.material for slot in obj.material_slots)


def _bring_edits(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    """Have what is being edited evaluated: Blender itself does so only when Edit Mode ends."""
    obj.update_from_editmode()
    obj.data.update_tag()
    depsgraph.update()


def _own(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[list[Polyline], np.ndarray]:
    """The polylines of one evaluated object's own geometry, and the direction (3,) that their upper side faces."""
    if evaluated.type == "MESH":
        return read_mesh(evaluated)
    if evaluated.type in {"CURVE", "FONT"}:
        return read_curve(evaluated, depsgraph), UP
    if evaluated.type == "CURVES":
        return read_curves(evaluated.data), UP
    if evaluated.type == "GREASEPENCIL":
        return read_grease_pencil(evaluated, np.array(evaluated.matrix_world, dtype=np.float64)), UP
    if evaluated.type == "GPENCIL":
        return read_old_grease_pencil(evaluated), UP
    return [], UP


def _instances(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph, world: np.ndarray) -> list[Outline]:
    """The outlines of everything that the object places, in its own space."""
    to_object, outlines = inverse(world), []
    for shown, matrix in placed_objects(evaluated, depsgraph):
        try:
            polylines, up = _own(shown, depsgraph)
            made = _placed(polylines, up, to_object @ matrix, world, slots(shown.original))
            outlines += [outline.uncrossed() for outline in made] if shown.type == "FONT" else made
        except OutlineError as error:
            raise OutlineError(error.reason, f"In '{shown.name}': {error}", error.point, error.spline) from error
    if not shows_collection(evaluated):
        for polylines, up, matrix, materials in (*node_meshes(evaluated, depsgraph), *node_curves(evaluated)):
            outlines += _placed(polylines, up, to_object @ matrix, world, materials)
    return outlines


def _placed(
    polylines: Sequence[Polyline],
    up: np.ndarray,
    matrix: np.ndarray,
    world: np.ndarray,
    materials: tuple[bpy.types.Material | None, ...],
) -> list[Outline]:
    """Polylines of another object's space, brought here by a matrix (4, 4) that keeps the side that they face."""
    if not polylines:
        return []
    moved = [replace(p, points=p.points @ matrix[:3, :3].T + matrix[:3, 3]) for p in polylines]
    return [make_outline(moved, world[:3, :3], materials, up @ inverse(matrix)[:3, :3])]
