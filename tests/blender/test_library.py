"""Objects that come from another file: they can be meshed, and what cannot be changed is left alone."""

import bpy
import pytest

from addon.blender import following, notes
from tests.blender.drawing import SQUARE, poly_curve, select


@pytest.fixture
def library(tmp_path):
    """The curve and the linked mesh of another file, in this one."""
    path = str(tmp_path / "library.blend")
    curve = poly_curve(SQUARE, name="Square")
    bpy.ops.tessera.mesh_curve(edge_length=0.2, keep_linked=True)
    bpy.context.object.tessera.automatic = True
    bpy.data.libraries.write(path, {curve, bpy.context.object})
    bpy.ops.wm.read_homefile(use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Square", "Square Mesh"]
    for obj in wanted.objects:
        bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return wanted.objects


def test_a_curve_of_another_file_is_meshed_beside_it(library):
    select(library[0])
    assert bpy.ops.tessera.mesh_curve(edge_length=0.2, keep_linked=True) == {"FINISHED"}
    made = bpy.context.object
    assert made.library is None and made.tessera.source == library[0]
    assert bpy.ops.tessera.mesh_again() == {"FINISHED"}


@pytest.mark.parametrize("number", [0, 1])
def test_what_is_of_another_file_is_not_replaced(library, number):
    select(library[number])
    with pytest.raises(RuntimeError, match="comes from a library"):
        bpy.ops.tessera.mesh_curve(edge_length=0.2, result="REPLACE")
    assert notes.last[0].obj == library[number].name and len(bpy.data.objects) == 2


def test_a_linked_mesh_of_another_file_is_left_alone(library):
    select(library[1])
    assert not bpy.ops.tessera.mesh_again.poll() and not bpy.ops.tessera.unlink.poll()
    assert library[1] not in list(following._following())


def test_the_place_of_a_failure_is_shown_where_the_curve_cannot_be_edited(library):
    assert bpy.ops.tessera.select_place(object_name="Square", spline=1, place=(1, 0, 0)) == {"FINISHED"}
    assert bpy.context.mode == "OBJECT" and bpy.context.object == library[0]
    assert tuple(bpy.context.scene.cursor.location) == (1, 0, 0)
