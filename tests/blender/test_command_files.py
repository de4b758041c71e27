"""What the command reads and writes: every format, drawings, folders and globs of files."""

import json

import bpy
import numpy as np
import pytest

from addon.blender import command
from addon.blender.command import journal
from scripts.fetch_wheels import ROOT
from tests.blender.drawing import SQUARE, poly_curve, star

LOGO = ROOT / "examples" / "logo.svg"
IMPORTS = {
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "blend": lambda path: bpy.ops.wm.open_mainfile(filepath=path),
}


def run(*words):
    return command.run(["mesh", *map(str, words)])


def opened(path):
    """The mesh objects of a file, in an empty Blender."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    IMPORTS[path.suffix[1:]](str(path))
    return [obj for obj in bpy.data.objects if obj.type == "MESH"]


def save(path, *loops, **more):
    """A .blend with one curve of these loops."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    poly_curve(*loops, **more)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))


def drawing(path, shape):
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="90" height="90">{shape}</svg>')


@pytest.mark.parametrize("ending", IMPORTS)
def test_a_format_holds_the_meshes_and_only_blend_anything_else(tmp_path, ending):
    target, report = tmp_path / f"out.{ending}", tmp_path / "report.json"
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "Cube"
    poly_curve(star(), name="A")
    poly_curve(SQUARE, name="B").location.x = 3
    assert run("--output", target, "--edge-length", 0.4, "--report", report) == 0
    assert sorted(path.name for path in tmp_path.iterdir() if path.suffix != ".mtl") == [target.name, "report.json"]
    records = json.loads(report.read_text())["curves"]
    made = [obj for obj in opened(target) if obj.name != "Cube"]
    assert sum(len(obj.data.polygons) for obj in made) == sum(record["n_triangles"] for record in records) > 20
    corners = [obj.matrix_world @ vertex.co for obj in made for vertex in obj.data.vertices]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    assert np.allclose(np.sort(high - low), [0, 1 + np.cos(np.pi / 14), 4 + np.cos(np.pi / 7)], atol=1e-5)
    assert ("Cube" in bpy.data.objects) == (ending == "blend")


def test_materials_are_in_an_obj_and_found_by_it(tmp_path):
    poly_curve(SQUARE, name="A").data.materials.append(bpy.data.materials.new("Red"))
    assert run("--output", tmp_path / "out.obj", "--edge-length", 0.5) == 0
    assert "mtllib out.mtl" in (tmp_path / "out.obj").read_text() and "newmtl Red" in (tmp_path / "out.mtl").read_text()
    (made,) = opened(tmp_path / "out.obj")
    assert [material.name for material in made.data.materials] == ["Red"]


def test_an_svg_is_meshed(tmp_path):
    assert run(LOGO, "--output", tmp_path / "logo.blend") == 0
    curves = [obj for obj in bpy.data.objects if obj.type == "CURVE"]
    assert curves and len([obj for obj in bpy.data.objects if obj.type == "MESH"]) == len(curves)


def test_a_folder_gives_a_file_for_each_input_and_a_bad_one_does_not_stop_the_rest(tmp_path, capsys):
    inputs, outputs, report = tmp_path / "in", tmp_path / "out", tmp_path / "report.json"
    inputs.mkdir()
    save(inputs / "a.blend", SQUARE)
    (inputs / "b.blend").write_bytes(b"no blend")
    drawing(inputs / "c.svg", '<rect width="90" height="45"/>')
    drawing(inputs / "d.svg", "<title>nothing to see</title>")
    (inputs / "e.svg").write_text("no drawing")
    (inputs / "notes.txt").write_text("not asked for")
    assert run(inputs, "--output", outputs, "--format", "stl", "--report", report) == 1
    assert sorted(path.name for path in outputs.iterdir() if path.name != ".tessera") == ["a.stl", "c.stl"]
    failed = [record for record in json.loads(report.read_text())["curves"] if record["status"] == "failed"]
    assert [(record["input"], record["reason"]) for record in failed] == [
        (str(inputs / "b.blend"), "input"),
        (str(inputs / "d.svg"), "nothing"),
        (str(inputs / "e.svg"), "input"),
    ]
    said = capsys.readouterr().err
    assert "b.blend' cannot be read: " in said and "e.svg' cannot be read: " in said


def test_a_glob_takes_what_it_names(tmp_path):
    for name in ("a1", "a2", "b"):
        drawing(tmp_path / f"{name}.svg", '<rect width="90" height="45"/>')
    assert run(tmp_path / "a*", "--output", tmp_path / "out") == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a1.blend", "a2.blend"]


def test_two_inputs_of_one_name_and_an_input_as_output_are_refused(tmp_path, capsys):
    drawing(tmp_path / "a.svg", '<rect width="90" height="45"/>')
    save(tmp_path / "a.blend", SQUARE)
    assert run(tmp_path, "--output", tmp_path / "out") == 2
    assert "would both be written to" in capsys.readouterr().err
    assert run(tmp_path / "*.blend", "--output", tmp_path) == 2
    assert "is an input, and would be written over" in capsys.readouterr().err


def test_an_input_is_never_written_over(tmp_path, capsys):
    scene, link = tmp_path / "scene.blend", tmp_path / "link.blend"
    save(scene, SQUARE)
    link.symlink_to(scene)
    before = scene.read_bytes()
    for words in ((scene, "--output", scene), (scene, "--output", link), (link, "--output", scene)):
        assert run(*words) == 2
        assert "is an input, and would be written over: give another --output" in capsys.readouterr().err
    for target in (scene, link):
        assert run("--output", target) == 2
        assert "is the open file, and would be written over: give another --output" in capsys.readouterr().err
    drawing(tmp_path / "scene.svg", '<rect width="90" height="45"/>')
    assert run(tmp_path / "*.svg", link, "--output", tmp_path) == 2
    assert scene.read_bytes() == before


def test_a_report_takes_no_other_files_place(tmp_path, capsys):
    scene, output, link = tmp_path / "scene.blend", tmp_path / "out.blend", tmp_path / "report.json"
    save(scene, SQUARE)
    link.symlink_to(output)  # which is not there yet
    before = scene.read_bytes()
    for words in ((), (scene,)):
        for report in (scene, output, link):
            assert run(*words, "--output", output, "--report", report) == 2
            assert "give another" in capsys.readouterr().err
    for report in (tmp_path, ""):
        assert run("--output", output, "--report", report) == 2
        assert "is a folder: give --report a file" in capsys.readouterr().err
    assert scene.read_bytes() == before and not output.exists()


def test_a_report_that_fails_leaves_nothing_behind(tmp_path, capsys):
    poly_curve(SQUARE, name="A")
    assert run("--output", tmp_path / "out.blend", "--report", tmp_path / ("long" * 62 + ".json")) == 1
    assert "the report was not written: " in capsys.readouterr().err
    with pytest.raises(IsADirectoryError):
        journal.write_atomically(tmp_path, "text")
    assert [path.name for path in tmp_path.iterdir()] == ["out.blend"] and not list(tmp_path.parent.glob("*.new"))


def test_a_folder_that_is_named_as_a_file_is_refused_unless_it_is_there(tmp_path, capsys):
    drawing(tmp_path / "a.svg", '<rect width="90" height="45"/>')
    assert run(tmp_path, "--output", tmp_path / "all.blend", "--dry-run") == 2
    assert "'all.blend' would be a folder" in capsys.readouterr().err
    assert run(tmp_path, "--output", "") == 2
    assert "--output is empty" in capsys.readouterr().err
    (tmp_path / "all.blend").mkdir()
    assert run(tmp_path / "*.svg", "--output", tmp_path / "all.blend", "--dry-run") == 0


def test_the_users_own_add_ons_and_preferences_stay(tmp_path):
    before = [addon.module for addon in bpy.context.preferences.addons]
    dirty = bpy.context.preferences.is_dirty
    assert run(LOGO, "--output", tmp_path / "logo.glb", "--size-by", "triangle-count", "--triangle-count", 50) == 0
    assert [addon.module for addon in bpy.context.preferences.addons] == before
    assert bpy.context.preferences.is_dirty == dirty
