"""Objects of the kinds that `drawing.py` has not, linked into the scene and selected; meshing without the operator."""

import bpy
import numpy as np

from addon import tessera
from addon.blender.reading import read_outlines
from addon.blender.writing import Piece
from tests.blender.drawing import _link


def hair_curves(*loops, name="Curves", kind="POLY", cyclic=True):
    """A Curves object; loops: (k, 3) each."""
    data = bpy.data.hair_curves.new(name)
    data.add_curves([len(loop) for loop in loops])
    data.position_data.foreach_set("vector", np.concatenate(loops).astype(np.float32).ravel())
    _set(data.attributes, "cyclic", "BOOLEAN", [cyclic] * len(loops))
    obj = bpy.data.objects.new(name, data)
    if hasattr(data, "set_types"):
        data.set_types(type=kind)
    elif kind != "CATMULL_ROM":  # before Blender 4.5, only nodes can

        def change_type(tree, geometry):
            node = tree.nodes.new("GeometryNodeCurveSplineType")
            node.spline_type = kind
            tree.links.new(geometry, node.inputs["Curve"])
            return node.outputs[0]

        obj.modifiers.new("Type", "NODES").node_group = node_group(change_type)
    return _link(obj)


def grease_pencil(*loops, name="Strokes", cyclic=True, **layer_settings):
    """A Grease Pencil object with one layer and one frame; loops: (k, 3) each."""
    kept_in = "grease_pencils_v3" if hasattr(bpy.data, "grease_pencils_v3") else "grease_pencils"
    data = getattr(bpy.data, kept_in).new(name)
    layer = data.layers.new("Layer")
    (_draw_strokes if bpy.app.version >= (4, 3) else _draw_old_strokes)(layer.frames.new(1), loops, cyclic)
    for setting, value in layer_settings.items():
        setattr(layer, setting, value)
    return _link(bpy.data.objects.new(name, data))


def set_cyclic(obj, number, cyclic):
    """Open or close one curve of a Curves or Grease Pencil object."""
    if obj.type == "GPENCIL":
        obj.data.layers[0].frames[0].strokes[number].use_cyclic = cyclic
    else:
        holder = obj.data if obj.type == "CURVES" else obj.data.layers[0].frames[0].drawing
        holder.attributes["cyclic"].data[number].value = cyclic


def _draw_strokes(frame, loops, cyclic):
    drawing = frame.drawing
    drawing.add_strokes([len(loop) for loop in loops])
    drawing.attributes["position"].data.foreach_set("vector", np.concatenate(loops).astype(np.float32).ravel())
    _set(drawing.attributes, "cyclic", "BOOLEAN", [cyclic] * len(loops))


def _draw_old_strokes(frame, loops, cyclic):
    """In Blender 4.2."""
    for loop in loops:
        stroke = frame.strokes.new()
        stroke.points.add(len(loop))
        stroke.points.foreach_set("co", np.asarray(loop, dtype=np.float32).ravel())
        stroke.use_cyclic = cyclic


def mesh_object(points, edges, faces, name="Flat"):
    """A mesh object, as Mesh.from_pydata takes it."""
    data = bpy.data.meshes.new(name)
    data.from_pydata([tuple(point) for point in points], edges, faces)
    data.update()
    return _link(bpy.data.objects.new(name, data))


def collection_of(*objects, name="Shown"):
    """A collection that is in no scene, of these objects only."""
    collection = bpy.data.collections.new(name)
    for obj in objects:
        for other in obj.users_collection:
            other.objects.unlink(obj)
        collection.objects.link(obj)
    return collection


def instance_of(collection, name="Instance"):
    """An empty that shows a collection."""
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    return _link(empty)


def node_group(build):
    """Geometry nodes from the object's geometry to what `build(tree, input socket)` gives as output socket."""
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(build(tree, start.outputs[0]), end.inputs[0])
    return tree


def read(obj):
    """Its outlines."""
    if obj.data is not None:
        obj.data.update_tag()  # attributes are set without Blender's notice
    bpy.context.view_layer.update()
    return read_outlines(obj, bpy.context.evaluated_depsgraph_get())


def meshed(outlines, edge_length=None, boundary="resample"):
    """The piece of each outline; edge_length: a twelfth of each outline's size where it is not given."""
    pieces = []
    for outline in outlines:
        way = boundary if outline.part is None else "keep"
        made = tessera.mesh(outline.loops, edge_length or outline.size / 12, boundary=way)
        pieces.append(Piece(outline, made.vertices, made.triangles, region(outline.loops, made)))
    return pieces


def region(loops, made):
    """The outer contour around each triangle: the smallest loop that its centre is in, by crossings of a ray."""
    centre = made.vertices[made.triangles].mean(axis=1)
    around = np.array([_inside(centre, loop) for loop in loops])
    size = np.array([np.prod(np.ptp(loop, axis=0)) for loop in loops])
    assert around.any(axis=0).all()
    return np.argmin(np.where(around, size[:, None], np.inf), axis=0)


def _inside(points, loop):
    start, end = loop, np.roll(loop, -1, axis=0)
    spans = (start[:, 1] > points[:, None, 1]) != (end[:, 1] > points[:, None, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        at = start[:, 0] + (points[:, None, 1] - start[:, 1]) / (end[:, 1] - start[:, 1]) * (end[:, 0] - start[:, 0])
    return (spans & (points[:, None, 0] < at)).sum(axis=1) % 2 == 1


def _set(attributes, name, kind, values):
    attribute = attributes.get(name) or attributes.new(name, kind, "CURVE")
    attribute.data.foreach_set("value", np.array(values, dtype=bool if kind == "BOOLEAN" else np.int32))
