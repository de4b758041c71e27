"""Mesh objects from meshed outlines: beside their source, in its place, of several sources, or into the same again."""

from collections.abc import Sequence

import bpy
import numpy as np

from .copying import copy_custom_properties, copy_object, link_beside
from .geometry import Geometry, Piece, join
from .writing_part import write_part

__all__ = ["Piece", "write_again", "write_in_place", "write_joined", "write_mesh", "write_part"]

BOUNDARY = "Boundary"
QUALITY = "element_quality"
UV_MAP = "UVMap"


def write_mesh(source: bpy.types.Object, pieces: Sequence[Piece]) -> bpy.types.Object:
    """A new mesh object beside `source`, which stays as it is.

    It has the source's transform, parent, collections, materials, custom properties and display.
    """
    obj = _new_object(_mesh_name(source), source, join(pieces))
    copy_object(source, obj)
    link_beside(source, obj)
    return obj


def write_joined(parts: Sequence[tuple[bpy.types.Object, Sequence[Piece]]]) -> bpy.types.Object:
    """One new mesh object of several sources, beside the first and with all that this has; the sources stay.

    The first is that of those whose scale is zero along no axis, as others may not lie in the plane of such a one.
    """
    matrices = [np.array(source.matrix_world, dtype=np.float64) for source, _ in parts]
    whole = [number for number, matrix in enumerate(matrices) if np.linalg.det(matrix[:3, :3]) != 0.0]
    number = whole[0] if whole else 0
    first = parts[number][0]
    to_first = (np.linalg.inv if whole else np.linalg.pinv)(matrices[number])
    pieces, placing = [], []
    for (source, own), matrix in zip(parts, matrices, strict=True):
        pieces += own
        placing += [None if source == first else to_first @ matrix] * len(own)
    obj = _new_object(_mesh_name(first), first, join(pieces, placing))
    copy_object(first, obj)
    link_beside(first, obj)
    return obj


def write_in_place(source: bpy.types.Object, pieces: Sequence[Piece]) -> bpy.types.Object:
    """The object as a mesh: what refers to it refers to the mesh object, which has its name and all that it had.

    Its modifiers are in the mesh, as in Blender's own Convert; its old data go where no other object has them, and with
    them what was of their points: weights, colours, shape keys. A mark as an asset goes, too. A mesh object stays the
    same object.
    """
    geometry, old = join(pieces), source.data
    if source.type == "MESH":
        _fill(source, geometry, _new_data(source.name, old))
        source.modifiers.clear()
        name = old.name
        _drop(old)
        source.data.name = name
        return source
    name, data_name = source.name, source.name if old is None else old.name
    source.name = f"{name} (replaced)"
    obj = _new_object(name, source, geometry)
    copy_object(source, obj, everything=True)
    source.user_remap(obj)  # collections, children, constraints, drivers: all that knew the source
    bpy.data.objects.remove(source)
    _drop(old)
    obj.name, obj.data.name = name, data_name
    return obj


def write_again(target: bpy.types.Object, pieces: Sequence[Piece]) -> None:
    """New geometry into a mesh object: its transform, modifiers, custom properties, and materials stay.

    So do vertex groups, which modifiers refer to, but without a vertex, as all are new; shape keys go with the old
    ones. Where it has no material, it gets those of the pieces. Other objects of the same mesh keep that as it was.
    """
    if target.data.users - target.data.use_fake_user > 1:
        target.data = target.data.copy()
    geometry, groups = join(pieces), [group.name for group in target.vertex_groups]
    if target.data.shape_keys is not None:
        target.shape_key_clear()
    target.data.clear_geometry()
    for name in groups:
        if name not in target.vertex_groups:
            target.vertex_groups.new(name=name)
    _fill(target, geometry, target.data)


def _mesh_name(source: bpy.types.Object) -> str:
    """The source's name and "Mesh", where Blender's limit leaves no room for both, with a shorter one."""
    longest = 255 if bpy.app.version >= (5, 0) else 63
    return source.name.encode()[: longest - len(" Mesh")].decode(errors="ignore") + " Mesh"


def _new_object(name: str, source: bpy.types.Object, geometry: Geometry) -> bpy.types.Object:
    data = _new_data(name, source.data)
    obj = bpy.data.objects.new(name, data)
    _fill(obj, geometry, data)
    return obj


def _new_data(name: str, source: bpy.types.ID | None) -> bpy.types.Mesh:
    """An empty mesh with the custom properties of the source's data."""
    data = bpy.data.meshes.new(name)
    if source is not None:
        copy_custom_properties(source, data)
    return data


def _fill(obj: bpy.types.Object, geometry: Geometry, data: bpy.types.Mesh) -> None:
    """Put geometry into an empty mesh, and make it the object's."""
    n_triangles = len(geometry.triangles)
    data.vertices.add(len(geometry.vertices))
    data.vertices.foreach_set("co", np.ascontiguousarray(geometry.vertices, dtype=np.float32).ravel())
    data.loops.add(3 * n_triangles)
    data.loops.foreach_set("vertex_index", np.ascontiguousarray(geometry.triangles, dtype=np.int32).ravel())
    data.polygons.add(n_triangles)
    data.polygons.foreach_set("loop_start", np.arange(0, 3 * n_triangles, 3, dtype=np.int32))
    if not len(data.materials):
        for material in geometry.slots:
            data.materials.append(material)
    data.polygons.foreach_set("material_index", np.minimum(geometry.materials, max(len(data.materials) - 1, 0)))
    data.polygons.foreach_set("use_smooth", geometry.smooth)
    data.update(calc_edges=True)
    uv = data.uv_layers.new(name=UV_MAP, do_init=False)
    uv.uv.foreach_set("vector", np.ascontiguousarray(geometry.uv, dtype=np.float32).ravel())
    quality = data.attributes.new(QUALITY, "FLOAT", "FACE")
    quality.data.foreach_set("value", geometry.quality.astype(np.float32))
    if obj.data != data:
        obj.data = data
    group = obj.vertex_groups.get(BOUNDARY) or obj.vertex_groups.new(name=BOUNDARY)
    group.add(geometry.boundary.tolist(), 1.0, "REPLACE")


def _drop(data: bpy.types.ID | None) -> None:
    """Remove data that nothing uses any more."""
    if data is not None and data.users == 0:
        bpy.data.batch_remove([data])
