"""A mesh object in the place of a curve: same transform, parent, collections and materials."""

import bpy
import numpy as np


def write_mesh(source: bpy.types.Object, vertices: np.ndarray, triangles: np.ndarray) -> bpy.types.Object:
    """A new mesh object beside `source`, which stays as it is.

    vertices: (n, 3) in the source object's space; triangles: (m, 3) int32.
    """
    name = f"{source.name} Mesh"
    data = _mesh_data(name, vertices, triangles)
    for slot in source.material_slots:
        data.materials.append(slot.material)
    obj = bpy.data.objects.new(name, data)
    _copy_transform(source, obj)
    for collection in _collections(source):
        collection.objects.link(obj)
    return obj


def _mesh_data(name: str, vertices: np.ndarray, triangles: np.ndarray) -> bpy.types.Mesh:
    n_triangles = len(triangles)
    data = bpy.data.meshes.new(name)
    data.vertices.add(len(vertices))
    data.vertices.foreach_set("co", np.ascontiguousarray(vertices, dtype=np.float32).ravel())
    data.loops.add(3 * n_triangles)
    data.loops.foreach_set("vertex_index", np.ascontiguousarray(triangles, dtype=np.int32).ravel())
    data.polygons.add(n_triangles)
    data.polygons.foreach_set("loop_start", np.arange(0, 3 * n_triangles, 3, dtype=np.int32))
    data.update(calc_edges=True)
    return data


def _copy_transform(source: bpy.types.Object, obj: bpy.types.Object) -> None:
    obj.parent = source.parent
    obj.parent_type = source.parent_type
    obj.parent_bone = source.parent_bone
    obj.parent_vertices = source.parent_vertices
    obj.matrix_parent_inverse = source.matrix_parent_inverse
    obj.rotation_mode = source.rotation_mode
    for channel in ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale"):
        setattr(obj, channel, getattr(source, channel))
        if channel != "rotation_axis_angle":
            setattr(obj, f"delta_{channel}", getattr(source, f"delta_{channel}"))
    for constraint in source.constraints:
        obj.constraints.copy(constraint)


def _collections(source: bpy.types.Object) -> list[bpy.types.Collection]:
    """The source's collections; where none can be linked to (they are a library's), the scene's own."""
    editable = [collection for collection in source.users_collection if collection.library is None]
    return editable or [bpy.context.scene.collection]
