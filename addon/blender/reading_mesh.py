"""Mesh objects to polylines: the borders of faces, and edges that have no face."""

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
        made, has_faces = borders(mesh), len(mesh.polygons) > 0
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


def borders(mesh: bpy.types.Mesh) -> list[Polyline]:
    """Chains of the edges that bound something, with the material and shading of the faces beside them.

    A vertex inside a face is no chain; one that belongs to no face and no edge is a chain of its own, which is open.
    """
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
    face_edges, face_vertices = (np.empty(len(mesh.loops), dtype=np.int32) for _ in range(2))
    mesh.vertices.foreach_get("co", points.ravel())
    mesh.edges.foreach_get("vertices", edges.ravel())
    mesh.loops.foreach_get("edge_index", face_edges)
    mesh.loops.foreach_get("vertex_index", face_vertices)
    chains = polylines(len(points), outline_edges(edges, face_edges))
    if len(face_edges):
        chains = [(chain, closed) for chain, closed in chains if len(chain) > 1]
    material, smooth = _at_vertices(mesh, face_vertices)
    points = points.astype(np.float64)
    return [
        Polyline(points[chain], closed, 0, int(material[chain].min()), bool(smooth[chain].all()))
        for chain, closed in chains
    ]


def _at_vertices(mesh: bpy.types.Mesh, face_vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At every vertex, the first material among its faces, and whether all are smooth; 0 and True without a face."""
    of_face, is_smooth, size = (np.empty(len(mesh.polygons), dtype=t) for t in (np.int32, bool, np.int32))
    mesh.polygons.foreach_get("material_index", of_face)
    mesh.polygons.foreach_get("use_smooth", is_smooth)
    mesh.polygons.foreach_get("loop_total", size)
    material = np.full(len(mesh.vertices), np.iinfo(np.int32).max, dtype=np.int32)
    np.minimum.at(material, face_vertices, np.repeat(of_face, size))
    material[material == np.iinfo(np.int32).max] = 0
    smooth = np.ones(len(mesh.vertices), dtype=bool)
    np.logical_and.at(smooth, face_vertices, np.repeat(is_smooth, size))
    return material, smooth
