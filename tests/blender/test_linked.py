"""Meshes that are kept linked: meshed again by the button and at each change; what is the mesh's own stays."""

import bpy
import numpy as np
import pytest

from addon import tessera
from addon.blender import following
from addon.blender.properties import read_settings
from tests.blender.drawing import SQUARE, circle, move, poly_curve, right, select, vertices
from tests.blender.sources import collection_of, instance_of


def test_only_what_was_made_with_keep_linked_is_linked(square):
    curve, mesh = square
    assert mesh.tessera.source == curve and read_settings(mesh.tessera.settings).flips
    assert bpy.ops.tessera.mesh_again.poll() and bpy.ops.tessera.unlink.poll()
    select(curve)
    bpy.ops.tessera.mesh_curve(edge_length=0.2)
    assert bpy.context.object.tessera.source is None and not bpy.ops.tessera.mesh_again.poll()


def test_the_button_meshes_again_and_materials_and_modifiers_stay(square):
    curve, mesh = square
    mesh.data.materials.append(bpy.data.materials.new("Red"))
    mesh.modifiers.new("Thick", "SOLIDIFY")
    mesh["own"], mesh.location = 7, (1, 2, 3)
    data = mesh.data
    move(curve, 1, 2.0)
    assert right(mesh) == 1.0  # not by itself
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert right(mesh) == 2.0 and mesh.tessera.n_triangles == len(mesh.data.polygons)
    assert mesh.data == data and [each.name for each in mesh.data.materials] == ["Red"]
    assert (mesh.modifiers[0].name, mesh["own"], tuple(mesh.location)) == ("Thick", 7, (1, 2, 3))
    assert len(bpy.data.objects) == 2 and len(bpy.data.meshes) == 1


def test_the_button_uses_the_settings_at_the_mesh(square):
    _, mesh = square
    before = len(mesh.data.polygons)
    mesh.tessera.settings.edge_length = 0.1
    assert len(mesh.data.polygons) == before
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert 2.5 * before < len(mesh.data.polygons) < 6 * before


def test_a_mesh_follows_each_change_when_it_is_wanted(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    for x in (2.0, 1.5):
        move(curve, 1, x)
        assert right(mesh) == x
    mesh.tessera.settings.edge_length = 0.1  # a change of the settings, too
    bpy.context.view_layer.update()
    assert mesh.tessera.n_triangles == len(mesh.data.polygons) > 200
    mesh.tessera.automatic = False
    move(curve, 1, 3.0)
    assert right(mesh) == 1.5


def test_a_draft_follows_first_and_leaves_the_mesh_out_of_date(square):
    curve, mesh = square
    mesh.tessera.settings.edge_length = 0.05
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    move(curve, 1, 2.0)
    assert following.mesh_again(mesh, draft=True) and right(mesh) == 2.0
    drafted = mesh.tessera.q_mean
    assert following.mesh_again(mesh) and right(mesh) == 2.0
    assert mesh.tessera.q_mean > drafted > 0.9
    assert not following.mesh_again(mesh, draft=True)


def test_nothing_is_meshed_for_nothing(square, monkeypatch):
    curve, mesh = square
    mesh.tessera.automatic = True
    bpy.context.view_layer.update()
    meshed = []
    from addon.blender import results

    monkeypatch.setattr(results, "rewrite", lambda *args: meshed.append(args))
    curve.data.update_tag()
    bpy.context.view_layer.update()
    curve.location.x = 4.0  # the mesh stays where it is, and the curve's shape is the same
    bpy.context.view_layer.update()
    assert not meshed and following._wanted == set()
    move(curve, 1, 2.0)
    assert len(meshed) == 1


def test_a_curve_that_cannot_be_meshed_leaves_the_mesh_and_says_so(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    before = vertices(mesh)
    move(curve, 0, 3.0)
    assert "Curve 'Square', spline 1 crosses or touches itself" in mesh.tessera.message
    assert np.array_equal(vertices(mesh), before)
    with pytest.raises(RuntimeError, match="crosses"):
        bpy.ops.tessera.mesh_again()
    move(curve, 0, 0.0)
    assert mesh.tessera.message == ""


def test_undo_brings_the_mesh_back_with_its_curve(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    bpy.ops.ed.undo_push(message="linked")
    for x in (2.0, 3.0):
        move(curve, 1, x)
        bpy.ops.ed.undo_push(message=f"moved to {x}")
    for x in (2.0, 1.0):
        bpy.ops.ed.undo()
        assert bpy.data.objects["Square"].data.splines[0].points[1].co.x == x
        assert right(bpy.data.objects["Square Mesh"]) == x
    bpy.ops.ed.redo()
    assert right(bpy.data.objects["Square Mesh"]) == 2.0


def test_a_renamed_source_is_still_the_source_and_one_that_is_gone_is_said(square):
    curve, mesh = square
    curve.name = "Other"
    move(curve, 1, 2.0)
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"} and right(mesh) == 2.0
    bpy.context.scene.collection.objects.unlink(curve)
    with pytest.raises(RuntimeError, match="in no scene"):
        bpy.ops.tessera.mesh_again()


def test_what_a_sizing_refers_to_is_followed_too(square):
    _, mesh = square
    empty = bpy.data.objects.new("Near", None)
    bpy.context.scene.collection.objects.link(empty)
    mesh.tessera.automatic = True
    mesh.tessera.settings.object_name = empty
    mesh.tessera.settings.object_length = 0.02
    mesh.tessera.settings.use_object = True
    many = len(mesh.data.polygons)
    empty.name = "Renamed"
    empty.location = (0.5, 0.5, 0)
    bpy.context.view_layer.update()
    assert len(mesh.data.polygons) > 1.3 * many


@pytest.mark.parametrize("depth", [1, 2])
def test_a_collections_instance_is_followed_through_what_it_shows(depth):
    part = poly_curve(SQUARE, name="Part")
    empty = instance_of(collection_of(part))
    for _ in range(depth - 1):
        empty = instance_of(collection_of(empty))
    select(empty)
    assert bpy.ops.tessera.mesh_curve(edge_length=0.2, keep_linked=True) == {"FINISHED"}
    mesh = bpy.context.object
    mesh.tessera.automatic = True
    move(part, 1, 2.0)
    assert right(mesh) == 2.0
    part.location.x = 1.0
    bpy.context.view_layer.update()
    assert right(mesh) == 3.0


def test_a_mesh_that_takes_too_long_follows_no_longer(square):
    _, mesh = square
    mesh.tessera.automatic = True
    following.stop_if_slow(mesh, 0.3)
    assert mesh.tessera.automatic and not mesh.tessera.message
    following.stop_if_slow(mesh, 12.0)
    assert not mesh.tessera.automatic and "took 12 s" in mesh.tessera.message


def test_the_link_is_kept_in_the_file(square, tmp_path):
    square[1].tessera.automatic = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "linked.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "linked.blend"))
    curve, mesh = bpy.data.objects["Square"], bpy.data.objects["Square Mesh"]
    assert mesh.tessera.source == curve and mesh.tessera.settings.flips
    bpy.context.view_layer.update()
    move(curve, 1, 2.0)
    assert right(mesh) == 2.0


def test_unlinking_makes_a_plain_mesh(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    assert bpy.ops.tessera.unlink() == {"FINISHED"}
    move(curve, 1, 2.0)
    assert right(mesh) == 1.0 and mesh.tessera.source is None
    assert mesh.tessera.n_triangles == len(mesh.data.polygons)


def test_two_meshes_of_one_source_are_both_meshed():
    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.4, keep_linked=True)
    coarse = bpy.context.object
    select(bpy.data.objects["Circle"])
    bpy.ops.tessera.mesh_curve(edge_length=0.2, keep_linked=True)
    fine = bpy.context.object
    counts = len(coarse.data.polygons), len(fine.data.polygons)
    select(coarse, fine)
    bpy.data.objects["Circle"].data.splines[0].bezier_points[0].co.x *= 1.5
    bpy.context.view_layer.update()
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert len(coarse.data.polygons) > counts[0] and len(fine.data.polygons) > counts[1]
    assert len(fine.data.polygons) > 3 * len(coarse.data.polygons)


def test_each_mesh_gets_its_own_triangles_where_another_of_the_same_source_fails(square):
    curve, fine = square
    select(curve)
    bpy.ops.tessera.mesh_curve(edge_length=0.5, keep_linked=True)
    coarse = bpy.context.object
    fine.tessera.settings.use_weight, fine.tessera.settings.weight_name = True, "nobody"
    coarse.tessera.settings.edge_length = 0.3
    before = vertices(fine)
    select(fine, coarse)
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert np.array_equal(vertices(fine), before) and fine.tessera.n_triangles == len(fine.data.polygons)
    assert 14 < len(coarse.data.polygons) < len(before)


def linked_to(source, edge_length=0.3):
    """A linked mesh of a source that follows it."""
    select(source)
    bpy.ops.tessera.mesh_curve(edge_length=edge_length, keep_linked=True)
    bpy.context.object.tessera.automatic = True
    return bpy.context.object


def size_by(mesh, near):
    """Let another object size a linked mesh."""
    mesh.tessera.settings.object_name, mesh.tessera.settings.use_object = near, True


def test_a_mesh_of_a_linked_mesh_follows_with_it(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    second = linked_to(mesh)
    third = linked_to(second)
    third.name = "A"  # before the others in the alphabet
    move(curve, 1, 2.0)
    assert [right(each) for each in (mesh, second, third)] == [2.0] * 3


def test_the_smooth_flag_of_a_spline_is_followed(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    was = curve.data.splines[0].use_smooth
    assert mesh.data.polygons[0].use_smooth == was
    curve.data.splines[0].use_smooth = not was
    bpy.context.view_layer.update()
    assert mesh.data.polygons[0].use_smooth != was


def test_what_sizes_a_mesh_and_is_gone_is_said(square):
    curve, mesh = square
    near = bpy.data.objects.new("Near", None)
    bpy.context.scene.collection.objects.link(near)
    mesh.tessera.automatic = True
    size_by(mesh, near)
    assert not mesh.tessera.message
    bpy.context.scene.collection.objects.unlink(near)
    move(curve, 1, 2.0)
    assert right(mesh) == 1.0 and "'Near', which is in no scene" in mesh.tessera.message
    with pytest.raises(RuntimeError, match="Mesh 'Square Mesh': By Object is 'Near', which is in no scene"):
        bpy.ops.tessera.mesh_again()


def test_a_librarys_object_sizes_a_mesh_also_where_the_file_has_one_of_its_name(square, tmp_path):
    _, mesh = square
    plain = len(mesh.data.polygons)
    own = bpy.data.objects.new("Near", None)
    own.location = 0.5, 0.5, 0
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {own})
    own.location.x = 50
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, to):
        to.objects = ["Near"]
    (librarys,) = to.objects
    for each in (own, librarys):
        bpy.context.scene.collection.objects.link(each)
    mesh.tessera.settings.object_length = 0.02
    mesh.tessera.automatic = True
    size_by(mesh, librarys)
    assert len(mesh.data.polygons) > 1.5 * plain
    size_by(mesh, own)
    assert len(mesh.data.polygons) == plain
    assert mesh.tessera.settings.object_name == own and librarys.library


def test_a_mesh_that_sizes_itself_is_said(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    size_by(mesh, mesh)
    move(curve, 1, 2.0)
    assert right(mesh) == 1.0 and "is the mesh itself" in mesh.tessera.message
    size_by(mesh, None)
    assert right(mesh) == 2.0 and not mesh.tessera.message


def test_a_broken_onnxruntime_is_said_at_the_mesh(square, monkeypatch):
    from addon.blender import meshing

    curve, mesh = square
    mesh.tessera.automatic = True

    def broken(_tasks):
        raise tessera.RuntimeProblem("onnxruntime is not installed.")
        yield

    monkeypatch.setattr(meshing, "mesh_tasks", broken)
    move(curve, 1, 2.0)
    assert mesh.tessera.message == "onnxruntime is not installed." and right(mesh) == 1.0


def test_a_linked_duplicate_keeps_its_mesh(square):
    curve, mesh = square
    mesh.data.materials.append(bpy.data.materials.new("Red"))
    group = mesh.vertex_groups[0].name
    copy = mesh.copy()  # as Alt D does, with the link
    bpy.context.scene.collection.objects.link(copy)
    copy.tessera.settings.edge_length = 0.1
    before, shared = vertices(copy), mesh.data
    move(curve, 1, 2.0)
    select(mesh)
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert right(mesh) == 2.0 and np.array_equal(vertices(copy), before)
    assert [each.name for each in mesh.data.materials] == ["Red"] and mesh.vertex_groups[0].name == group
    select(copy)
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert copy.data == shared and len(copy.data.polygons) > 2 * len(mesh.data.polygons)


def test_a_mesh_with_a_fake_user_stays_the_same_mesh(square):
    _, mesh = square
    data = mesh.data
    data.use_fake_user = True
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert mesh.data == data and data.use_fake_user and len(bpy.data.meshes) == 1


def test_a_linked_mesh_that_is_meshed_in_place_is_linked_no_longer(square):
    curve, mesh = square
    mesh.tessera.automatic = True
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1, result="REPLACE") == {"FINISHED"}
    fine = len(mesh.data.polygons)
    assert fine > 200 and mesh.tessera.source is None and not mesh.tessera.automatic
    move(curve, 1, 2.0)
    assert len(mesh.data.polygons) == fine == mesh.tessera.n_triangles and right(mesh) == 1.0


@pytest.mark.parametrize("how", ["exclude", "object", "collection"])
def test_a_source_that_is_switched_off_is_not_read_without_its_modifiers(square, how):
    curve, mesh = square
    collection = bpy.data.collections.new("Off")
    bpy.context.scene.collection.children.link(collection)
    for old in curve.users_collection:
        old.objects.unlink(curve)
    collection.objects.link(curve)
    curve.modifiers.new("Array", "ARRAY")
    layer = bpy.context.view_layer.layer_collection.children["Off"]
    layer.exclude = how == "exclude"
    curve.hide_viewport = how == "object"
    collection.hide_viewport = how == "collection"
    select(mesh)
    with pytest.raises(RuntimeError, match="switched off in this view layer"):
        bpy.ops.tessera.mesh_again()
    curve.hide_viewport = collection.hide_viewport = False
    layer = bpy.context.view_layer.layer_collection.children["Off"]
    layer.exclude, layer.hide_viewport = False, True  # by the eye
    bpy.context.view_layer.update()
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}
    assert right(mesh) == 2.0
