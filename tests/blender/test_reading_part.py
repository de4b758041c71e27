"""A flat part of a mesh, meshed again: the rest stays as it is, and the mesh stays in one piece."""

import bmesh
import bpy
import numpy as np
import pytest

from addon.blender.errors import OutlineError
from addon.blender.writing import write_part
from tests.blender.drawing import SQUARE, star
from tests.blender.sources import mesh_object, meshed, read


def edit(obj, faces=(), edges=()):
    """Edit Mode, with only these faces and edges selected."""
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type="FACE" if faces else "EDGE")
    bpy.ops.mesh.select_all(action="DESELECT")
    bm = bmesh.from_edit_mesh(obj.data)
    bm.faces.ensure_lookup_table()
    bm.edges.ensure_lookup_table()
    for i in faces:
        bm.faces[i].select_set(True)
    for i in edges:
        bm.edges[i].select_set(True)
    bmesh.update_edit_mesh(obj.data)


def remesh(obj, edge_length=0.25, subdivide=True):
    outlines = read(obj)
    if subdivide:
        outlines = [outline.subdivided(edge_length) for outline in outlines]
    write_part(obj, meshed(outlines, edge_length))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not obj.data.validate(verbose=True)
    return obj.data


def cube():
    bpy.ops.mesh.primitive_cube_add(size=2.0)
    return bpy.context.object


def grid(n=4):
    """A flat grid of n × n squares of side 1."""
    steps = np.arange(n + 1.0)
    points = np.array([(x, y, 0.0) for y in steps for x in steps])
    faces = [
        (i + j * (n + 1), i + 1 + j * (n + 1), i + 1 + (j + 1) * (n + 1), i + (j + 1) * (n + 1))
        for j in range(n)
        for i in range(n)
    ]
    return mesh_object(points, [], faces)


def euler(data):
    return len(data.vertices) - len(data.edges) + len(data.polygons)


def edge_uses(data):
    """How many faces each edge has."""
    uses = np.zeros(len(data.edges), dtype=int)
    np.add.at(uses, [loop.edge_index for loop in data.loops], 1)
    return uses


def faces_of_area(data):
    return sum(polygon.area for polygon in data.polygons)


@pytest.mark.parametrize("subdivide", [True, False])
def test_one_side_of_a_cube_stays_welded_to_the_others(subdivide):
    obj = cube()
    edit(obj, faces=[2])
    normal = tuple(obj.data.polygons[2].normal)
    data = remesh(obj, subdivide=subdivide)
    assert euler(data) == 2 and (edge_uses(data) == 2).all()
    assert faces_of_area(data) == pytest.approx(24, rel=1e-5)
    made = [polygon for polygon in data.polygons if polygon.loop_total == 3]
    assert len(made) > (50 if subdivide else 3)
    assert all(np.dot(polygon.normal, normal) > 0.999 for polygon in made)
    assert all(polygon.select == (polygon.loop_total == 3) for polygon in data.polygons)
    # With a divided boundary the faces around have the new vertices too.
    assert sum(polygon.loop_total > 4 for polygon in data.polygons) == (4 if subdivide else 0)


def test_all_sides_of_a_cube_at_once_share_the_vertices_of_their_edges():
    obj = cube()
    edit(obj, faces=range(6))
    assert len(read(obj)) == 6
    data = remesh(obj)
    assert euler(data) == 2 and (edge_uses(data) == 2).all()
    assert {polygon.loop_total for polygon in data.polygons} == {3}
    assert faces_of_area(data) == pytest.approx(24, rel=1e-5)


def test_the_middle_of_a_grid_is_replaced_and_the_rest_stays():
    obj = grid()
    edit(obj, faces=[5, 6, 9, 10])
    data = remesh(obj, 0.4)
    assert euler(data) == 1
    assert faces_of_area(data) == pytest.approx(16)
    old = [polygon for polygon in data.polygons if polygon.loop_total >= 4]
    assert len(old) == 12
    lengths = np.array(
        [(data.vertices[a].co - data.vertices[b].co).length for a, b in (edge.vertices for edge in data.edges)]
    )
    assert 0.2 < lengths[edge_uses(data) == 2].min()


def test_a_selection_around_a_hole():
    obj = grid()
    edit(obj, faces=[face for face in range(16) if face not in (5, 6, 9, 10)])
    (outline,) = read(obj)
    assert len(outline.loops) == 2
    data = remesh(obj, 0.5)
    assert euler(data) == 1 and faces_of_area(data) == pytest.approx(16)


def test_uvs_materials_weights_and_shape_keys_are_those_of_the_faces_that_were_there():
    obj = grid()
    data = obj.data
    for name in ("One", "Two"):
        data.materials.append(bpy.data.materials.new(name))
    layer = data.uv_layers.new(name="Map")
    for loop in data.loops:
        x, y, _ = data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (0.1 * x + 0.2, 0.3 * y)
    for polygon in data.polygons:
        polygon.material_index, polygon.use_smooth = int(polygon.center.x > 2), False
    group = obj.vertex_groups.new(name="Height")
    for vertex in data.vertices:
        group.add([vertex.index], vertex.co.y / 4, "REPLACE")
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Up")
    for vertex, point in zip(data.vertices, key.data, strict=True):
        point.co.z = vertex.co.x
    edit(obj, faces=range(16))
    assert [outline.materials.tolist() for outline in read(obj)] == [[0], [1]]

    data = remesh(obj, 0.45)

    assert euler(data) == 1 and {polygon.loop_total for polygon in data.polygons} == {3}
    for polygon in data.polygons:
        assert polygon.material_index == int(polygon.center.x > 2) and not polygon.use_smooth
    layer = data.uv_layers["Map"]
    for loop in data.loops:
        x, y, _ = data.vertices[loop.vertex_index].co
        assert tuple(layer.data[loop.index].uv) == pytest.approx((0.1 * x + 0.2, 0.3 * y), abs=1e-4)
    for vertex in data.vertices:
        weight = sum(g.weight for g in vertex.groups)
        assert weight == pytest.approx(vertex.co.y / 4, abs=1e-4)
    for vertex, point in zip(data.vertices, obj.data.shape_keys.key_blocks["Up"].data, strict=True):
        assert point.co.z == pytest.approx(vertex.co.x, abs=1e-4)


def test_seams_and_sharp_edges_inside_the_selection_stay():
    obj = grid()
    for edge in obj.data.edges:
        ends = [obj.data.vertices[i].co for i in edge.vertices]
        edge.use_seam = all(end.x == 1 for end in ends)
        edge.use_edge_sharp = all(end.y == 3 for end in ends)
    edit(obj, faces=range(16))
    data = remesh(obj, 0.5)
    for name, axis, place in (("use_seam", 0, 1), ("use_edge_sharp", 1, 3)):
        marked = [edge for edge in data.edges if getattr(edge, name)]
        length = sum((data.vertices[a].co - data.vertices[b].co).length for a, b in (edge.vertices for edge in marked))
        assert length == pytest.approx(4)
        assert all(data.vertices[i].co[axis] == pytest.approx(place) for edge in marked for i in edge.vertices)


def test_a_closed_edge_loop_is_filled_facing_as_its_neighbours():
    obj = cube()
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(obj.data)
    bm.faces.ensure_lookup_table()
    gone = bm.faces[5]
    normal = tuple(gone.normal)
    bmesh.ops.delete(bm, geom=[gone], context="FACES_ONLY")
    bmesh.update_edit_mesh(obj.data)
    bpy.ops.object.mode_set(mode="OBJECT")
    around = [edge.index for edge, uses in zip(obj.data.edges, edge_uses(obj.data), strict=True) if uses == 1]
    edit(obj, edges=around)
    data = remesh(obj, 0.4)
    assert euler(data) == 2 and (edge_uses(data) == 2).all()
    made = [polygon for polygon in data.polygons if polygon.loop_total == 3]
    assert made and all(np.dot(polygon.normal, normal) > 0.999 for polygon in made)


def test_edge_loops_without_any_face_have_holes_in_each_other():
    outer, inner = np.array(SQUARE) * 4, star() * 0.8 + 2
    points = np.column_stack([np.concatenate([outer, inner]), np.zeros(4 + len(inner))])
    edges = [(i, (i + 1) % 4) for i in range(4)] + [(4 + i, 4 + (i + 1) % len(inner)) for i in range(len(inner))]
    obj = mesh_object(points, edges, [])
    edit(obj, edges=range(len(edges)))
    data = remesh(obj, 0.3)
    assert euler(data) == 0 and len(data.polygons) > 100
    assert all(polygon.normal.z > 0.999 for polygon in data.polygons)


def test_a_part_of_triangles_that_stay_as_they_are():
    obj = mesh_object([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    edit(obj, faces=[0])
    data = remesh(obj, 5.0)
    assert (len(data.vertices), len(data.edges), len(data.polygons)) == (3, 3, 1)


def test_a_scaled_object_is_meshed_at_the_worlds_length():
    obj = cube()
    obj.scale = (10, 1, -1)
    bpy.context.view_layer.update()
    edit(obj, faces=[5])
    data = remesh(obj, 0.5)
    made = [polygon for polygon in data.polygons if polygon.loop_total == 3]
    assert len(made) == pytest.approx(20 * 2 / (0.433 * 0.25), rel=0.4)


@pytest.mark.parametrize(
    ("reason", "select"),
    [
        ("too-few-points", lambda obj: edit(obj)),
        ("open", lambda obj: edit(obj, edges=[0, 1])),
    ],
)
def test_a_selection_that_cannot_be_is_said(reason, select):
    obj = cube()
    select(obj)
    with pytest.raises(OutlineError) as refusal:
        read(obj)
    assert refusal.value.reason == reason


def test_a_selection_that_is_not_flat_says_where():
    obj = mesh_object([(0, 0, 0), (1, 0, 0), (1, 1, 0.3), (0, 1, 0)], [], [(0, 1, 2, 3)])
    edit(obj, faces=[0])
    with pytest.raises(OutlineError, match="not planar") as refusal:
        read(obj)
    assert refusal.value.point is not None


def test_undo_is_one_step_in_edit_mode():
    obj = cube()
    edit(obj, faces=[2])
    bpy.ops.ed.undo_push(message="selected")
    write_part(obj, meshed([outline.subdivided(0.3) for outline in read(obj)], 0.3))
    bpy.ops.ed.undo_push(message="meshed")
    assert len(bmesh.from_edit_mesh(obj.data).faces) > 50
    bpy.ops.ed.undo()
    obj = bpy.context.object
    assert obj.mode == "EDIT"
    assert [face.index for face in bmesh.from_edit_mesh(obj.data).faces if face.select] == [2]
    assert len(bmesh.from_edit_mesh(obj.data).faces) == 6


def test_vertex_mode_selects_edges_that_are_not_meant():
    obj = grid()
    edit(obj)
    bpy.ops.mesh.select_mode(type="VERT")
    bm = bmesh.from_edit_mesh(obj.data)
    bm.faces.ensure_lookup_table()
    for number in (0, 3):  # far from each other, and one of the edges between them
        for vert in bm.faces[number].verts:
            vert.select = True
    for vert in bm.faces[1].verts:
        vert.select = vert.select or vert.co.y == 0
    bm.select_flush(True)
    assert any(edge.select and not any(face.select for face in edge.link_faces) for edge in bm.edges)
    parts = read(obj)
    assert sorted(int(face) for part in parts for face in part.part.faces) == [0, 3]


def test_a_loop_inside_of_flat_faces_is_refused():
    obj = grid()
    block = {5, 6, 9, 10}
    around = [
        edge.index for edge in obj.data.edges if sum(edge.key in obj.data.polygons[f].edge_keys for f in block) == 1
    ]
    edit(obj, edges=around)
    with pytest.raises(OutlineError, match="faces on both sides") as error:
        read(obj)
    assert error.value.reason == "overlap"
