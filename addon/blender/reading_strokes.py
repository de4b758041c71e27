"""Curves (hair) and Grease Pencil objects to polylines: both keep their points in attributes, a run of them a curve."""

import bpy
import numpy as np

from . import splines
from .outline import Polyline
from .plane import inverse

_CATMULL_ROM, _POLY, _BEZIER, _NURBS = range(4)
_VECTOR_HANDLE = 2
_FIELDS = {"FLOAT_VECTOR": ("vector", np.float32, 3), "FLOAT": ("value", np.float32, 1), "BOOLEAN": ("value", bool, 1)}


def read_curves(data: bpy.types.Curves) -> list[Polyline]:
    """One polyline a curve of a Curves object's data, at its own resolution."""
    return _read(data.attributes, data.curve_offset_data)


def read_grease_pencil(evaluated: bpy.types.Object, world: np.ndarray) -> list[Polyline]:
    """One polyline a stroke that is shown at the current frame; one that is filled counts as closed.

    world: (4, 4), the object's world matrix, as layers may have a parent of their own.
    """
    drawn: list[Polyline] = []
    for layer in evaluated.data.layers:
        frame = None if layer.hide else layer.current_frame()
        if frame is not None:
            strokes = _read(frame.drawing.attributes, frame.drawing.curve_offsets, default_type=_POLY)
            drawn += [_placed(stroke, layer_matrix(layer, world)) for stroke in strokes]
    return _numbered(evaluated, drawn)


def read_old_grease_pencil(evaluated: bpy.types.Object) -> list[Polyline]:
    """The same for the Grease Pencil of Blender 4.2."""
    drawn = []
    for layer in evaluated.data.layers:
        strokes = [] if layer.hide or layer.active_frame is None else layer.active_frame.strokes
        for stroke in strokes:
            points = np.empty((len(stroke.points), 3), dtype=np.float32)
            stroke.points.foreach_get("co", points.ravel())
            polyline = Polyline(points.astype(np.float64), stroke.use_cyclic, 0, stroke.material_index)
            drawn.append(_placed(polyline, np.array(layer.matrix_layer, dtype=np.float64)))
    return _numbered(evaluated, drawn)


def _numbered(evaluated: bpy.types.Object, drawn: list[Polyline]) -> list[Polyline]:
    filled = [_is_filled(slot.material) for slot in evaluated.material_slots]
    return [
        Polyline(p.points, p.closed or (p.material < len(filled) and filled[p.material]), number, p.material)
        for number, p in enumerate(drawn, start=1)
    ]


def _is_filled(material: bpy.types.Material | None) -> bool:
    """Whether a material fills strokes; since Blender 5.2, strokes have fills of their own instead (`fill_id`)."""
    if material is None or material.grease_pencil is None:
        return False
    setting = material.grease_pencil.bl_rna.properties["show_fill"]
    return not getattr(setting, "is_deprecated", False) and material.grease_pencil.show_fill


def layer_matrix(layer: bpy.types.bpy_struct, world: np.ndarray) -> np.ndarray:
    """(4, 4), from the layer's space to that of the object with this world matrix (4, 4)."""
    local = np.array(layer.matrix_local, dtype=np.float64)
    if layer.parent is None:
        return local
    parent = np.array(layer.parent.matrix_world @ layer.matrix_parent_inverse, dtype=np.float64)
    return inverse(world) @ parent @ local


def _placed(polyline: Polyline, matrix: np.ndarray) -> Polyline:
    points = polyline.points @ matrix[:3, :3].T + matrix[:3, 3]
    return Polyline(points, polyline.closed, polyline.spline, polyline.material, polyline.smooth)


def _read(attributes, offsets, default_type: int = _CATMULL_ROM) -> list[Polyline]:
    """The polylines of one set of curves; what an attribute that is not there means, is Blender's own default."""
    if "position" not in attributes or not len(attributes["position"].data):
        return []  # what offsets then say of their own number, is not so
    first = np.empty(len(offsets), dtype=np.int32)
    offsets.foreach_get("value", first)
    n_curves, n_points = len(first) - 1, int(first[-1])

    def of_curves(name: str, default: int) -> np.ndarray:
        return _attribute(attributes, name, n_curves, default)

    def of_points(name: str, default: float) -> np.ndarray:
        return _attribute(attributes, name, n_points, default)

    position = of_points("position", 0.0).reshape(-1, 3)
    columns = zip(
        first[:-1],
        first[1:],
        of_curves("curve_type", default_type),
        of_curves("cyclic", 0),
        of_curves("resolution", 12),
        of_curves("nurbs_order", 4),
        of_curves("knots_mode", 0),
        of_curves("material_index", 0),
        of_curves("fill_id", 0),
        strict=True,
    )
    drawn = []
    for number, (start, end, kind, cyclic, resolution, order, knots, material, fill) in enumerate(columns, start=1):
        here, points = slice(start, end), position[start:end]
        if kind == _CATMULL_ROM:
            points = splines.catmull_rom(points, bool(cyclic), int(resolution))
        elif kind == _BEZIER:
            left, right = (of_points(name, 0.0).reshape(-1, 3)[here] for name in ("handle_left", "handle_right"))
            arrives, leaves = (of_points(name, 0)[here] for name in ("handle_type_left", "handle_type_right"))
            straight = (leaves == _VECTOR_HANDLE) & (np.roll(arrives, -1) == _VECTOR_HANDLE)
            points = splines.bezier(points, left, right, straight, bool(cyclic), int(resolution))
        elif kind == _NURBS:
            weights = of_points("nurbs_weight", 1.0)[here]
            modes = bool(knots & 1), bool(knots & 2)
            points = splines.nurbs(points, weights, int(order), bool(cyclic), *modes, int(resolution))
        drawn.append(Polyline(points, bool(cyclic or fill), number, int(material)))
    return drawn


def _attribute(attributes, name: str, n: int, default: float) -> np.ndarray:
    """An attribute's values (n,) or (3 n,), float64 or int64, or the default for all."""
    attribute = attributes.get(name)
    if attribute is None or len(attribute.data) != n:
        return np.full(3 * n if name == "position" else n, default)
    field, dtype, width = _FIELDS.get(attribute.data_type, ("value", np.int32, 1))
    values = np.empty(n * width, dtype=dtype)
    attribute.data.foreach_get(field, values)
    return values.astype(np.float64 if dtype is np.float32 else np.int64)
