"""Every kind of object through the operator, in every way that results can go; failures leave all as it was."""

import bpy
import numpy as np
import pytest

from tests.blender import sources
from tests.blender.drawing import circle, counts, poly_curve, select, star, text, triangles

FLAT = np.column_stack([star(), np.zeros(14)])
KINDS = {
    "curve": circle,
    "text": lambda: text("O"),
    "curves": lambda: sources.hair_curves(FLAT),
    "strokes": lambda: sources.grease_pencil(FLAT),
    "mesh": lambda: sources.mesh_object(FLAT, [], [range(14)]),
    "instance": lambda: sources.instance_of(sources.collection_of(poly_curve(star()))),
}


@pytest.mark.parametrize("kind", KINDS)
def test_beside_and_then_in_place(kind):
    source = KINDS[kind]()
    select(source)
    name, before = source.name, set(bpy.data.objects)
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1) == {"FINISHED"}
    (beside,) = set(bpy.data.objects) - before
    assert beside.name == f"{name} Mesh" and bpy.context.selected_objects == [beside]
    select(source)
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1, result="REPLACE") == {"FINISHED"}
    made = bpy.data.objects[name]
    assert made.type == "MESH" and len(bpy.data.objects) == len(before) + 1
    assert np.array_equal(triangles(made), triangles(beside)) and len(triangles(made)) > 30


def test_one_joined_object_of_every_kind():
    objects = [draw() for draw in KINDS.values()]
    for number, obj in enumerate(objects):
        obj.location.x = 4 * number
    select(*objects)
    before = set(bpy.data.objects)
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1, result="JOIN") == {"FINISHED"}
    (made,) = set(bpy.data.objects) - before
    centres = np.array([polygon.center for polygon in made.data.polygons])[:, 0] + made.location.x
    assert set(np.rint(centres / 4).astype(int)) == set(range(len(objects)))


@pytest.mark.parametrize("result", ["NEW", "REPLACE", "JOIN"])
@pytest.mark.parametrize("kind", ["curves", "strokes", "instance"])
def test_a_failure_of_any_kind_leaves_all_as_it_was(kind, result):
    open_one = {
        "curves": lambda: sources.hair_curves(FLAT, name="Broken", cyclic=False),
        "strokes": lambda: sources.grease_pencil(FLAT, name="Broken", cyclic=False),
        "instance": lambda: sources.instance_of(sources.collection_of(poly_curve(star(), cyclic=False)), name="Broken"),
    }[kind]()
    select(open_one)
    before = counts()
    with pytest.raises(RuntimeError, match=r"'Broken'.*open"):
        bpy.ops.tessera.mesh_curve(edge_length=0.2, result=result)
    assert counts() == before
