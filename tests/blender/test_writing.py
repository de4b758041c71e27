"""What comes out: where it lies, what it has of its source, and what it tells of itself."""

import math
from itertools import pairwise

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from addon.blender.writing import write_joined, write_mesh
from addon.tessera.quality import element_quality
from tests.blender.drawing import (
    SQUARE,
    border,
    circle,
    distance_to,
    poly_curve,
    select,
    star,
    text,
    triangles,
    vertices,
    world,
)
from tests.blender.sources import grease_pencil, hair_curves, mesh_object, meshed, read


def write(obj, edge_length=None):
    made = write_mesh(obj, meshed(read(obj), edge_length))
    bpy.context.view_layer.update()
    assert not made.data.validate(verbose=True)
    return made


def corner_uvs(obj):
    out = np.empty((len(obj.data.loops), 2), dtype=np.float32)
    obj.data.uv_layers["UVMap"].uv.foreach_get("vector", out.ravel())
    return out.astype(np.float64).reshape(-1, 3, 2)


def values(obj, name):
    data = obj.data.attributes[name].data
    out = np.empty(len(data), dtype=np.float32)
    data.foreach_get("value", out)
    return out


def edge_lengths(corners):
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)


LOOP = np.column_stack([star(), np.zeros(14)]) @ np.array(Euler((0.4, 0.2, 0.9)).to_matrix()).T + (0.3, 0.1, 0.2)
DRAW = {
    "CURVE": lambda: poly_curve(LOOP, dimensions="3D"),
    "CURVES": lambda: hair_curves(LOOP),
    "GREASEPENCIL": lambda: grease_pencil(LOOP),
    "MESH": lambda: mesh_object(LOOP, [(i, (i + 1) % 14) for i in range(14)], []),
}


@pytest.mark.parametrize("size", [1e-4, 1.0, 1e4])
@pytest.mark.parametrize("kind", DRAW)
def test_a_negative_scaled_rotated_parented_outlines_mesh_lies_on_it(kind, size):
    obj = DRAW[kind]()
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.matrix_basis = Matrix.Translation((1, 1, 1)) @ Euler((0.5, 0.2, 1)).to_matrix().to_4x4()
    parent.scale = (2, 0.5, -2)
    obj.parent, obj.delta_location = parent, (0, 0, 3)
    obj.matrix_parent_inverse = Euler((0.1, 0.2, 0.3)).to_matrix().to_4x4()
    obj.rotation_mode, obj.rotation_quaternion = "QUATERNION", (0.4, 0.1, -0.7, 0.6)
    obj.scale = (-3 * size, 1 * size, 0.7 * size)
    bpy.context.view_layer.update()
    outline = world(obj, LOOP.astype(np.float32).astype(np.float64))
    extent = np.ptp(outline, axis=0).max()

    made = write(obj)

    assert made.parent == parent and made.matrix_world == obj.matrix_world
    tris = triangles(made)
    on_border = world(made, vertices(made)[np.unique(border(tris))])
    assert distance_to(outline, on_border).max() <= 1e-5 * extent
    assert all(np.linalg.norm(on_border - corner, axis=1).min() <= 1e-5 * extent for corner in outline)
    # It faces the upper side of the object's own space, whatever its scale.
    a, b, c = (vertices(made)[tris[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()
    # The flat shape is as large as it is in the world, and begins at the origin.
    flat, lengths = corner_uvs(made), edge_lengths(world(made, vertices(made))[tris])
    assert np.abs(flat.reshape(-1, 2).min(axis=0)).max() <= 1e-6 * flat.max()
    assert edge_lengths(flat) == pytest.approx(lengths, rel=1e-3)
    # The quality is that of the elements as they are in the world.
    assert values(made, "element_quality") == pytest.approx(
        element_quality(flat.reshape(-1, 2), np.arange(tris.size).reshape(-1, 3)), abs=1e-3
    )


def test_the_flat_shape_is_neither_mirrored_nor_turned():
    made = write(poly_curve(star()))
    points, flat = vertices(made)[triangles(made)], corner_uvs(made)
    scale = np.ptp(flat.reshape(-1, 2)[:, 1]) / np.ptp(points.reshape(-1, 3)[:, 1])
    shift = points[..., :2] * scale - flat
    assert np.ptp(shift.reshape(-1, 2), axis=0).max() < 1e-5


def test_an_outline_that_stands_upright_is_upright_in_the_map():
    loop = np.column_stack([star()[:, 0], np.zeros(14), star()[:, 1]])
    made = write(poly_curve(loop, dimensions="3D"))
    points, flat = vertices(made)[triangles(made)].reshape(-1, 3), corner_uvs(made).reshape(-1, 2)
    assert np.corrcoef(points[:, 0], flat[:, 0])[0, 1] > 0.999
    assert np.corrcoef(points[:, 2], flat[:, 1])[0, 1] > 0.999
    assert all(polygon.normal.y < -0.999 for polygon in made.data.polygons)


def test_the_boundary_is_a_vertex_group():
    made = write(text("O"))
    group = made.vertex_groups["Boundary"].index
    members = {
        vertex.index for vertex in made.data.vertices if any(g.group == group and g.weight == 1 for g in vertex.groups)
    }
    assert members == set(np.unique(border(triangles(made))).tolist())
    assert 10 < len(members) < len(made.data.vertices)


def test_materials_and_shading_go_by_spline_and_so_do_holes():
    ring, island = np.array(SQUARE) * 4, np.array(SQUARE) + 1.5
    hole = np.array(SQUARE) * 2 + 1
    curve = poly_curve(ring, hole, island, np.array(SQUARE) + 6)
    inks = [bpy.data.materials.new(name) for name in ("A", "B", "C")]
    for ink in inks:
        curve.data.materials.append(ink)
    for spline, material, smooth in zip(curve.data.splines, (0, 1, 2, 1), (True, True, False, True), strict=True):
        spline.material_index, spline.use_smooth = material, smooth
    made = write(curve)
    assert [slot.material for slot in made.material_slots] == inks
    for polygon in made.data.polygons:
        x, y, _ = polygon.center
        inside = 1.5 < x < 2.5 and 1.5 < y < 2.5
        assert polygon.material_index == (2 if inside else 1 if x > 5 else 0)
        assert polygon.use_smooth == (not inside)


def test_a_material_without_a_slot_is_the_last_slots():
    curve = poly_curve(SQUARE)
    curve.data.materials.append(bpy.data.materials.new("Only"))
    outlines = read(curve)
    outlines = [type(o)(**{**vars(o), "materials": np.array([7], dtype=np.int32)}) for o in outlines]
    made = write_mesh(curve, meshed(outlines))
    assert {polygon.material_index for polygon in made.data.polygons} == {0}


def test_joined_every_source_is_where_it_was_and_faces_where_it_did():
    first, second, third = poly_curve(star(), name="First"), circle(name="Second"), text("O", name="Third")
    first.location, first.rotation_euler, first.scale = (1, 2, 3), (0.3, 0.2, 0.1), (2, -1, 1)
    second.matrix_basis = Matrix.Translation((5, 0, 0)) @ Matrix.Diagonal((-1, 1, 1, 1))
    third.matrix_basis = Matrix.Translation((0, 5, 0)) @ Matrix.Diagonal((1, 1, -1, 1))
    red, blue = (bpy.data.materials.new(name) for name in ("Red", "Blue"))
    for obj, ink in ((first, red), (second, blue), (third, red)):
        obj.data.materials.append(ink)
    parts = [(obj, meshed(read(obj), 0.2)) for obj in (first, second, third)]
    alone = [write_mesh(*part) for part in parts]
    made = write_joined(parts)
    bpy.context.view_layer.update()

    assert made.name == "First Mesh.001" and made.matrix_world == first.matrix_world
    assert [slot.material for slot in made.material_slots] == [red, blue]
    assert not made.data.validate(verbose=True)
    expected = np.concatenate([world(obj, vertices(obj)) for obj in alone])
    found = world(made, vertices(made))
    assert len(found) == len(expected) and np.abs(np.sort(found, axis=0) - np.sort(expected, axis=0)).max() < 1e-4
    start = 0
    for obj in alone:
        polygons = made.data.polygons[start : start + len(obj.data.polygons)]
        start += len(polygons)
        turned = np.linalg.inv(np.array(made.matrix_world.to_3x3()))
        own = np.linalg.inv(np.array(obj.matrix_world.to_3x3())).T @ np.array(obj.data.polygons[0].normal)
        here = turned.T @ np.array(polygons[0].normal)
        assert here @ own > 0.999 * np.linalg.norm(here) * np.linalg.norm(own)
        assert {polygon.material_index for polygon in polygons} == {1 if obj == alone[1] else 0}
    # All flat shapes by one scale, none upon another.
    flat, lengths = corner_uvs(made), edge_lengths(world(made, vertices(made))[triangles(made)])
    assert edge_lengths(flat) == pytest.approx(lengths, rel=1e-3)
    boxes, start = [], 0
    for obj in alone:
        here = flat[start : start + len(obj.data.polygons)].reshape(-1, 2)
        start += len(obj.data.polygons)
        boxes.append((here[:, 0].min(), here[:, 0].max()))
    boxes.sort()
    assert all(left[1] < right[0] for left, right in pairwise(boxes))


def test_pieces_of_one_garment_have_one_scale_also_after_one_was_changed():
    sleeve, front = poly_curve(np.array(SQUARE) * (0.4, 0.3), name="Sleeve"), poly_curve(star() * 0.5, name="Front")
    front.scale = (1.5, 1.2, 1)
    select(sleeve, front)
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1, keep_linked=True) == {"FINISHED"}
    pieces = [bpy.data.objects["Sleeve Mesh"], bpy.data.objects["Front Mesh"]]
    sleeve.data.splines[0].points[2].co.x = 0.9
    bpy.context.view_layer.update()
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    for made in pieces:
        lengths = edge_lengths(world(made, vertices(made))[triangles(made)])
        assert edge_lengths(corner_uvs(made)) == pytest.approx(lengths, rel=1e-3)
    assert corner_uvs(pieces[0])[..., 0].max() == pytest.approx(0.9)


def test_drawings_of_one_plane_keep_their_places_in_the_map():
    parts = [poly_curve(np.array(SQUARE) + (3 * i, i), name=f"Path {i}") for i in range(3)]
    made = write_joined([(obj, meshed(read(obj), 0.3)) for obj in parts])
    points, flat = vertices(made)[triangles(made)][..., :2], corner_uvs(made)
    assert np.ptp((points - flat).reshape(-1, 2), axis=0).max() < 1e-6


@pytest.mark.parametrize("joined", [False, True])
def test_splines_that_touch_become_one_mesh_with_common_vertices(joined):
    squares = [np.array(SQUARE), np.array(SQUARE) + (1, 0), np.array(SQUARE) + (0, 1), np.array(SQUARE) + (1, 1)]
    if joined:
        objects = [poly_curve(square, name="Part") for square in squares]
        made = write_joined([(obj, meshed(read(obj), 0.2)) for obj in objects])
    else:
        curve = poly_curve(*squares)
        made = write_mesh(curve, meshed(read(curve), 0.2))
    tris = triangles(made)
    edges = len(made.data.edges)
    assert len(made.data.vertices) - edges + len(tris) == 1
    rim = vertices(made)[np.unique(border(tris))]
    assert (np.isclose(rim[:, :2], 0) | np.isclose(rim[:, :2], 2)).any(axis=1).all()
    group = made.vertex_groups["Boundary"].index
    assert sum(any(g.group == group for g in v.groups) for v in made.data.vertices) == len(rim)


def test_linked_collections_do_not_matter_to_where_it_goes():
    curve = poly_curve(SQUARE)
    bpy.context.scene.collection.objects.unlink(curve)
    made = write_mesh(curve, meshed(read_unlinked(curve)))
    assert made.users_collection == (bpy.context.scene.collection,)


def read_unlinked(curve):
    bpy.context.scene.collection.objects.link(curve)
    outlines = read(curve)
    bpy.context.scene.collection.objects.unlink(curve)
    return outlines


def test_an_axis_without_scale_that_is_not_in_the_plane_does_not_matter():
    curve = poly_curve(star())
    curve.scale = (1, 1, 0)
    bpy.context.view_layer.update()
    assert len(write(curve).data.polygons) > 20
    assert math.isclose(curve.scale.z, 0.0)
