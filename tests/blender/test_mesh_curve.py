"""The operator on the bpy wheel: every kind of curve and transform, and every way to fail."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from addon.tessera.quality import element_quality
from tests.blender.drawing import (
    SQUARE,
    border,
    circle,
    counts,
    distance_to,
    poly_curve,
    select,
    star,
    text,
    triangles,
    vertices,
    world,
)


def run(**settings):
    """Run the operator on what is selected; returns the new objects."""
    before = set(bpy.data.objects)
    assert bpy.ops.tessera.mesh_curve(**settings) == {"FINISHED"}
    return sorted(set(bpy.data.objects) - before, key=lambda obj: obj.name)


def area(points, tris):
    """Signed by each triangle's normal along +Z; the sum over the mesh."""
    a, b, c = (points[tris[:, i]] for i in range(3))
    return 0.5 * np.cross(b - a, c - a)[:, 2].sum()


def flat(loop):
    """(k, 2) to (k, 3)."""
    return np.column_stack([loop, np.zeros(len(loop))])


def test_a_circle_becomes_even_triangles_facing_up():
    curve = circle()
    (made,) = run(edge_length=0.15)
    points, tris = vertices(made), triangles(made)
    assert made.type == "MESH"
    assert made.name == "Circle Mesh"
    assert np.abs(points[:, 2]).max() == 0.0
    assert area(points, tris) == pytest.approx(math.pi, rel=0.02)
    assert all(polygon.normal.z > 0.999 for polygon in made.data.polygons)
    assert not made.data.validate(verbose=True)
    quality = element_quality(points[:, :2], tris)
    assert quality.mean() > 0.85
    assert quality.min() > 0.2
    lengths = np.linalg.norm(points[tris] - points[np.roll(tris, -1, axis=1)], axis=2)
    assert 0.75 * 0.15 < lengths.mean() < 1.25 * 0.15
    assert bpy.data.objects["Circle"] == curve


def test_the_first_click_needs_no_setting():
    circle(radius=50.0)
    (made,) = run()
    assert 500 < len(made.data.polygons) < 3000


def pieces(made):
    """How many connected pieces a mesh has."""
    tris, labels = triangles(made), np.arange(len(made.data.vertices))
    for _ in range(len(labels)):
        low = labels[tris].min(axis=1)
        np.minimum.at(labels, tris.ravel(), np.repeat(low, 3))
        if (labels[tris] == low[:, None]).all():
            break
    return len(set(labels))


def filled_area(obj):
    """The area that Blender itself fills."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    area = sum(polygon.area for polygon in evaluated.to_mesh().polygons)
    evaluated.to_mesh_clear()
    return area


@pytest.mark.parametrize(("body", "letters", "holes"), [("MESH IT", 6, 0), ("ABO&@8", 6, 9), ("4 %", 4, 3)])
def test_letters_are_one_object_with_a_piece_for_each(body, letters, holes):
    words = text(body)
    (made,) = run(edge_length=0.06)
    tris = triangles(made)
    assert pieces(made) == letters
    edges = np.unique(np.sort(np.concatenate([tris[:, [0, 1]], tris[:, [1, 2]], tris[:, [2, 0]]]), axis=1), axis=0)
    assert len(made.data.vertices) - len(edges) + len(tris) == letters - holes
    assert area(vertices(made), tris) == pytest.approx(filled_area(words), rel=0.02)
    assert element_quality(vertices(made)[:, :2], tris).mean() > 0.9


def test_splines_inside_each_other_are_holes_and_islands_as_blender_fills_them():
    square = np.array(SQUARE) - 0.5
    curve = poly_curve(*(square * size for size in (1, 5, 3, 4, 2)), star() + 4)
    curve.data.fill_mode = "BOTH"
    bpy.context.view_layer.update()
    (made,) = run(edge_length=0.2)
    assert pieces(made) == 4
    assert area(vertices(made), triangles(made)) == pytest.approx(filled_area(curve), rel=1e-5)
    assert area(vertices(made), triangles(made)) > 25 - 16 + 9 - 4 + 1


def test_keep_has_the_curves_own_vertices_on_the_boundary():
    loop = star()
    poly_curve(loop)
    (made,) = run(edge_length=0.2, boundary="KEEP")
    points, tris = vertices(made), triangles(made)
    on_border = points[np.unique(border(tris))]
    assert sorted(map(tuple, on_border[:, :2].tolist())) == sorted(
        map(tuple, loop.astype(np.float32).astype(np.float64).tolist())
    )


def test_extrusion_and_bevel_are_left_out():
    curve = circle()
    curve.data.dimensions = "2D"
    curve.data.extrude = 0.3
    curve.data.bevel_depth = 0.1
    (made,) = run(edge_length=0.3)
    assert area(vertices(made), triangles(made)) == pytest.approx(math.pi, rel=0.05)


def test_a_nurbs_circle_is_read_at_the_resolution_blender_shows():
    bpy.ops.curve.primitive_nurbs_circle_add(radius=2.0)
    (made,) = run(edge_length=0.3)
    points = vertices(made)
    radii = np.linalg.norm(points[np.unique(border(triangles(made)))], axis=1)
    assert np.abs(radii - 2.0).max() < 0.02


TRANSFORMS = {
    "moved": Matrix.Translation((5, -3, 2)),
    "rotated": Euler((0.3, -1.1, 2.0)).to_matrix().to_4x4(),
    "negative": Matrix.Diagonal((-1, 1, 1, 1)),
    "mirrored thrice": Matrix.Diagonal((-2, -2, -2, 1)),
    "not uniform": Matrix.Translation((1, 2, 3))
    @ Euler((1, 0.5, -2)).to_matrix().to_4x4()
    @ Matrix.Diagonal((2, 0.8, 3, 1)),
    "tiny": Matrix.Diagonal((1e-4, 1e-4, 1e-4, 1)),
    "huge": Matrix.Diagonal((1e4, 1e4, 1e4, 1)),
}


@pytest.mark.parametrize("parented", [False, True])
@pytest.mark.parametrize("name", TRANSFORMS)
def test_the_mesh_lies_on_the_curve_under_any_transform(name, parented):
    loop = star()
    curve = poly_curve(loop)
    if parented:
        parent = bpy.data.objects.new("Parent", None)
        bpy.context.scene.collection.objects.link(parent)
        parent.matrix_world = Matrix.Translation((1, 1, 1)) @ Euler((0.5, 0.2, 1)).to_matrix().to_4x4()
        parent.scale = (2, 2, -2)
        bpy.context.view_layer.update()
        curve.parent = parent
        curve.matrix_parent_inverse = parent.matrix_world.inverted()
    curve.matrix_basis = TRANSFORMS[name]
    bpy.context.view_layer.update()
    outline = world(curve, flat(loop))
    size = np.ptp(outline, axis=0).max()

    (made,) = run(edge_length=float(size) / 20)
    bpy.context.view_layer.update()

    assert made.parent == curve.parent
    assert np.allclose(made.matrix_world, curve.matrix_world, rtol=1e-6, atol=0)
    points, tris = vertices(made), triangles(made)
    on_border = world(made, points[np.unique(border(tris))])
    assert distance_to(outline, on_border).max() <= 1e-5 * size
    # Every corner of the star is there, and the mesh faces the curve's own +Z.
    assert all(np.linalg.norm(on_border - corner, axis=1).min() <= 1e-5 * size for corner in outline)
    assert np.abs(points[:, 2]).max() == 0.0
    a, b, c = (points[tris[:, i]] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()
    # The target edge length is the world's, whatever the scale.
    placed = world(made, points)
    lengths = np.linalg.norm(placed[tris] - placed[np.roll(tris, -1, axis=1)], axis=2)
    assert 0.6 * size / 20 < lengths.mean() < 1.4 * size / 20


def test_a_curve_drawn_in_a_tilted_plane():
    turn = np.array(Euler((0.7, 0.4, 0.1)).to_matrix())
    loop = flat(star()) @ turn.T + (3.0, 2.0, 1.0)
    poly_curve(loop, dimensions="3D")
    (made,) = run(edge_length=0.1)
    points, tris = vertices(made), triangles(made)
    size = np.ptp(loop, axis=0).max()
    normal = turn[:, 2]
    assert np.abs((points - loop[0]) @ normal).max() <= 1e-5 * size
    assert distance_to(loop, points[np.unique(border(tris))]).max() <= 1e-5 * size
    assert all(np.dot(polygon.normal, normal) > 0.99 for polygon in made.data.polygons)


def test_modifiers_that_work_on_control_points():
    curve = circle()
    lattice = bpy.data.objects.new("Lattice", bpy.data.lattices.new("Lattice"))
    bpy.context.scene.collection.objects.link(lattice)
    lattice.scale = (4, 4, 4)
    lattice.data.interpolation_type_u = "KEY_LINEAR"
    modifier = curve.modifiers.new("Lattice", "LATTICE")
    modifier.object = lattice
    modifier.use_apply_on_spline = True
    for point in lattice.data.points:
        point.co_deform = (2 * point.co.x, point.co.y, point.co.z)
    bpy.context.view_layer.update()
    (made,) = run(edge_length=0.2)
    assert np.ptp(vertices(made)[:, 0]) == pytest.approx(4.0, rel=0.01)
    assert np.ptp(vertices(made)[:, 1]) == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("fill", ["BOTH", "NONE"])
def test_modifiers_that_work_on_the_tessellated_curve(fill):
    curve = poly_curve(SQUARE)
    curve.data.fill_mode = fill
    modifier = curve.modifiers.new("Array", "ARRAY")
    modifier.count = 3
    modifier.relative_offset_displace = (1.5, 0, 0)
    bpy.context.view_layer.update()
    (made,) = run(edge_length=0.25)
    assert area(vertices(made), triangles(made)) == pytest.approx(3.0, rel=1e-5)
    assert np.ptp(vertices(made)[:, 0]) == pytest.approx(4.0, rel=1e-5)


def test_animation_is_read_as_it_is_shown():
    curve = poly_curve(SQUARE)
    curve.shape_key_add(name="Basis")
    key = curve.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 3.0
    key.value = 1.0
    bpy.context.view_layer.update()
    (made,) = run(edge_length=0.25)
    assert area(vertices(made), triangles(made)) == pytest.approx(3.0, rel=1e-5)


def test_collections_materials_and_parent_are_kept_and_the_curve_is_untouched():
    curve = poly_curve(SQUARE, name="Logo")
    red, blue = bpy.data.materials.new("Red"), bpy.data.materials.new("Blue")
    curve.data.materials.append(red)
    curve.data.materials.append(None)
    curve.material_slots[1].link = "OBJECT"
    curve.material_slots[1].material = blue
    for name in ("First", "Second"):
        collection = bpy.data.collections.new(name)
        bpy.context.scene.collection.children.link(collection)
        collection.objects.link(curve)
    bpy.context.scene.collection.objects.unlink(curve)
    select(curve)
    before = [tuple(point.co) for point in curve.data.splines[0].points]

    (made,) = run(edge_length=0.2)

    assert [slot.material for slot in made.material_slots] == [red, blue]
    assert {collection.name for collection in made.users_collection} == {"First", "Second"}
    assert [tuple(point.co) for point in curve.data.splines[0].points] == before
    assert (curve.name, curve.data.dimensions, curve.data.users) == ("Logo", "2D", 1)
    assert (len(bpy.data.curves), len(bpy.data.meshes), len(bpy.data.objects)) == (1, 1, 2)
    assert bpy.context.selected_objects == [made]
    assert bpy.context.view_layer.objects.active == made


def test_constraints_hold_the_mesh_where_they_hold_the_curve():
    curve = poly_curve(SQUARE)
    target = bpy.data.objects.new("Target", None)
    target.location = (1, 2, 3)
    bpy.context.scene.collection.objects.link(target)
    curve.constraints.new("COPY_LOCATION").target = target
    (made,) = run(edge_length=0.2)
    bpy.context.view_layer.update()
    assert tuple(made.matrix_world.translation) == (1, 2, 3)


def test_several_objects_at_once_each_keep_their_place():
    first = poly_curve(SQUARE, name="First")
    second = poly_curve(star(), name="Second")
    second.location = (4, 0, 0)
    select(second, first)
    made = run(edge_length=0.2)
    assert [obj.name for obj in made] == ["First Mesh", "Second Mesh"]
    assert bpy.context.view_layer.objects.active == made[1]
    assert made[1].location.x == 4


def test_repeating_with_another_length_as_adjust_last_operation_does():
    circle()
    run(edge_length=0.4)
    coarse = len(bpy.data.objects["Circle Mesh"].data.polygons)
    bpy.data.objects.remove(bpy.data.objects["Circle Mesh"])
    select(bpy.data.objects["Circle"])
    run(edge_length=0.2)
    fine = len(bpy.data.objects["Circle Mesh"].data.polygons)
    assert 2.4 * coarse < fine < 6 * coarse


def refuse(cause, **settings):
    """The operator must fail with one message that names the object and the cause, and change nothing."""
    before = counts()
    with pytest.raises(RuntimeError) as failure:
        bpy.ops.tessera.mesh_curve(**settings)
    assert counts() == before
    message = str(failure.value)
    assert message.count("Error: ") == 1
    assert "'Broken'" in message
    assert cause.lower() in message.lower()
    return message


BOW_TIE = ((0, 0), (1, 1), (1, 0), (0, 1))


@pytest.mark.parametrize(
    ("cause", "loop", "settings"),
    [
        ("open", SQUARE, {"cyclic": False}),
        ("planar", ((0, 0, 0), (1, 0, 0), (1, 1, 0.3), (0, 1, 0)), {"dimensions": "3D"}),
        ("cross", BOW_TIE, {}),
        ("2 points", SQUARE[:2], {}),
        ("1 point,", SQUARE[:1], {}),
        ("line", ((0, 0, 0), (1, 0, 1), (3, 0, 3)), {"dimensions": "3D"}),
        ("area", ((0, 0), (1, 0), (3, 0)), {}),
        ("one place", ((1, 2),) * 4, {}),
        ("finite", (*SQUARE[:3], (0.0, math.nan)), {}),
    ],
)
def test_a_curve_that_cannot_be_meshed_is_one_clear_report(cause, loop, settings):
    poly_curve(loop, name="Broken", **settings)
    for edge_length in (0.2, 0.0):
        refuse(cause, edge_length=edge_length)


def test_an_edge_length_that_cannot_be_is_one_clear_report():
    poly_curve(SQUARE, name="Broken")
    refuse("edge length", edge_length=1e-7)


def test_triangles_that_single_precision_cannot_hold_are_one_clear_report():
    poly_curve(np.array(SQUARE) * 4 + 1e7, name="Broken")
    refuse("single precision", edge_length=0.1)


def test_an_empty_text_is_one_clear_report():
    text("", name="Broken")
    refuse("outline", edge_length=0.2)


def test_a_hole_that_touches_its_contour_is_one_clear_report():
    poly_curve(SQUARE, np.array(SQUARE) / 2 + (0, 0.25), name="Broken")
    refuse("touches another near (0, 0.", edge_length=0.2)


def test_the_open_spline_is_named():
    curve = poly_curve(SQUARE, star() + 5, name="Broken")
    curve.data.splines[1].use_cyclic_u = False
    assert "spline 2" in refuse("open", edge_length=0.2).lower()


def test_the_place_of_a_crossing_is_the_worlds():
    curve = poly_curve(BOW_TIE, name="Broken")
    curve.matrix_basis = Matrix.Translation((5, -3, 2)) @ Euler((0, -math.pi / 2, 0)).to_matrix().to_4x4()
    bpy.context.view_layer.update()
    assert "spline 1 crosses or touches itself near (5, -2.5, 2.5): move" in refuse("cross", edge_length=0.2)


def test_without_a_curve_there_is_one_clear_report():
    obj = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(obj)
    select(obj)
    with pytest.raises(RuntimeError, match="Nothing that can be meshed is selected"):
        bpy.ops.tessera.mesh_curve()
