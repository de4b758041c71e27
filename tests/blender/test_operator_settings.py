"""The one table of settings, as Blender's properties and as the command's options."""

import argparse
import math
from dataclasses import fields, replace

import bpy
import pytest

from addon.blender.options import add_options, settings_from
from addon.blender.properties import annotations, read_settings, write_settings
from addon.blender.settings import Settings, table

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
    assert rounded(read_settings(group)) == rounded(Settings())
    write_settings(OTHER, group)
    assert rounded(read_settings(group)) == rounded(OTHER)
    assert group.corner_angle == pytest.approx(math.radians(1.5))


def rounded(settings):
    """Blender's single precision is left out."""
    return {
        each.name: pytest.approx(value, rel=1e-6) if isinstance(value := getattr(settings, each.name), float) else value
        for each in fields(settings)
    }


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
