"""What an object shows of others: a collection's objects, and the meshes that geometry nodes place."""

from collections.abc import Iterator

import bpy
import numpy as np

from .kinds import shows_collection
from .outline import Polyline
from .reading_mesh import borders

# What fills the persistent id of an instance behind its own numbers.
_NO_NUMBER = 2**31 - 1


def has_instances(obj: bpy.types.Object) -> bool:
    """Whether the object may show more than its own geometry."""
    return shows_collection(obj) or any(m.type == "NODES" and m.show_viewport for m in obj.modifiers)


def collection_objects(
    evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[bpy.types.Object, np.ndarray]]:
    """The evaluated objects that a collection's instance shows, each with its world matrix (4, 4) there."""
    shown = set()
    for instance in depsgraph.object_instances:
        if not instance.is_instance or instance.parent != evaluated or instance.instance_object == evaluated:
            continue
        matrix = np.array(instance.matrix_world, dtype=np.float64)
        key = instance.instance_object.name_full, matrix.tobytes()
        if key not in shown:  # a filled curve is there once as a curve and once as a mesh
            shown.add(key)
            yield instance.instance_object, matrix


def node_meshes(
    evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[tuple[list[Polyline], np.ndarray, tuple[bpy.types.Material | None, ...]]]:
    """The meshes that geometry nodes place: their outlines, world matrix (4, 4) and materials.

    The object's own mesh is not among them; that of an object whose own data are no mesh is.
    """
    own_is_mesh = evaluated.type in {"CURVE", "FONT", "MESH"}
    for instance in depsgraph.object_instances:
        if not instance.is_instance or instance.parent != evaluated or instance.object.type != "MESH":
            continue
        placed = instance.persistent_id[1] != _NO_NUMBER
        if placed or not own_is_mesh:
            mesh = instance.object.data
            materials = tuple(m and m.original for m in mesh.materials)
            yield borders(mesh), np.array(instance.matrix_world, dtype=np.float64), materials
