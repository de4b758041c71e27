"""Every kind of object is read as Blender shows it, and nothing is left of the reading."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix, Vector

from addon import tessera
from addon.blender import writing
from addon.blender.errors import OutlineError
from addon.blender.kinds import is_readable
from addon.blender.reading_curve import read_curve
from tests.blender import sources
from tests.blender.drawing import SQUARE, circle, poly_curve, select, star, text
from tests.blender.sources import grease_pencil, hair_curves, mesh_object, read


def flat(loop, z=0.0):
    return np.column_stack([loop, np.full(len(loop), z)])


def area(loop):
    x, y = np.asarray(loop).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def lifted(outline):
    """All points of an outline in the object's space."""
    return np.concatenate([outline.plane.lift(loop) for loop in outline.loops])


STAR = flat(star(), 2.0)
KINDS = {
    "CURVE": lambda: poly_curve(STAR, dimensions="3D"),
    "CURVES": lambda: hair_curves(STAR),
    "GREASEPENCIL": lambda: grease_pencil(STAR),
    "MESH": lambda: mesh_object(STAR, [], [range(len(STAR))]),
    "MESH, wire": lambda: mesh_object(STAR, [(i, (i + 1) % len(STAR)) for i in range(len(STAR))], []),
}


@pytest.mark.parametrize("name", KINDS)
def test_a_star_of_every_kind_is_read_to_the_last_bit(name):
    obj = KINDS[name]()
    assert obj.type in (name.split(",")[0], "GPENCIL") and is_readable(obj)
    (outline,) = read(obj)
    (loop,) = outline.loops
    found = {tuple(point) for point in outline.plane.lift(loop).tolist()}
    assert found == {tuple(point) for point in STAR.astype(np.float32).astype(np.float64).tolist()}
    assert outline.size == pytest.approx(np.ptp(STAR[:, :2], axis=0).max())
    assert outline.splines.tolist() == ([0] if name.startswith("MESH") else [1])


def data_blocks():
    return {(type(item).__name__, item.name, item.users) for item in bpy.data.user_map()}


@pytest.mark.parametrize("name", KINDS)
def test_reading_leaves_nothing_behind(name):
    obj = KINDS[name]()
    before = data_blocks()
    read(obj)
    assert data_blocks() == before
    matrix, obj.scale = obj.scale.copy(), (1, 0, 1)
    with pytest.raises(OutlineError, match="scale is zero"):
        read(obj)
    obj.scale = matrix
    assert data_blocks() == before


@pytest.mark.parametrize("name", ["CURVE", "CURVES", "GREASEPENCIL", "MESH, wire"])
def test_an_open_one_of_every_kind_says_which_and_where(name):
    loops = (STAR, STAR[:5] + (5, 0, 0))
    if name == "CURVE":
        obj = poly_curve(*loops, dimensions="3D")
        obj.data.splines[1].use_cyclic_u = False
    elif name == "MESH, wire":
        obj = mesh_object(loops[1], [(i, i + 1) for i in range(4)], [])
    else:
        obj = (hair_curves if name == "CURVES" else grease_pencil)(*loops)
        sources.set_cyclic(obj, 1, False)
    with pytest.raises(OutlineError) as refusal:
        read(obj)
    assert refusal.value.reason == "open" and "is open" in str(refusal.value)
    assert ("Curve (or Stroke) > Toggle Cyclic" in str(refusal.value)) != name.startswith("MESH")
    assert refusal.value.spline == (0 if name.startswith("MESH") else 2)
    assert refusal.value.point == pytest.approx(loops[1][0])


@pytest.mark.parametrize("name", KINDS)
def test_one_that_is_not_flat_says_where(name):
    loop = STAR.copy()
    loop[3, 2] += 0.4
    draw = {"CURVE": lambda *a: poly_curve(*a, dimensions="3D"), "CURVES": hair_curves, "GREASEPENCIL": grease_pencil}
    if name == "MESH, wire":
        obj = mesh_object(loop, [(i, (i + 1) % len(loop)) for i in range(len(loop))], [])
    elif name == "MESH":
        obj = mesh_object(loop, [], [range(len(loop))])
    else:
        obj = draw[name](loop)
    with pytest.raises(OutlineError) as refusal:
        read(obj)
    assert refusal.value.reason == "not-planar"
    assert refusal.value.point == pytest.approx(loop[3])


def test_splines_are_counted_as_blender_lists_them_with_their_materials_and_shading():
    curve = poly_curve(SQUARE, star() + 4, np.array(SQUARE) + 8)
    for _ in range(3):
        curve.data.materials.append(bpy.data.materials.new("Ink"))
    for number, (material, smooth) in enumerate([(2, True), (0, False), (1, True)]):
        curve.data.splines[number].material_index, curve.data.splines[number].use_smooth = material, smooth
    (outline,) = read(curve)
    assert outline.splines.tolist() == [1, 2, 3]
    assert outline.materials.tolist() == [2, 0, 1]
    assert outline.smooth.tolist() == [True, False, True]
    assert [material.name for material in outline.slots] == ["Ink", "Ink.001", "Ink.002"]
    assert outline.loop_near((4.5, 0.2)) == 1 and outline.loop_near((8.5, 7.0)) == 2


def test_splines_keep_their_numbers_through_a_modifier_that_deforms_what_blender_makes_of_them():
    curve = poly_curve(SQUARE, np.array(SQUARE) + 3, dimensions="3D")
    for name in ("One", "Two"):
        curve.data.materials.append(bpy.data.materials.new(name))
    curve.data.splines[1].material_index = 1
    curve.modifiers.new("Cast", "CAST").factor = 0.0
    (outline,) = read(curve)
    assert outline.splines.tolist() == [1, 2] and outline.materials.tolist() == [0, 1]


def test_each_letter_of_a_text_has_its_material():
    words = text("AB")
    for _ in range(2):
        words.data.materials.append(bpy.data.materials.new("Ink"))
    words.data.body_format[1].material_index = 1
    (outline,) = read(words)
    assert sorted(outline.materials.tolist()) == [0, 0, 1, 1, 1]  # A has one hole, B has two


def test_a_text_on_a_curve_is_read_where_it_stands():
    words, path = text("ring"), circle(radius=2.0)
    words.data.follow_curve = path
    (outline,) = read(words)
    radii = np.linalg.norm(lifted(outline), axis=1)
    assert radii.min() > 1.5


@pytest.mark.parametrize(("kind", "least"), [("CATMULL_ROM", 0.3), ("NURBS", 0.3), ("BEZIER", 0.2), ("POLY", 1e-9)])
def test_curves_of_every_type(kind, least):
    obj = hair_curves(flat(np.array(SQUARE)), kind=kind)
    if kind == "BEZIER":
        for side, turn in (("left", -1), ("right", 1)):
            attribute = obj.data.attributes.new(f"handle_{side}", "FLOAT_VECTOR", "POINT")
            handles = flat(np.array(SQUARE)) + turn * 0.2 * np.array([(1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, -1, 0)])
            attribute.data.foreach_set("vector", handles.astype(np.float32).ravel())
    (outline,) = read(obj)
    (loop,) = outline.loops
    assert (len(loop) == 4) == (kind == "POLY")
    corners = np.array(SQUARE)
    away = max(min(np.linalg.norm(corners - point, axis=1)) for point in loop)
    assert away >= least - 1e-9
    assert area(loop) > 0.3


def test_curves_after_geometry_nodes_that_change_them():
    obj = hair_curves(STAR)

    def larger(tree, geometry):
        node = tree.nodes.new("GeometryNodeTransform")
        node.inputs["Scale"].default_value = (3, 3, 1)
        tree.links.new(geometry, node.inputs["Geometry"])
        return node.outputs[0]

    obj.modifiers.new("Nodes", "NODES").node_group = sources.node_group(larger)
    (outline,) = read(obj)
    assert outline.size == pytest.approx(3 * np.ptp(STAR[:, :2], axis=0).max())


def test_a_fill_closes_a_stroke():
    obj = grease_pencil(STAR, cyclic=False)
    with pytest.raises(OutlineError, match="open"):
        read(obj)
    if bpy.app.version >= (5, 2):
        obj.data.layers[0].frames[0].drawing.strokes[0].fill_id = 1
    else:
        material = bpy.data.materials.new("Fill")
        bpy.data.materials.create_gpencil_data(material)
        material.grease_pencil.show_fill = True
        obj.data.materials.append(material)
    assert len(read(obj)[0].loops) == 1


def test_layers_of_strokes_have_a_transform_and_may_be_hidden():
    obj = grease_pencil(STAR, **{"translation" if bpy.app.version >= (4, 3) else "location": (10, 0, 0)})
    assert lifted(read(obj)[0])[:, 0].min() > 8
    obj.data.layers[0].hide = True
    with pytest.raises(OutlineError, match="no outline"):
        read(obj)


@pytest.mark.skipif(bpy.app.version < (4, 3), reason="a layer's own parent is read since Blender 4.3")
def test_layers_of_strokes_have_a_parent():
    obj = grease_pencil(STAR, translation=(10, 0, 0))
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location, obj.location = (0, 5, 0), (0, 0, 3)
    obj.data.layers[0].parent = parent
    moved = lifted(read(obj)[0])
    assert moved.mean(axis=0) == pytest.approx((10, 5, 2 - 3), abs=1e-5)


def test_modifiers_of_strokes():
    obj = grease_pencil(STAR)
    if obj.type == "GPENCIL":
        modifier = obj.grease_pencil_modifiers.new("Array", "GP_ARRAY")
    else:
        modifier = obj.modifiers.new("Array", "GREASE_PENCIL_ARRAY")
    modifier.count, modifier.relative_offset = 3, (1.5, 0, 0)
    (outline,) = read(obj)
    assert outline.splines.tolist() == [1, 2, 3]


def test_a_mesh_with_holes_and_what_its_faces_have():
    ring = [(0, 0), (3, 0), (3, 3), (0, 3), (1, 1), (2, 1), (2, 2), (1, 2)]
    faces = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
    obj = mesh_object(flat(np.array(ring)), [], faces)
    for name in ("One", "Two"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for polygon in obj.data.polygons:
        polygon.material_index, polygon.use_smooth = 1, False
    (outline,) = read(obj)
    assert sorted(abs(area(loop)) for loop in outline.loops) == pytest.approx([1, 9])
    assert outline.materials.tolist() == [1, 1] and outline.smooth.tolist() == [False, False]


def test_a_mesh_that_is_not_flat_is_told_from_one_without_anything():
    bpy.ops.mesh.primitive_cube_add()
    with pytest.raises(OutlineError, match="flat part that is to be meshed again, in Edit Mode") as refusal:
        read(bpy.context.object)
    assert refusal.value.reason == "not-planar"
    # A cone without its base has a flat border, and is not flat.
    bpy.ops.mesh.primitive_cone_add(end_fill_type="NOTHING")
    with pytest.raises(OutlineError, match="It is not flat"):
        read(bpy.context.object)


def test_a_meshs_modifiers_are_read():
    obj = mesh_object(flat(np.array(SQUARE)), [], [(0, 1, 2, 3)])
    modifier = obj.modifiers.new("Array", "ARRAY")
    modifier.count, modifier.relative_offset_displace = 3, (1.5, 0, 0)
    assert len(read(obj)[0].loops) == 3


@pytest.mark.parametrize("modified", [False, True])
def test_a_curve_is_read_while_it_is_edited(modified):
    curve = poly_curve(SQUARE)
    if modified:
        modifier = curve.modifiers.new("Cast", "CAST")
        modifier.use_apply_on_spline, modifier.factor = True, 0.0
    bpy.ops.object.mode_set(mode="EDIT")
    curve.data.splines[0].points[2].co.x = 3.0
    (outline,) = read(curve)
    assert outline.size == pytest.approx(3.0)


def test_a_mirrored_instance_is_read_from_the_side_that_it_shows():
    curve = poly_curve(star())
    empty = sources.instance_of(sources.collection_of(curve))
    for matrix, z in ((Matrix.Diagonal((-1, 1, 1, 1)), 1), (Matrix.Diagonal((1, 1, -1, 1)), -1)):
        curve.matrix_basis = matrix
        (outline,) = read(empty)
        normal = np.cross(*outline.plane.axes)
        assert normal == pytest.approx((0, 0, z))


def test_a_collections_instances_are_read_in_the_instances_space():
    first, second = poly_curve(star(), name="First"), text("O", name="Second")
    second.matrix_basis = Matrix.Translation((0, 4, 1)) @ Euler((math.pi / 2, 0, 0)).to_matrix().to_4x4()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    empty = sources.instance_of(sources.collection_of(first, second, camera))
    empty.matrix_basis = Matrix.Translation((9, 9, 9)) @ Matrix.Diagonal((2, 2, -2, 1))
    assert is_readable(empty)
    outlines = read(empty)
    assert [len(outline.loops) for outline in outlines] == [1, 2]
    assert outlines[0].size == pytest.approx(2 * np.ptp(star(), axis=0).max(), rel=1e-6)
    assert np.abs(lifted(outlines[0])[:, 2]).max() < 1e-6
    assert np.abs(lifted(outlines[1])[:, 1] - 4).max() < 1e-5  # it stands upright in the collection
    assert np.cross(*outlines[1].plane.axes) == pytest.approx((0, -1, 0), abs=1e-6)


def test_what_is_wrong_in_an_instance_names_the_object():
    empty = sources.instance_of(sources.collection_of(poly_curve(SQUARE, cyclic=False, name="Path")))
    with pytest.raises(OutlineError, match="In 'Path': Spline 1 is open"):
        read(empty)


def test_the_meshes_that_geometry_nodes_place():
    obj = mesh_object([], [], [])

    def letters(tree, _geometry):
        string, fill = tree.nodes.new("GeometryNodeStringToCurves"), tree.nodes.new("GeometryNodeFillCurve")
        string.inputs["String"].default_value = "TO"
        tree.links.new(string.outputs[0], fill.inputs[0])
        return fill.outputs[0]

    obj.modifiers.new("Nodes", "NODES").node_group = sources.node_group(letters)
    outlines = read(obj)
    assert [len(outline.loops) for outline in outlines] == [1, 2]
    assert lifted(outlines[1])[:, 0].min() > lifted(outlines[0])[:, 0].mean()


@pytest.mark.parametrize("kind", ["mesh", "curve", "curves"])
def test_the_curves_that_geometry_nodes_place(kind):
    make = {
        "mesh": lambda: mesh_object([], [], []),
        "curve": lambda: poly_curve(SQUARE),
        "curves": lambda: sources.hair_curves(STAR),
    }
    obj = make[kind]()

    def letters(tree, _geometry):
        string = tree.nodes.new("GeometryNodeStringToCurves")
        string.inputs["String"].default_value = "TO"
        return string.outputs[0]

    obj.modifiers.new("Nodes", "NODES").node_group = sources.node_group(letters)
    obj.matrix_basis = Matrix.Translation((3, 4, 5)) @ Matrix.Diagonal((2, 2, 2, 1))
    if bpy.app.version < (4, 5):
        with pytest.raises(OutlineError, match="Add a Fill Curve node"):
            read(obj)
        return
    outlines = read(obj)
    assert [len(outline.loops) for outline in outlines] == [1, 2]
    assert lifted(outlines[1])[:, 0].min() > lifted(outlines[0])[:, 0].mean()
    assert 1.0 < outlines[0].size < 2.0  # a letter is two thirds of a unit high


def test_the_objects_that_geometry_nodes_place():
    part = poly_curve(SQUARE, name="Part")
    ink = bpy.data.materials.new("Ink")
    part.data.materials.append(ink)
    obj = mesh_object([], [], [])

    def corners(tree, _geometry):
        info, grid = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeMeshGrid")
        for name, value in (("Size X", 6.0), ("Size Y", 6.0), ("Vertices X", 2), ("Vertices Y", 2)):
            grid.inputs[name].default_value = value
        info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = part, True
        place = tree.nodes.new("GeometryNodeInstanceOnPoints")
        tree.links.new(grid.outputs[0], place.inputs["Points"])
        tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
        return place.outputs[0]

    obj.modifiers.new("Nodes", "NODES").node_group = sources.node_group(corners)
    outlines = read(obj)
    assert sorted(tuple(lifted(outline).min(axis=0)[:2].round(6)) for outline in outlines) == [
        (-3, -3),
        (-3, 3),
        (3, -3),
        (3, 3),
    ]
    assert {outline.slots for outline in outlines} == {(ink,)}


SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">
<rect x="5" y="5" width="30" height="40" fill="#c33"/>
<path d="M50 5 h40 v40 h-40 z M60 15 v20 h20 v-20 z" fill="#36c"/></svg>"""


def test_an_imported_svg_is_an_object_for_each_path(tmp_path):
    path = tmp_path / "drawing.svg"
    path.write_text(SVG)
    if not hasattr(bpy.types, "IMPORT_CURVE_OT_svg"):
        bpy.ops.preferences.addon_enable(module="io_curve_svg")
    bpy.ops.import_curve.svg(filepath=str(path))
    curves = sorted((obj for obj in bpy.data.objects if obj.type == "CURVE"), key=lambda obj: obj.name)
    outlines = [outline for obj in curves for outline in read(obj)]
    assert [len(outline.loops) for outline in outlines] == [1, 2]
    sizes = sorted(abs(area(loop)) for outline in outlines for loop in outline.loops)
    assert sizes == pytest.approx([0.02 * 0.02, 0.03 * 0.04, 0.04 * 0.04], rel=1e-3)
    made = writing.write_joined([(obj, sources.meshed(read(obj))) for obj in curves])
    assert [slot.material for slot in made.material_slots] == [obj.data.materials[0] for obj in curves]
    assert {polygon.material_index for polygon in made.data.polygons} == {0, 1}


@pytest.mark.parametrize("make", [lambda: text(""), lambda: mesh_object([], [], []), lambda: poly_curve()])
def test_nothing_is_said_to_be_nothing(make):
    with pytest.raises(OutlineError, match="no outline") as refusal:
        read(make())
    assert refusal.value.reason == "too-few-points"


@pytest.mark.parametrize("size", [1e-6, 1e-3, 1e5])
def test_tiny_and_huge_objects(size):
    curve = poly_curve(STAR * size, dimensions="3D")
    (outline,) = read(curve)
    assert outline.size == pytest.approx(size * np.ptp(STAR[:, :2], axis=0).max(), rel=1e-6)


def bundled_font(name):
    (path,) = Path(bpy.utils.resource_path("LOCAL"), "datafiles", "fonts").glob(f"{name}.*")
    return bpy.data.fonts.load(str(path))


@pytest.mark.parametrize(("body", "font"), [("Query €", None), ("AQ& 4", "Inter"), ("fluffy", "DejaVuSansMono")])
def test_letters_whose_contours_cross_are_united_as_fonts_mean_them(body, font):
    obj = text(body)
    obj.data.font = bundled_font(font) if font else obj.data.font
    obj.data.space_character = 0.8  # so that letters overlap, too
    (outline,) = read(obj)
    mesh = tessera.mesh(outline.loops, 0.03)
    assert mesh.report.q_worst > 0.3 and set(outline.splines) <= set(range(1, 40))
    drawn = [polyline.points for polyline in read_curve(obj, bpy.context.evaluated_depsgraph_get())]
    places = mesh.vertices[mesh.triangles].mean(axis=1)
    turns = sum(winding(places, loop[:, :2]) for loop in drawn)
    assert (turns != 0).mean() > 0.99  # all but those beside a curve that the mesh cuts short


def winding(places, loop):
    """How often a loop runs around places (n, 2)."""
    a, b = loop - places[:, None], np.roll(loop, -1, axis=0) - places[:, None]
    turn = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=-1))
    return np.rint(turn.sum(axis=1) / (2 * np.pi))


@pytest.mark.parametrize("body", ["e", "\ne", "\n\n e"])
def test_a_letter_has_the_same_mesh_wherever_it_stands(body):
    (outline,) = read(text(body))
    mesh = tessera.mesh(outline.loops, 0.026)
    assert mesh.report.n_triangles == 384 and mesh.report.q_worst > 0.9


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (0.6, 0, -0.8)])
def test_a_flat_mesh_is_meshed_from_the_side_that_its_faces_face(normal):
    obj = mesh_object(flat(np.array(SQUARE)), [], [(0, 1, 2, 3)])
    turn = Vector((0, 0, 1)).rotation_difference(Vector(normal)).to_matrix().to_4x4()
    obj.data.transform(turn)
    select(obj)
    bpy.ops.tessera.mesh_curve(edge_length=0.3)
    made = bpy.context.object.data
    assert all((polygon.normal - Vector(normal)).length < 1e-5 for polygon in made.polygons)


def test_faces_of_each_material_are_a_region_and_share_vertices():
    points = [(x, y, 0) for y in range(4) for x in range(4)]
    faces = [(4 * y + x, 4 * y + x + 1, 4 * y + x + 5, 4 * y + x + 4) for y in range(3) for x in range(3)]
    obj = mesh_object(points, [], faces)
    for name in "abc":
        obj.data.materials.append(bpy.data.materials.new(name))
    slots = [0, 1, 0, 1, 2, 1, 0, 1, 0]  # a board, with a hole in the middle that another fills
    obj.data.polygons.foreach_set("material_index", slots)
    for wanted in ({"edge_length": 0.3}, {"size_by": "TRIANGLE_COUNT", "triangle_count": 300}):
        select(obj)
        bpy.ops.tessera.mesh_curve(**wanted)
        made = bpy.context.object.data
        area = np.zeros(3)
        for polygon in made.polygons:
            area[polygon.material_index] += polygon.area
            at = polygon.center
            assert slots[3 * int(at.y) + int(at.x)] == polygon.material_index
        assert area == pytest.approx([4, 4, 1], rel=1e-5)
        edges = [key for polygon in made.polygons for key in polygon.edge_keys]
        border = [key for key in set(edges) if edges.count(key) == 1]
        length = sum((made.vertices[a].co - made.vertices[b].co).length for a, b in border)
        assert length == pytest.approx(12, rel=1e-5)


def test_what_is_switched_off_is_read_only_where_nothing_else_has_a_say_in_it():
    collection = bpy.data.collections.new("Off")
    bpy.context.scene.collection.children.link(collection)
    obj = poly_curve(SQUARE)
    collection.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    bpy.context.view_layer.layer_collection.children["Off"].exclude = True
    obj.location.x = 7  # its world matrix is of before
    (outline,) = read(obj)
    assert np.ptp(outline.loops[0], axis=0).tolist() == [1, 1]
    obj.scale.x = 3
    (outline,) = read(obj)
    assert np.ptp(outline.loops[0], axis=0).tolist() == [3, 1]
    obj.modifiers.new("Array", "ARRAY")
    with pytest.raises(OutlineError, match="switched off in this view layer") as error:
        read(obj)
    assert error.value.reason == "not-evaluated"
    obj.modifiers[0].show_viewport = False
    assert read(obj)
    obj.parent = bpy.data.objects.new("Parent", None)
    with pytest.raises(OutlineError, match="by the eye"):
        read(obj)


def test_what_is_no_number_is_said_with_its_spline():
    obj = poly_curve(SQUARE, SQUARE, [(3, 0), (4, float("nan")), (4, 1)])
    with pytest.raises(OutlineError, match="Spline 3 has a point whose coordinate"):
        read(obj)


def test_modifiers_on_an_extrusion_are_said():
    obj = poly_curve(SQUARE)
    obj.data.extrude = 0.1
    obj.modifiers.new("Weld", "WELD")
    with pytest.raises(OutlineError, match="extrusion or bevel") as error:
        read(obj)
    assert error.value.reason == "not-planar"


def test_underlines_are_united_with_letters_that_reach_them():
    obj = text("Qgyj")
    for character in obj.data.body_format:
        character.use_underline = True
    (outline,) = read(obj)
    mesh = tessera.mesh(outline.loops, 0.05)
    places = mesh.vertices[mesh.triangles].mean(axis=1)
    assert not any("touch" in warning for warning in mesh.report.warnings)
    drawn = read_curve(obj, bpy.context.evaluated_depsgraph_get())
    underline = [polyline.points[:, :2] for polyline in drawn if len(polyline.points) == 4]
    within = np.concatenate([line.mean(axis=0)[None] for line in underline])
    assert len(within) == 4
    nearest = np.linalg.norm(places - within[:, None], axis=2).min(axis=1)
    assert nearest.max() < 0.05  # the middle of each is covered
