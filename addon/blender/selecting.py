"""What is nearest to a place of a curve, a mesh or strokes, selected for their Edit Modes; all else is not."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from .kinds import STROKES
from .reading_strokes import layer_matrix

_SELECTED = ".selection"  # the attribute by which Blender knows selected points


def can_select(obj: bpy.types.Object) -> bool:
    """Whether an object has points that the user can select; a text has none, and what a library holds is not his."""
    return obj.type in {"CURVE", "MESH", *STROKES} and obj.is_editable and obj.data.is_editable


def select_nearest(obj: bpy.types.Object, number: int, at: np.ndarray) -> None:
    """Select one point of an object in Object Mode, and enter its Edit Mode.

    number: of the spline or stroke, from 1; 0: any; at: (3,) in the object's space.
    """
    if obj.type == "MESH":
        _in_mesh(obj.data, at)
        bpy.context.tool_settings.mesh_select_mode = (True, False, False)  # else it would not be seen
    elif obj.type in STROKES:
        _in_strokes(obj, number, at)
    bpy.ops.object.mode_set(mode="EDIT")
    if obj.type == "CURVE":
        _in_curve(obj.data, number, at)


def _in_curve(curve: bpy.types.Curve, number: int, at: np.ndarray) -> None:
    bpy.ops.curve.select_all(action="DESELECT")
    splines = [curve.splines[number - 1]] if 0 < number <= len(curve.splines) else curve.splines
    points = [point for spline in splines for point in (spline.bezier_points or spline.points)]
    if points:
        nearest = min(points, key=lambda point: np.linalg.norm(np.array(point.co)[:3] - at))
        name = "select_control_point" if isinstance(nearest, bpy.types.BezierSplinePoint) else "select"
        setattr(nearest, name, True)


def _in_mesh(mesh: bpy.types.Mesh, at: np.ndarray) -> None:
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    chosen = np.zeros(len(mesh.vertices), dtype=bool)
    if len(chosen):
        chosen[np.argmin(np.linalg.norm(points.reshape(-1, 3) - at, axis=1))] = True
    for items in (mesh.edges, mesh.polygons):
        items.foreach_set("select", np.zeros(len(items), dtype=bool))
    mesh.vertices.foreach_set("select", chosen)


def _in_strokes(obj: bpy.types.Object, number: int, at: np.ndarray) -> None:
    """Strokes are counted through all drawings that are shown."""
    drawings = list(_drawings(obj))
    counts = np.concatenate([np.diff(first) for _, first, _ in drawings] or [np.zeros(0, dtype=int)])
    stroke = np.repeat(np.arange(1, len(counts) + 1), counts)
    far = [np.linalg.norm(points - at, axis=1) for _, _, points in drawings]
    far = np.where((stroke == number) | (number not in stroke), np.concatenate(far or [np.zeros(0)]), np.inf)
    chosen = np.zeros(len(far), dtype=bool)
    if len(far):
        chosen[np.argmin(far)] = True
    start = 0
    for attributes, _, points in drawings:
        if _SELECTED in attributes:
            attributes.remove(attributes[_SELECTED])  # it may be one of whole strokes
        attributes.new(_SELECTED, "BOOLEAN", "POINT").data.foreach_set("value", chosen[start : start + len(points)])
        start += len(points)


def _drawings(obj: bpy.types.Object) -> Iterator[tuple]:
    """Of each drawing: attributes, where each stroke begins (k + 1,), and places (n, 3) in the object's space."""
    if obj.type == "CURVES":
        yield _drawing(obj.data.attributes, obj.data.curve_offset_data, np.eye(4))
        return
    world = np.array(obj.matrix_world, dtype=np.float64)
    for layer in obj.data.layers:
        frame = None if layer.hide else layer.current_frame()
        if frame is not None:
            yield _drawing(frame.drawing.attributes, frame.drawing.curve_offsets, layer_matrix(layer, world))


def _drawing(attributes, offsets, matrix: np.ndarray) -> tuple:
    if "position" not in attributes or not len(attributes["position"].data):
        return attributes, np.zeros(1, dtype=np.int32), np.zeros((0, 3))
    first = np.empty(len(offsets), dtype=np.int32)
    offsets.foreach_get("value", first)
    points = np.empty((len(attributes["position"].data), 3), dtype=np.float32)
    attributes["position"].data.foreach_get("vector", points.ravel())
    return attributes, first, points @ matrix[:3, :3].T + matrix[:3, 3]
