"""Mesh objects to polylines: the borders of faces, and edges that have no face."""

from dataclasses import dataclass

import bpy
import numpy as np

from .chains import outline_edges, polylines
from .errors import OutlineError
from .outline import UP, Polyline
from .plane import fit_plane

_NOT_FLAT = "It is not flat. Select the flat part that is to be meshed again, in Edit Mode."


def read_mesh(evaluated: bpy.types.Object) -> tuple[list[Polyline], np.ndarray]:
    """The outlines of a mesh object as its modifiers leave it, and the direction (3,) that its faces face.

    Raises OutlineError "not-planar" if it is not flat.
    """
    mesh = evaluated.to_mesh()
    try:
        made, has_faces = borders(mesh, by_material=True), len(mesh.polygons) > 0
        if has_faces:
            _check_flat(mesh, made)
        return made, facing(mesh)
    finally:
        evaluated.to_mesh_clear()


def facing(mesh: bpy.types.Mesh) -> np.ndarray:
    """(3,) the direction that the faces of a flat mesh face, most of them by area; up, where there is none."""
    normals, areas = np.empty((len(mesh.polygons), 3), dtype=np.float32), np.empty(len(mesh.polygons), dtype=np.float32)
    mesh.polygons.foreach_get("normal", normals.ravel())
    mesh.polygons.foreach_get("area", areas)
    mean = (normals.astype(np.float64) * areas[:, None]).sum(axis=0)
    return mean if np.isfinite(mean).all() and np.linalg.norm(mean) > 1e-6 * areas.sum() else UP


def _check_flat(mesh: bpy.types.Mesh, outlines: list[Polyline]) -> None:
    """A mesh of faces is flat if its vertices are; its outlines alone would say nothing of what is between them."""
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    points = points.astype(np.float64)
    if not np.isfinite(points).all():
        return  # said of the outlines, with the place
    try:
        fit_plane(points, np.eye(3))
    except OutlineError as error:
        if error.reason == "not-planar" or not outlines:
            raise OutlineError("not-planar", _NOT_FLAT, error.point) from error


def borders(mesh: bpy.types.Mesh, by_material: bool = False) -> list[Polyline]:
    """Chains of the edges that bound something, with the material and shading of the faces beside them.

    A vertex inside a face is no chain; one that belongs to no face and no edge is a chain of its own, which is open.
    by_material: where there are several, the faces of each are a region with borders of its own, and what has no face
    is another.
    """
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
    face_edges, face_vertices = (np.empty(len(mesh.loops), dtype=np.int32) for _ in range(2))
    mesh.vertices.foreach_get("co", points.ravel())
    mesh.edges.foreach_get("vertices", edges.ravel())
    mesh.loops.foreach_get("edge_index", face_edges)
    mesh.loops.foreach_get("vertex_index", face_vertices)
    faces = _of_faces(mesh)
    material, smooth = _at_vertices(len(points), face_vertices, faces)
    slots = np.unique(faces.material) if by_material else ()
    bounds = [outline_edges(edges, face_edges)]
    if len(slots) > 1:
        own = [np.bincount(face_edges[faces.corners(slot)], minlength=len(edges)) for slot in slots]
        bounds = [*(edges[count == 1] for count in own), edges[sum(own) == 0]]
    made, points = [], points.astype(np.float64)
    for region, own in enumerate(bounds):
        for chain, closed in polylines(len(points), own):
            if len(chain) > 1 or not len(face_edges):
                slot = slots[region] if region < len(slots) > 1 else material[chain].min()
                made.append(Polyline(points[chain], closed, 0, int(slot), bool(smooth[chain].all()), region))
    return made


@dataclass(frozen=True)
class _Faces:
    """material, smooth, size: (f,) of each face: the slot, whether it is shaded smooth, how many corners it has."""

    material: np.ndarray
    smooth: np.ndarray
    size: np.ndarray

    def corners(self, slot: int) -> np.ndarray:
        """Which corners, one face behind the other, are of faces of a material."""
        return np.repeat(self.material == slot, self.size)


def _of_faces(mesh: bpy.types.Mesh) -> _Faces:
    faces = _Faces(*(np.empty(len(mesh.polygons), dtype=kind) for kind in (np.int32, bool, np.int32)))
    mesh.polygons.foreach_get("material_index", faces.material)
    mesh.polygons.foreach_get("use_smooth", faces.smooth)
    mesh.polygons.foreach_get("loop_total", faces.size)
    return faces


def _at_vertices(n_vertices: int, face_vertices: np.ndarray, faces: _Faces) -> tuple[np.ndarray, np.ndarray]:
    """At every vertex, the first material among its faces, and whether all are smooth; 0 and True without a face."""
    material = np.full(n_vertices, np.iinfo(np.int32).max, dtype=np.int32)
    np.minimum.at(material, face_vertices, np.repeat(faces.material, faces.size))
    material[material == np.iinfo(np.int32).max] = 0
    smooth = np.ones(n_vertices, dtype=bool)
    np.logical_and.at(smooth, face_vertices, np.repeat(faces.smooth, faces.size))
    return material, smooth
