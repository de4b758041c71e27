"""What an object shows of others: the objects that it places, and what geometry nodes make and place."""

from collections.abc import Iterator

import bpy
import numpy as np

from .errors import OutlineError
from .kinds import shows_collection
from .outline import UP, Polyline
from .reading_mesh import borders, facing
from .reading_strokes import read_curves

# What fills the persistent id of an instance behind its own numbers.
_NO_NUMBER = 2**31 - 1

Shown = tuple[list[Polyline], np.ndarray, np.ndarray, tuple[bpy.types.Material | None, ...]]


def has_instances(obj: bpy.types.Object) -> bool:
    """Whether the object may show more than its own geometry."""
    return shows_collection(obj) or any(m.type == "NODES" and m.show_viewport for m in obj.modifiers)


def placed_objects(
    evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, np.ndarray]]:
    """The evaluated objects that a collection's instance or geometry nodes show, each with its world matrix (4, 4)."""
    shown = set()
    for instance in depsgraph.object_instances:
        if not instance.is_instance or instance.parent != evaluated or instance.instance_object == evaluated:
            continue
        matrix = np.array(instance.matrix_world, dtype=np.float64)
        key = instance.instance_object.name_full, matrix.tobytes()
        if key not in shown:  # a filled curve is there once as a curve and once as a mesh
            shown.add(key)
            yield instance.instance_object, matrix


def node_meshes(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Iterator[Shown]:
    """The meshes that geometry nodes make and place: their outlines, the side that these face, world matrix (4, 4) and
    materials.

    The object's own mesh is not among them; that of an object whose own data are no mesh is.
    """
    own_is_mesh = evaluated.type in {"CURVE", "FONT", "MESH"}
    for instance in depsgraph.object_instances:
        if not instance.is_instance or instance.parent != evaluated or instance.instance_object != evaluated:
            continue
        placed = instance.persistent_id[1] != _NO_NUMBER
        if instance.object.type == "MESH" and (placed or not own_is_mesh):
            mesh = instance.object.data
            world = np.array(instance.matrix_world, dtype=np.float64)
            yield borders(mesh, by_material=True), facing(mesh), world, _materials(mesh)
        elif instance.object.type == "CURVE" and not hasattr(evaluated, "evaluated_geometry"):
            message = "Its geometry nodes make curves, which can be read from Blender 4.5 on. Add a Fill Curve node."
            raise OutlineError("too-few-points", message)


def node_curves(evaluated: bpy.types.Object) -> Iterator[Shown]:
    """The curves that geometry nodes make and place, in the same way; from Blender 4.5 on."""
    if hasattr(evaluated, "evaluated_geometry"):
        world = np.array(evaluated.matrix_world, dtype=np.float64)
        yield from _curves_in(evaluated.evaluated_geometry(), world, evaluated.type in {"CURVE", "FONT", "CURVES"})


def _curves_in(geometry: "bpy.types.GeometrySet", matrix: np.ndarray, is_own: bool) -> Iterator[Shown]:
    """is_own: whether the object's data are curves, so that those of the geometry itself are read as these."""
    if geometry.curves is not None and not is_own:
        yield read_curves(geometry.curves), UP, matrix, _materials(geometry.curves)
    places = geometry.instances_pointcloud()
    if places is None:
        return
    number = np.empty(len(places.points), dtype=np.int32)
    places.attributes[".reference_index"].data.foreach_get("value", number)
    transforms = np.empty((len(number), 4, 4), dtype=np.float32)
    places.attributes["instance_transform"].data.foreach_get("value", transforms.ravel())
    references = geometry.instance_references()
    for reference, columns in zip(number.tolist(), transforms.astype(np.float64), strict=True):
        if isinstance(references[reference], bpy.types.GeometrySet):
            yield from _curves_in(references[reference], matrix @ columns.T, is_own=False)


def _materials(data: bpy.types.ID) -> tuple[bpy.types.Material | None, ...]:
    return tuple(material and material.original for material in data.materials)
