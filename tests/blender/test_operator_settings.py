"""The one table of settings, as Blender's properties and as the command's options."""

import argparse
import math
from dataclasses import fields, replace

import bpy
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon import tessera
from addon.blender import command
from addon.blender.options import add_options, settings_from
from addon.blender.properties import annotations, read_settings, write_settings
from addon.blender.settings import Settings, table
from tests.blender.drawing import poly_curve, star, vertices

OTHER = Settings(
    **{
        each.name: {bool: True, int: 7, float: 1.5, str: "Some"}[type(each.default)]
        if not table()[each.name].choices
        else table()[each.name].choices[-1][0]
        for each in fields(Settings)
    }
)


@pytest.fixture(params=[False, True])
def group(request):
    """A property group of all settings, at the scene."""
    cls = type("Group", (bpy.types.PropertyGroup,), {"__annotations__": annotations(pointers=request.param)})
    bpy.utils.register_class(cls)
    bpy.types.Scene.group = bpy.props.PointerProperty(type=cls)
    yield bpy.context.scene.group
    del bpy.types.Scene.group
    bpy.utils.unregister_class(cls)


def test_settings_come_back_from_properties(group):
    bpy.data.objects.new("Some", None)
    assert read_settings(group) == Settings()
    write_settings(OTHER, group)
    assert read_settings(group) == OTHER
    assert group.corner_angle == pytest.approx(math.radians(1.5))


@pytest.mark.parametrize("operator", ["mesh_curve", "remesh_faces"])
def test_an_operators_preset_has_every_setting(operator):
    known = getattr(bpy.ops.tessera, operator).get_rna_type().properties
    settings = [known[name] for name in table() if name in known]
    assert len(settings) > 20 and not [each.identifier for each in settings if each.is_skip_preset]


def parse(*words):
    parser = argparse.ArgumentParser()
    add_options(parser)
    return settings_from(parser.parse_args(words))


def test_settings_come_back_from_options():
    assert parse() == Settings()
    words = []
    for each in fields(Settings):
        value, option = getattr(OTHER, each.name), f"--{each.name.replace('_', '-')}"
        choice = table()[each.name].choices
        words += [option] if value is True else [option, value.lower().replace("_", "-") if choice else str(value)]
    assert parse(*words) == OTHER
    assert parse("--edge-length", "automatic", "--no-flips") == replace(Settings(), edge_length=0.0)


@settings(max_examples=50, deadline=None)
@given(st.one_of(st.floats(1e-6, 1e6), st.integers(1, 10**6).map(lambda n: n / 1000)), st.floats(1, 179))
def test_the_same_number_is_the_same_in_panel_script_and_command(length, angle):
    owner = bpy.context.window_manager.operator_properties_last("tessera.mesh_curve")
    owner.edge_length, owner.corner_angle = length, math.radians(angle)
    found = read_settings(owner)
    asked = parse("--edge-length", repr(length), "--corner-angle", repr(angle))
    assert found == asked and read_settings(owner) == found
    assert asked.edge_length == pytest.approx(length, rel=1e-7) and asked.corner_angle == pytest.approx(angle, rel=1e-6)
    if round(length, 3) == length < 1e4:
        assert asked.edge_length == length  # what is typed is what is used


def test_the_same_settings_make_the_same_mesh_by_panel_script_command_and_library(tmp_path):
    curve = poly_curve(star())
    bpy.ops.tessera.mesh_curve(edge_length=0.07, corner_angle=math.radians(40), keep_linked=True)
    by_script = bpy.context.object
    found = [vertices(by_script)]
    by_script.tessera.settings.edge_length = 0.1
    by_script.tessera.settings.edge_length = 0.07
    bpy.ops.tessera.mesh_again()
    found.append(vertices(by_script))
    bpy.data.objects.remove(by_script)
    words = ["--edge-length", "0.07", "--corner-angle", "40", "--objects", curve.name]
    assert command.run(["mesh", *words, "--output", str(tmp_path / "out.blend")]) == 0
    found.append(vertices(bpy.data.objects[f"{curve.name} Mesh"]))
    loop = np.array([point.co[:2] for point in curve.data.splines[0].points], dtype=np.float64)
    found.append(np.pad(tessera.mesh([loop], 0.07, corner_angle=40).vertices, [(0, 0), (0, 1)]).astype(np.float32))
    for other in found[1:]:
        assert np.array_equal(found[0], other)


@pytest.mark.parametrize(
    "words", [("--edge-length", "-1"), ("--gradation", "1"), ("--passes", "x"), ("--size-by", "a")]
)
def test_options_out_of_bounds_are_refused(words, capsys):
    with pytest.raises(SystemExit) as usage:
        parse(*words)
    assert usage.value.code == 2 and words[0] in capsys.readouterr().err


def test_every_setting_says_what_it_does():
    for name, shown in table().items():
        assert len(shown.description) > 20 and not shown.description.endswith("."), name
        assert shown.unit != "length" or "world units" in shown.description, name
