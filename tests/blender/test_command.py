"""The command line's own decisions, on the bpy wheel; test_installed.py runs it in a real Blender."""

import bpy
import pytest

from addon.blender import command
from tests.blender.drawing import SQUARE, poly_curve, text


def test_an_object_named_twice_is_meshed_once(tmp_path):
    poly_curve(SQUARE, name="A")
    out = tmp_path / "out.blend"
    assert command.run(["mesh", "--edge-length", "0.3", "--objects", "A", "A", "--output", str(out)]) == 0
    assert out.exists() and [obj.name for obj in bpy.data.objects if obj.type == "MESH"] == ["A Mesh"]


def test_letters_with_holes_are_meshed(tmp_path, capsys):
    text("ABO", name="A")
    out = tmp_path / "out.blend"
    assert command.run(["mesh", "--edge-length", "0.05", "--output", str(out)]) == 0
    assert "triangles, q_worst 0." in capsys.readouterr().out and out.exists()
    mesh = bpy.data.objects["A Mesh"].data
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 3 - 4


@pytest.mark.parametrize("output", ["", "missing/out.blend", "~nobody/out.blend"])
def test_an_output_that_cannot_be_is_said_before_anything_is_meshed(tmp_path, capsys, output):
    poly_curve(SQUARE, name="A")
    path = str(tmp_path / output) if output else str(tmp_path)
    assert command.run(["mesh", "--edge-length", "0.3", "--output", path]) == 2
    assert "cannot be written" in capsys.readouterr().err and len(bpy.data.objects) == 1


def test_an_output_that_fails_is_one_line_and_not_success(tmp_path, capsys):
    poly_curve(SQUARE, name="A")
    assert command.run(["mesh", "--edge-length", "0.3", "--output", str(tmp_path / ("long" * 100))]) == 1
    assert "was not written: " in capsys.readouterr().err
