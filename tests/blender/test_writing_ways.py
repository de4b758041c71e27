"""Beside the source, in its place, once more into the same mesh: what stays, and that undo is whole."""

import bpy
import numpy as np
import pytest

from addon.blender import results
from addon.blender.writing import write_again, write_in_place, write_mesh
from tests.blender import sources
from tests.blender.drawing import SQUARE, circle, counts, poly_curve, select, star, triangles, vertices
from tests.blender.sources import mesh_object, meshed, read
from tests.blender.test_writing import border, values, write


def decorated():
    """A curve with everything that an object can have."""
    curve = circle(name="Logo")
    curve.data.materials.append(bpy.data.materials.new("Ink"))
    curve["price"], curve["note"], curve["sizes"] = 7, "made by hand", [1.0, 2.0]
    curve.id_properties_ui("price").update(min=1, max=9, description="In crowns")
    curve.data["revision"] = 3
    curve.color, curve.show_name, curve.hide_render, curve.pass_index = (1, 0.5, 0, 1), True, True, 4
    curve.lock_location[1] = True
    target = bpy.data.objects.new("Target", None)
    bpy.context.scene.collection.objects.link(target)
    curve.constraints.new("LIMIT_LOCATION").max_x = 5
    return curve


def check_decoration(made):
    assert (made["price"], made["note"], list(made["sizes"]), made.data["revision"]) == (7, "made by hand", [1, 2], 3)
    ui = made.id_properties_ui("price").as_dict()
    assert (ui["min"], ui["max"], ui["description"]) == (1, 9, "In crowns")
    assert tuple(made.color) == (1, 0.5, 0, 1) and made.show_name and made.hide_render and made.pass_index == 4
    assert tuple(made.lock_location) == (False, True, False)
    assert [constraint.max_x for constraint in made.constraints] == [5]
    assert [slot.material.name for slot in made.material_slots] == ["Ink"]


def test_a_mesh_beside_its_source_has_what_that_has():
    curve = decorated()
    made = write(curve)
    check_decoration(made)
    check_decoration(curve)
    assert (made.name, curve.name, curve.type) == ("Logo Mesh", "Logo", "CURVE")
    assert made.animation_data is None


def test_in_place_nothing_is_lost():
    curve = decorated()
    first = bpy.data.collections.new("First")
    bpy.context.scene.collection.children.link(first)
    first.objects.link(curve)
    child, follower = (bpy.data.objects.new(name, None) for name in ("Child", "Follower"))
    for obj in (child, follower):
        first.objects.link(obj)
    child.parent = curve
    follower.constraints.new("COPY_LOCATION").target = curve
    curve.keyframe_insert("location", frame=1)
    curve.driver_add("pass_index").driver.expression = "4"
    track = curve.animation_data.nla_tracks.new()
    track.name = "Take"
    strip = track.strips.new("Strip", 10, bpy.data.actions.new("Other"))
    strip.name, strip.blend_type = "Strip", "ADD"
    curve.location, curve.rotation_euler, curve.scale = (1, 2, 3), (0.1, 0.2, 0.3), (-1, 2, 1)
    bpy.context.view_layer.update()
    matrix, action, modes = curve.matrix_world.copy(), curve.animation_data.action, curve.rotation_mode
    data_name, pieces = curve.data.name, meshed(read(curve))

    made = write_in_place(curve, pieces)
    bpy.context.view_layer.update()

    check_decoration(made)
    assert (made.name, made.data.name, made.type) == ("Logo", data_name, "MESH")
    assert bpy.data.objects["Logo"] == made and not [obj for obj in bpy.data.objects if obj.type == "CURVE"]
    assert child.parent == made and follower.constraints[0].target == made
    assert {collection.name for collection in made.users_collection} == {"First", bpy.context.scene.collection.name}
    assert made.matrix_world == matrix and made.rotation_mode == modes
    animation = made.animation_data
    assert animation.action == action and [driver.data_path for driver in animation.drivers] == ["pass_index"]
    assert [(t.name, [(s.name, s.frame_start, s.blend_type) for s in t.strips]) for t in animation.nla_tracks] == [
        ("Take", [("Strip", 10, "ADD")])
    ]
    assert made.name in bpy.context.view_layer.objects


def test_in_place_of_one_of_two_that_share_their_curve_leaves_the_other():
    curve = circle()
    other = curve.copy()
    bpy.context.scene.collection.objects.link(other)
    write_in_place(curve, meshed(read(curve)))
    assert other.type == "CURVE" and other.data.users == 1 and len(read(other)) == 1


def test_in_place_of_a_mesh_it_stays_the_same_object():
    obj = mesh_object([(*point, 0) for point in SQUARE], [], [(0, 1, 2, 3)])
    obj.modifiers.new("Array", "ARRAY").relative_offset_displace = (2, 0, 0)
    name = obj.data.name
    made = write_in_place(obj, meshed(read(obj), 0.3))
    assert made == obj and obj.data.name == name and len(bpy.data.meshes) == 1
    assert not obj.modifiers and np.ptp(vertices(obj)[:, 0]) == pytest.approx(3)


def test_in_place_of_an_instance_nothing_is_shown_twice():
    empty = sources.instance_of(sources.collection_of(poly_curve(star())))
    made = write_in_place(empty, meshed(read(empty)))
    assert made.name == "Instance" and made.type == "MESH" and made.instance_type == "NONE"


def test_again_into_the_same_mesh_its_own_things_stay():
    curve = circle()
    made = write(curve)
    ink = bpy.data.materials.new("Own")
    made.data.materials.append(ink)
    made.modifiers.new("Solidify", "SOLIDIFY")
    made["mine"], made.location, made.data.name = 1, (3, 3, 3), "Kept"
    made.vertex_groups.new(name="Pinned")
    made.shape_key_add()
    made.shape_key_add()
    before = len(made.data.polygons)
    curve.data.splines[0].bezier_points[0].co.x = -2
    write_again(made, meshed(read(curve), 0.1))
    assert len(made.data.polygons) > 2 * before and made.data.name == "Kept"
    assert (made["mine"], tuple(made.location), made.modifiers[0].type) == (1, (3, 3, 3), "SOLIDIFY")
    assert [slot.material for slot in made.material_slots] == [ink]
    assert [group.name for group in made.vertex_groups] == ["Boundary", "Pinned"]
    assert made.data.shape_keys is None  # they were of the vertices that are gone
    assert [layer.name for layer in made.data.uv_layers] == ["UVMap"]
    assert len(values(made, "element_quality")) == len(made.data.polygons)
    assert not made.data.validate(verbose=True)
    members = sum(bool(vertex.groups) for vertex in made.data.vertices)
    assert members == len(np.unique(border(triangles(made))))


@pytest.mark.parametrize("way", [write_mesh, write_in_place])
def test_undo_is_whole(way):
    bpy.ops.ed.undo_push(message="empty")
    curve = decorated()
    child = bpy.data.objects.new("Child", None)
    bpy.context.scene.collection.objects.link(child)
    child.parent = curve
    bpy.ops.ed.undo_push(message="drawn")
    before = counts()
    way(curve, meshed(read(curve)))
    bpy.ops.ed.undo_push(message="meshed")
    bpy.ops.ed.undo()
    assert counts() == before
    logo = bpy.data.objects["Logo"]
    assert logo.type == "CURVE" and bpy.data.objects["Child"].parent == logo
    check_decoration(logo)
    bpy.ops.ed.redo()
    assert [obj.type for obj in bpy.data.objects if obj.name.startswith("Logo")].count("MESH") == 1


def test_of_joined_objects_one_may_be_flat():
    """Its own space has no room for what lies in another plane."""
    one, other = poly_curve(SQUARE, name="Flat"), poly_curve(SQUARE, name="Upright")
    one.scale.z = 0
    other.location, other.rotation_euler.x = (3, 0, 1), np.pi / 2
    for chosen in ([one, other], [other, one], [one]):
        select(*chosen)
        bpy.ops.tessera.mesh_curve(edge_length=0.3, result="JOIN")
        made = bpy.context.object
        points = vertices(made) @ np.array(made.matrix_world)[:3, :3].T + np.array(made.matrix_world)[:3, 3]
        low, high = ([0, 0, 0], [1, 1, 0]) if len(chosen) == 1 else ([0, 0, 0], [4, 1, 2])
        np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], [low, high], atol=1e-6)
        bpy.data.objects.remove(made)


def test_a_name_leaves_room_for_the_word_mesh():
    limit = 255 if bpy.app.version >= (5, 0) else 63
    obj = poly_curve(SQUARE, name="ä" * limit)
    select(obj)
    bpy.ops.tessera.mesh_curve(edge_length=0.3)
    assert bpy.context.object.name.endswith("ä Mesh")


def test_limits_of_custom_arrays_are_kept():
    obj = poly_curve(SQUARE)
    obj["colour"], obj["words"], obj["steps"] = [0.1, 0.2, 0.3], ["a", "b"], [1, 2]
    obj.id_properties_ui("colour").update(subtype="COLOR", min=0.0, max=1.0)
    select(obj)
    bpy.ops.tessera.mesh_curve(edge_length=0.3)
    made = bpy.context.object
    assert made.id_properties_ui("colour").as_dict()["subtype"] == "COLOR"
    assert list(made["words"]) == ["a", "b"] and list(made["steps"]) == [1, 2]


@pytest.mark.parametrize("exclude", [False, True])
def test_results_go_to_the_collection_of_the_preferences_even_where_that_is_not_shown(monkeypatch, exclude):
    monkeypatch.setattr(results, "collection_name", lambda: "Out")
    collection = bpy.data.collections.new("Out")
    bpy.context.scene.collection.children.link(collection)
    bpy.context.view_layer.layer_collection.children["Out"].exclude = exclude
    select(poly_curve(SQUARE, name="A"))
    assert bpy.ops.tessera.mesh_curve(edge_length=0.3) == {"FINISHED"}
    assert [obj.name for obj in collection.objects] == ["A Mesh"]
    assert bpy.data.objects["A Mesh"].users_collection == (collection,)
