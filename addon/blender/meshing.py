"""Object to mesh, without a change to the scene: what the operator and the command line share.

Importing this loads the mesher and onnxruntime; it is imported when there is something to mesh.
"""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector

from .. import tessera
from .plane import Plane
from .reading import Outline, read_outline
from .writing import write_mesh

# The default target edge length, as a fraction of the longer side of the largest outline's bounding box.
DEFAULT_FRACTION = 1 / 25


@dataclass(frozen=True)
class Meshed:
    """vertices: (n, 3) in the object's space; triangles: (m, 3) int32; report: the mesher's."""

    obj: bpy.types.Object
    vertices: np.ndarray
    triangles: np.ndarray
    report: tessera.Report

    def write(self) -> bpy.types.Object:
        """Make the mesh object."""
        return write_mesh(self.obj, self.vertices, self.triangles)


class Failure(Exception):
    """An object's ContourError, in the words that the user sees. `reason` is the ContourError's.

    The ContourError knows places in the outline's plane; with the plane, the message also says where in the world.
    """

    def __init__(self, obj: bpy.types.Object, error: tessera.ContourError, plane: Plane | None = None) -> None:
        kind = "Text" if obj.type == "FONT" else "Curve"
        message = f"{kind} '{obj.name}': {error}"
        if plane is not None and error.place is not None:
            world = obj.matrix_world @ Vector(plane.lift(np.array([error.place]))[0])
            message += f" In the world, that is at ({world.x:.4g}, {world.y:.4g}, {world.z:.4g})."
        super().__init__(message)
        self.reason = error.reason


def read(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Outline:
    """The object's outline. Raises Failure."""
    try:
        return read_outline(obj, depsgraph)
    except tessera.ContourError as error:
        raise Failure(obj, error) from error


def default_edge_length(outlines: list[Outline]) -> float:
    """A target edge length that suits the largest outline, to two significant digits, in world units."""
    return float(f"{DEFAULT_FRACTION * max(outline.size for outline in outlines):.2g}")


def mesh(obj: bpy.types.Object, outline: Outline, edge_length: float, boundary: str) -> Meshed:
    """Mesh one object's outline as one domain; boundary: "resample" or "keep". Raises Failure."""
    try:
        made = tessera.mesh(outline.loops, edge_length, boundary=boundary)
    except tessera.ContourError as error:
        raise Failure(obj, error, outline.plane) from error
    vertices = outline.plane.lift(made.vertices)
    if _lost_in_rounding(outline.plane, made, vertices):
        message = (
            "Triangles so small are lost in the single precision of Blender's meshes, so far from the object's origin. "
            "Use a larger edge length, or Object > Set Origin > Origin to Geometry."
        )
        raise Failure(obj, tessera.ContourError("edge-length", message))
    return Meshed(obj, vertices, made.triangles, made.report)


def _lost_in_rounding(plane: Plane, made: tessera.Mesh, vertices: np.ndarray) -> bool:
    """Whether elements that are no slivers lose their area when vertices (n, 3) are rounded to single precision."""
    rounded = plane.flatten(vertices.astype(np.float32).astype(np.float64))
    fat = tessera.element_quality(made.vertices, made.triangles) > 0.01
    return bool((tessera.element_quality(rounded, made.triangles[fat]) <= 0).any())
