"""Points of objects that a sizing refers to: painted weights, and what is near. Blender's data to arrays."""

from __future__ import annotations

from collections.abc import Iterator

import bmesh
import bpy
import numpy as np

from ..tessera.errors import ContourError
from .evaluating import evaluated_object
from .reading_strokes import read_curves

# What every control point of a curve object has, by the names that the Curve's own panel gives them.
_OF_SPLINES = {"weight": "weight_softbody", "radius": "radius", "tilt": "tilt"}


def weighted_points(obj: bpy.types.Object, name: str, depsgraph: bpy.types.Depsgraph) -> tuple[np.ndarray, np.ndarray]:
    """Points (k, 3) float64 in the object's space, and their weights (k,).

    name: a vertex group or a float attribute of the points; a curve's control points have `weight` (that of soft
    bodies), `radius` and `tilt`. Raises ContourError "sizing" where there is no such name.
    """
    pairs = list(_weights(obj, name, depsgraph))
    if not pairs or not any(len(values) for _, values in pairs):
        known = ", ".join(f"'{known}'" for known in weight_names(obj)) or "no weights"
        message = f"There are no weights named '{name}'; it has {known}. Choose one, or switch Sizing by Weight off."
        raise ContourError("sizing", message)
    return np.concatenate([points for points, _ in pairs]), np.concatenate([values for _, values in pairs])


def weight_names(obj: bpy.types.Object) -> list[str]:
    """The names that `weighted_points` knows for an object."""
    if obj.type == "CURVE":
        return list(_OF_SPLINES)
    names = [group.name for group in obj.vertex_groups]
    attributes = getattr(obj.data, "attributes", ())
    return names + [each.name for each in attributes if each.domain == "POINT" and each.data_type == "FLOAT"]


def _weights(obj, name, depsgraph) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    if obj.type == "CURVE" and name in _OF_SPLINES:
        for spline in obj.data.splines:
            points = spline.bezier_points if spline.type == "BEZIER" else spline.points
            yield _gathered(points, "co")[:, :3], _gathered(points, _OF_SPLINES[name])[:, 0]
    elif obj.type == "MESH":
        yield _mesh_weights(obj, name)
    elif obj.type == "CURVES":
        yield _attribute(obj.data, name)
    elif obj.type == "GREASEPENCIL":
        for drawing in _drawings(obj):
            yield _attribute(drawing, name)


def _mesh_weights(obj: bpy.types.Object, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Of a mesh in any mode: in Edit Mode only the edit mesh is as the user sees it."""
    group = obj.vertex_groups.get(name)
    mesh = bmesh.from_edit_mesh(obj.data) if obj.mode == "EDIT" else bmesh.new()
    if obj.mode != "EDIT":
        mesh.from_mesh(obj.data)
    points = np.array([vertex.co for vertex in mesh.verts], dtype=np.float64).reshape(-1, 3)
    layer = mesh.verts.layers.deform.active if group else mesh.verts.layers.float.get(name)
    if layer is None:
        values = np.zeros(len(points) if group else 0)  # in no vertex is there a weight, or there is no such name
    elif group:
        values = np.array([vertex[layer].get(group.index, 0.0) for vertex in mesh.verts])
    else:
        values = np.array([vertex[layer] for vertex in mesh.verts])
    if obj.mode != "EDIT":
        mesh.free()
    return points[: len(values)], values


def _attribute(data, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Of what has a position for each point."""
    attribute = data.attributes.get(name)
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != "FLOAT":
        return np.zeros((0, 3)), np.zeros(0)
    return _gathered(data.attributes["position"].data, "vector"), _gathered(attribute.data, "value")[:, 0]


def object_edges(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[np.ndarray, np.ndarray]:
    """Start and end (k, 3) float64, in world space, of all edges of an object; a point is an edge of no length.

    An empty, or another object without points, is its origin. Modifiers are applied. Raises OutlineError.
    """
    evaluated, to_world = evaluated_object(obj, depsgraph)
    if obj.type in {"CURVES", "GREASEPENCIL", "GPENCIL"}:
        start, end = _stroke_edges(evaluated)
    else:
        start, end = _mesh_edges(evaluated)
    if not len(start):
        start = end = np.zeros((1, 3))
    return tuple(points @ to_world[:3, :3].T + to_world[:3, 3] for points in (start, end))


def _mesh_edges(evaluated: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    if evaluated.type not in {"MESH", "CURVE", "FONT", "SURFACE", "META"}:
        return np.zeros((0, 3)), np.zeros((0, 3))
    mesh = evaluated.to_mesh()
    if mesh is None:
        return np.zeros((0, 3)), np.zeros((0, 3))
    points, edges = _gathered(mesh.vertices, "co"), np.empty(2 * len(mesh.edges), dtype=np.int32)
    mesh.edges.foreach_get("vertices", edges)
    evaluated.to_mesh_clear()
    edges = edges.reshape(-1, 2)
    alone = np.setdiff1d(np.arange(len(points)), edges)
    return points[np.concatenate([edges[:, 0], alone])], points[np.concatenate([edges[:, 1], alone])]


def _stroke_edges(evaluated: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    """Between the points of each stroke that is seen; a stroke of one point is an edge of no length."""
    starts, ends = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for points in _strokes(evaluated):
        starts.append(points[:-1] if len(points) > 1 else points)
        ends.append(points[1:] if len(points) > 1 else points)
    return np.concatenate(starts), np.concatenate(ends)


def _strokes(obj: bpy.types.Object) -> Iterator[np.ndarray]:
    """The points (k, 3) of each curve, or of each stroke of the frame that is shown."""
    if obj.type == "CURVES":
        yield from (polyline.points for polyline in read_curves(obj.data))
    elif obj.type == "GREASEPENCIL":
        for drawing in _drawings(obj):
            if len(drawing.attributes["position"].data):
                position = _gathered(drawing.attributes["position"].data, "vector")
                counts = [len(stroke.points) for stroke in drawing.strokes]
                yield from np.split(position, np.cumsum(counts)[:-1])
    else:  # as Blender 4.2 has it
        for layer in obj.data.layers:
            for stroke in layer.active_frame.strokes if layer.active_frame and not layer.hide else ():
                yield _gathered(stroke.points, "co")


def _drawings(obj: bpy.types.Object) -> Iterator:
    for layer in obj.data.layers:
        frame = None if layer.hide else layer.current_frame()
        if frame is not None and frame.drawing is not None:
            yield frame.drawing


def _gathered(items, name: str) -> np.ndarray:
    """One attribute of all items: (k, as many as it has) float64."""
    if not len(items):
        return np.zeros((0, 3))
    value = getattr(items[0], name)
    width = len(value) if hasattr(value, "__len__") else 1
    out = np.empty(len(items) * width, dtype=np.float32)
    items.foreach_get(name, out)
    return out.reshape(-1, width).astype(np.float64)
