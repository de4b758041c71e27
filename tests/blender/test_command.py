"""The command's own decisions, on the bpy wheel; test_installed.py runs it in a real Blender."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import bpy
import numpy as np
import onnxruntime
import pytest

from addon.blender import command
from addon.blender.command.arguments import parse
from addon.blender.settings import Settings
from scripts.fetch_wheels import ROOT
from tests.blender.drawing import SQUARE, poly_curve, select, star, text, triangles, vertices

BOW_TIE = [(0, 0), (1, 1), (1, 0), (0, 1)]


def run(output, *words, edge_length=0.5):
    """The command's exit status."""
    return command.run(["mesh", "--edge-length", str(edge_length), "--output", str(output), *map(str, words)])


def meshes():
    """The names of the mesh objects of the file."""
    return sorted(obj.name for obj in bpy.data.objects if obj.type == "MESH")


def test_an_object_named_twice_is_meshed_once(tmp_path):
    poly_curve(SQUARE, name="A")
    poly_curve(SQUARE, name="B")
    assert run(tmp_path / "out.blend", "--objects", "A", "A") == 0
    assert (tmp_path / "out.blend").exists() and meshes() == ["A Mesh"]


def test_letters_with_holes_are_meshed(tmp_path, capsys):
    text("ABO", name="A")
    assert run(tmp_path / "out.blend", edge_length=0.1) == 0
    assert "triangles, q_worst 0." in capsys.readouterr().out
    mesh = bpy.data.objects["A Mesh"].data
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 3 - 4


def test_curves_that_are_hidden_are_left_alone_and_open_ones_are_passed_over(tmp_path, capsys):
    poly_curve(SQUARE, name="A")
    poly_curve(SQUARE, name="Hidden").hide_set(True)
    poly_curve(SQUARE, name="Path", cyclic=False)
    poly_curve(SQUARE[:2], name="Line", cyclic=False)
    assert run(tmp_path / "out.blend") == 0
    said = capsys.readouterr()
    assert "Path: passed over (open): " in said.out and "1 meshed, 2 passed over" in said.err
    assert "Line: passed over (open): " in said.out
    assert meshes() == ["A Mesh"]


def test_a_line_names_the_file_and_the_curve(tmp_path, capsys):
    poly_curve(SQUARE, name="Tile")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "floor.blend"))
    assert run(tmp_path / "out.blend", str(tmp_path / "floor.blend")) == 0
    assert "\nfloor.blend: Tile: " in capsys.readouterr().out


def test_a_curve_that_fails_does_not_keep_the_others_from_being_meshed(tmp_path, capsys):
    for name, loop in (("A", SQUARE), ("Bow tie", BOW_TIE), ("C", SQUARE)):
        poly_curve(loop, name=name)
    assert run(tmp_path / "out.blend", "--report", tmp_path / "report.json") == 1
    assert "Bow tie: failed (self-intersection): " in capsys.readouterr().err
    assert meshes() == ["A Mesh", "C Mesh"] and (tmp_path / "out.blend").exists()
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["counts"] == {"meshed": 2, "failed": 1, "passed over": 0}
    first, second, third = report["curves"]
    assert (first["object"], second["object"], third["object"]) == ("A", "Bow tie", "C")
    assert second["reason"] == "self-intersection" and second["place"][:2] == pytest.approx((0.5, 0.5))
    assert "crosses" in second["error"] and second["spline"] == 1 and second["output"] is None


def test_an_error_of_tessera_itself_is_of_the_curve_that_has_it_though_many_are_meshed_together(
    tmp_path, capsys, monkeypatch
):
    from addon.blender import meshing

    meshed = meshing.mesh_tasks

    def mesh_tasks(tasks):
        if any(task.obj.name == "B" for task in tasks):
            raise KeyError("in B")
        return meshed(tasks)

    monkeypatch.setattr(meshing, "mesh_tasks", mesh_tasks)
    for name in "ABC":
        poly_curve(SQUARE, name=name)
    assert run(tmp_path / "out.blend", "--report", tmp_path / "report.json") == 1
    assert meshes() == ["A Mesh", "C Mesh"] and "KeyError: 'in B'" in capsys.readouterr().err
    records = json.loads((tmp_path / "report.json").read_text())["curves"]
    assert [record["reason"] for record in records] == [None, "internal", None]


@pytest.mark.parametrize("where", ["write", "write_file"])
def test_an_error_of_tessera_itself_in_writing_is_of_that_file_and_the_others_go_on(
    tmp_path, capsys, monkeypatch, where
):
    from addon.blender.command import batch

    inputs, report, works = tmp_path / "in", tmp_path / "report.json", getattr(batch, where)
    inputs.mkdir()
    poly_curve(SQUARE, name="A")
    for name in "ab":
        bpy.ops.wm.save_as_mainfile(filepath=str(inputs / f"{name}.blend"))

    def fails(*arguments):
        if "a.blend" in bpy.data.filepath:
            raise KeyError("in a.blend")
        return works(*arguments)

    monkeypatch.setattr(batch, where, fails)
    assert run(tmp_path / "out", inputs, "--report", report) == 1
    assert "Traceback" in (said := capsys.readouterr().err) and "a.blend: failed (internal): KeyError: " in said
    assert [path.name for path in (tmp_path / "out").glob("*.blend")] == ["b.blend"]
    records = json.loads(report.read_text())["curves"]
    assert [(record["object"], record["reason"]) for record in records] == [(None, "internal"), ("A", None)]


def test_seconds_of_curves_that_are_meshed_together_are_shared(tmp_path):
    for i in range(6):
        poly_curve(star(5 + i), name=f"A{i}")
    assert run(tmp_path / "out.blend", "--report", tmp_path / "report.json") == 0
    report = json.loads((tmp_path / "report.json").read_text())
    assert 0 < sum(record["seconds"] for record in report["curves"]) <= report["seconds"]


def test_the_report_says_what_the_mesh_is(tmp_path):
    poly_curve(star(), name="A")
    assert run(tmp_path / "out.blend", "--report", tmp_path / "report.json", edge_length=0.2) == 0
    report = json.loads((tmp_path / "report.json").read_text())
    (record,) = report["curves"]
    mesh = bpy.data.objects["A Mesh"]
    assert (record["n_vertices"], record["n_triangles"]) == (len(mesh.data.vertices), len(mesh.data.polygons))
    quality = np.zeros(record["n_triangles"], dtype=np.float32)
    mesh.data.attributes["element_quality"].data.foreach_get("value", quality)
    assert record["q_worst"] == pytest.approx(quality.min(), abs=1e-5)
    assert record["q_mean"] == pytest.approx(quality.mean(), abs=1e-5)
    assert record["edge_length"] == 0.2 and record["output"] == str(tmp_path / "out.blend")
    assert 0 < sum(record["outlines"][0]["seconds"].values()) <= record["seconds"] <= report["seconds"]
    assert report["settings"]["edge_length"] == 0.2 and report["blender"] == bpy.app.version_string


def test_every_setting_of_the_operator_is_an_option(capsys):
    assert command.run(["mesh", "--help"]) == 0
    said = capsys.readouterr().out
    assert not [each.name for each in fields(Settings) if f"--{each.name.replace('_', '-')}" not in said]
    assert "examples:" in said and "exit status: 0 all were meshed" in said


def test_the_examples_of_the_manual_and_of_the_help_are_understood(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drawings").mkdir()
    for name in ("scene.blend", "logo.svg", "drawings/a.svg"):
        (tmp_path / name).touch()
    command.run(["mesh", "--help"])
    pages = (ROOT / "docs" / "batch.md").read_text() + capsys.readouterr().out
    examples = re.findall(r"^ *blender -b.* --command tessera (mesh .*)$", pages, re.MULTILINE)
    assert len(examples) > 10
    for example in examples:
        assert parse(shlex.split(example)).jobs


def test_the_command_makes_the_mesh_that_the_operator_makes(tmp_path):
    curve = poly_curve(star(), name="A")
    select(curve)
    settings = {"edge_length": 0.25, "use_distance": True, "gradation": 1.25, "flips": True, "smooth": 1}
    assert bpy.ops.tessera.mesh_curve(**settings) == {"FINISHED"}
    theirs = bpy.context.object
    words = "--use-distance --gradation 1.25 --flips --smooth 1".split()
    assert run(tmp_path / "out.blend", *words, edge_length=0.25) == 0
    (ours,) = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj != theirs]
    assert np.array_equal(vertices(ours), vertices(theirs)) and np.array_equal(triangles(ours), triangles(theirs))


def test_all_curves_can_become_one_object(tmp_path):
    for i in range(3):
        poly_curve(SQUARE, name=f"A{i}").location.x = 2 * i
    assert run(tmp_path / "out.blend", "--result", "join") == 0
    (name,) = meshes()
    assert np.ptp(vertices(bpy.data.objects[name])[:, 0]) == pytest.approx(5)


def test_a_dry_run_says_what_it_would_do_and_does_nothing(tmp_path, capsys):
    poly_curve(SQUARE, SQUARE[:1], name="Broken")
    poly_curve(SQUARE, name="A")
    assert run(tmp_path / "out.blend", "--dry-run", "--objects", "A") == 0
    assert f"A: 1 loop, edge length 0.5 -> {tmp_path / 'out.blend'}" in capsys.readouterr().out
    assert run(tmp_path / "out.blend", "--dry-run") == 1
    assert "Broken: failed (too-few-points)" in capsys.readouterr().err
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "floor.blend"))
    assert run(tmp_path / "out.blend", tmp_path / "floor.blend", "--dry-run") == 1
    assert f"floor.blend: A: 1 loop, edge length 0.5 -> {tmp_path / 'out.blend'}" in capsys.readouterr().out
    assert [path.name for path in tmp_path.iterdir()] == ["floor.blend"] and meshes() == []


def test_a_line_stays_one_whatever_an_object_is_called(tmp_path, capsys):
    poly_curve(SQUARE, name="A\nB")
    poly_curve(BOW_TIE, name="C\x1b[31m\u2028")
    for way in ((), ("--dry-run",)):
        run(tmp_path / "out.blend", *way)
        said = capsys.readouterr()
        lines = (said.out + said.err).splitlines()
        assert [line[:4] for line in lines if "A" in line[:1]] == ["A\\nB"]
        assert [line.startswith("C\\x1b[31m\\u2028: ") for line in lines if "C" in line[:1]] == [True]
        assert "\x1b" not in said.out + said.err


@pytest.mark.parametrize(("result", "warned"), [("new", False), ("join", True), ("replace", True)])
def test_a_link_that_cannot_be_kept_is_said(tmp_path, capsys, result, warned):
    poly_curve(SQUARE, name="A")
    assert run(tmp_path / "out.blend", "--keep-linked", "--result", result) == 0
    assert (f"--keep-linked has no effect with --result {result}" in capsys.readouterr().err) == warned


def test_a_file_without_curves_is_a_failure(tmp_path, capsys):
    for way in ((), ("--dry-run",)):
        assert run(tmp_path / "out.blend", *way) == 1
        assert "there is no planar closed curve in it" in capsys.readouterr().err
    assert not (tmp_path / "out.blend").exists()


@pytest.mark.parametrize("output", ["", "missing/out.blend", "~nobody/out.blend", "out", "out.fbx"])
def test_an_output_that_cannot_be_is_said_before_anything_is_meshed(tmp_path, capsys, output):
    poly_curve(SQUARE, name="A")
    assert run(tmp_path / output) == 2
    said = capsys.readouterr().err
    assert "cannot be written" in said or "another ending than the formats" in said
    assert meshes() == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--objects", "Nobody"), "named 'Nobody'"),
        (("--format", "stl"), "another ending"),
        (("--jobs", "0"), "--jobs is a number"),
        (("--jobs", "2"), "--jobs needs the Blender program"),
        (("--gradation", "0"), "is not between 1.01"),
        (("--edge-length", "inf"), "inf is not between 0"),
        (("--min-edge-length", "1e39"), "1e39 is not between 0"),
        (("--object-reach", "1e400"), "1e400 is not between 0"),
        (("--thickness-elements", "nan"), "nan is not between 0.5"),
        (("--report", "/nowhere/report.json"), "no folder '/nowhere'"),
        (("nothing.svg",), "is no file"),
        (("long" * 100 + ".svg",), "is no file"),
        (("",), "an INPUT is empty"),
        ((__file__,), "neither a .blend nor an .svg"),
    ],
)
def test_what_cannot_be_meant_is_an_error_of_usage(tmp_path, capsys, words, said):
    poly_curve(SQUARE, name="A")
    assert run(tmp_path / "out.blend", *words) == 2
    complained = capsys.readouterr().err
    assert said in complained and complained.count("\n") < 5 and not list(tmp_path.iterdir())


def test_an_output_that_fails_is_one_line_and_not_success(tmp_path, capsys):
    poly_curve(SQUARE, name="A")
    (tmp_path / "out.blend@").mkdir()  # what Blender writes first, before it takes the old file's place
    assert run(tmp_path / "out.blend") == 1
    assert "was not written: " in capsys.readouterr().err
    assert run(tmp_path / ("long" * 100 + ".blend")) == 1
    assert "too long" in capsys.readouterr().err


def test_a_broken_onnxruntime_of_another_add_on_is_said_in_one_line(tmp_path):
    package = tmp_path / "others" / "onnxruntime"
    shutil.copytree(
        Path(onnxruntime.__file__).parent, package, ignore=shutil.ignore_patterns("*.so*", "*.pyd", "*.dll")
    )
    poly_curve(SQUARE, name="A")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    script = ROOT / "tests" / "blender" / "run_command.py"
    words = [sys.executable, script, tmp_path / "scene.blend", "mesh", "--output", tmp_path / "out.blend"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(package.parent), str(ROOT)])}
    ran = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=100)
    (said,) = [line for line in ran.stderr.splitlines() if line.startswith("tessera: ")]
    assert ran.returncode == 1 and "Traceback" not in ran.stderr
    assert f"found in '{package}', cannot load the network" in said and "disable or update" in said
    assert not (tmp_path / "out.blend").exists()
