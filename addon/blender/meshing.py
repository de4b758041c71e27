"""Object to mesh, without a change to the scene: what the operator and the command line share."""

from dataclasses import dataclass

import bpy
import numpy as np

from .reading import Outline
from .writing import write_mesh

# The default target edge length, as a fraction of the longer side of the largest outline's bounding box.
DEFAULT_FRACTION = 1 / 25


@dataclass(frozen=True)
class Meshed:
    """vertices: (n, 3) in the object's space; triangles: (m, 3) int32; report: the mesher's."""

    obj: bpy.types.Object
    vertices: np.ndarray
    triangles: np.ndarray
    report: object

    def write(self) -> bpy.types.Object:
        """Make the mesh object."""
        return write_mesh(self.obj, self.vertices, self.triangles)


def default_edge_length(outlines: list[Outline]) -> float:
    """A target edge length that suits the largest outline, to two significant digits, in world units."""
    return float(f"{DEFAULT_FRACTION * max(outline.size for outline in outlines):.2g}")


def mesh_outline(obj: bpy.types.Object, outline: Outline, edge_length: float, boundary: str) -> Meshed:
    """Mesh one object's outline as one domain. Raises the mesher's ContourError."""
    from .. import tessera  # loads onnxruntime and the networks: only when there is something to mesh

    mesh = tessera.mesh(outline.loops, edge_length, boundary=boundary.lower())
    return Meshed(obj, outline.plane.lift(mesh.vertices), mesh.triangles, mesh.report)
