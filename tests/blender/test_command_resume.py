"""A run that was killed, or in which some curves failed, is taken up again: what is done is not done again."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.blender import command, meshing
from addon.blender.command import batch, journal
from addon.blender.command.claims import PATIENCE, Claims, RunIsOver
from scripts.fetch_wheels import ROOT
from tests.blender.drawing import SQUARE, poly_curve, star, triangles, vertices

BOW_TIE = [(0, 0), (1, 1), (1, 0), (0, 1)]


def run(folder, *words):
    """The exit status, and the report's records by their objects."""
    report = folder / "report.json"
    output = "" if "--output" in words else ("--output", folder / "out.blend")
    words = ["mesh", "--edge-length", 0.3, "--report", report, *output, *words]
    status = command.run([str(word) for word in words])
    return status, {record["object"]: record for record in json.loads(report.read_text())["curves"]}


def bow_tie_and_others(count=3):
    for i in range(count):
        poly_curve(star(5 + i), name=f"A{i}")
    return poly_curve(BOW_TIE, name="Z")


def result(name):
    return vertices(bpy.data.objects[name]).tobytes(), triangles(bpy.data.objects[name]).tobytes()


def test_after_a_curve_was_mended_only_that_is_meshed_again_and_all_are_in_the_file(tmp_path):
    broken = bow_tie_and_others()
    status, records = run(tmp_path)
    assert status == 1 and records["Z"]["status"] == "failed"
    before = {name: result(f"{name} Mesh") for name in ("A0", "A1", "A2")}
    for obj in [obj for obj in bpy.data.objects if obj.type == "MESH"]:
        bpy.data.objects.remove(obj)
    for point, (x, y) in zip(broken.data.splines[0].points, SQUARE, strict=True):
        point.co = x, y, 0, 1
    status, records = run(tmp_path, "--resume")
    assert status == 0 and len(records) == 4
    assert {name: record["earlier"] for name, record in records.items()} == {"A0": 1, "A1": 1, "A2": 1, "Z": 0}
    assert {name: result(f"{name} Mesh") for name in before} == before
    assert np.ptp(vertices(bpy.data.objects["Z Mesh"]), axis=0).tolist() == [1, 1, 0]


def test_other_settings_and_other_shapes_are_meshed_anew(tmp_path):
    bow_tie_and_others()
    run(tmp_path)
    bpy.data.objects["A0"].data.splines[0].points[0].co.x += 0.1
    bpy.data.objects["A1"].scale.x = 2
    _, records = run(tmp_path, "--resume")
    assert [records[name]["earlier"] for name in ("A0", "A1", "A2")] == [False, False, True]
    _, records = run(tmp_path, "--resume", "--flips")
    assert not any(record["earlier"] for record in records.values())


def test_what_another_version_has_meshed_is_meshed_anew(tmp_path, monkeypatch):
    def earlier(*words):
        return {record["earlier"] for record in run(tmp_path, *words, "--resume")[1].values()}

    bow_tie_and_others()
    scene, done = tmp_path / "scene.blend", ("--objects", "A0", "A1", "--output", tmp_path / "done.blend")
    bpy.ops.wm.save_as_mainfile(filepath=str(scene))
    run(tmp_path, scene)
    assert earlier(scene) == {True, False}  # the broken one is tried again
    assert earlier(scene, *done) == {False} and earlier(scene, *done) == {True}
    monkeypatch.setattr(journal, "version", lambda: "another")
    assert earlier(scene) == {False} and earlier(scene, *done) == {False}
    assert earlier(scene) == {True, False} and earlier(scene, *done) == {True}


def test_the_version_is_that_of_code_and_networks():
    names = {path.name for path in (ROOT / "onnx_models").glob("*.onnx")}
    assert "nn1.onnx" in names and len(journal.version()) == 64
    assert (ROOT / "addon" / "blender" / "command" / "journal.py").samefile(journal.__file__)


def test_without_resume_everything_is_meshed_and_after_success_no_journal_is_left(tmp_path):
    broken = bow_tie_and_others()
    run(tmp_path)
    assert (tmp_path / ".tessera").is_dir()
    bpy.data.objects.remove(broken)
    status, records = run(tmp_path)
    assert status == 0 and not any(record["earlier"] for record in records.values())
    assert not (tmp_path / ".tessera").exists()


def test_files_that_are_done_are_not_opened_again(tmp_path):
    drawings, out = tmp_path / "in", tmp_path / "out"
    drawings.mkdir()
    for name in "ab":
        shape = '<rect width="90" height="45"/>'
        (drawings / f"{name}.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{shape}</svg>')
    words = (
        drawings,
        "--output",
        out,
        "--format",
        "stl",
        "--resume",
        "--triangle-count",
        20,
        "--size-by=triangle-count",
    )
    assert run(tmp_path, *words)[0] == 0
    written = {path.name: path.stat().st_mtime_ns for path in out.glob("*.stl")}
    (drawings / "b.svg").touch()
    (drawings / "c.svg").write_bytes((drawings / "a.svg").read_bytes())
    assert run(tmp_path, *words)[0] == 0
    earlier = [record["earlier"] for record in json.loads((tmp_path / "report.json").read_text())["curves"]]
    assert earlier == [True, False, False]
    again = {path.name: path.stat().st_mtime_ns for path in out.glob("*.stl")}
    assert sorted(again) == ["a.stl", "b.stl", "c.stl"] and again["a.stl"] == written["a.stl"]
    assert again["b.stl"] > written["b.stl"]
    (out / "a.stl").unlink()
    assert run(tmp_path, *words)[0] == 0 and (out / "a.stl").exists()


@pytest.mark.parametrize(("count", "edge_length", "together"), [(10, 0.06, 1), (150, 0.3, 45)])
def test_a_run_that_is_killed_loses_what_is_in_hand_alone(tmp_path, count, edge_length, together):
    """Curves of thousands of triangles one by one, small ones by the handful."""
    for i in range(count):
        poly_curve(star(6 + i % 10), name=f"A{i:03}")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    script = ROOT / "tests" / "blender" / "run_command.py"
    words = [sys.executable, script, tmp_path / "scene.blend", "mesh", "--output", tmp_path / "out.blend"]
    words += ["--edge-length", str(edge_length)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with open(tmp_path / "said", "w") as said:
        process = subprocess.Popen(words, env=environment, stdout=said, stderr=subprocess.STDOUT)
    folder, until = journal.folder_of(tmp_path / "out.blend"), time.monotonic() + 60
    while sum(path.read_text().count("\n") for path in folder.glob("*.jsonl")) < 3:
        assert process.poll() is None and time.monotonic() < until, (tmp_path / "said").read_text()
        time.sleep(0.005)
    process.kill()
    process.wait()
    assert not (tmp_path / "out.blend").exists()
    done = sum(path.read_text().count("\n") for path in folder.glob("*.jsonl"))
    shown = (tmp_path / "said").read_text().count(" triangles, ")
    assert 3 <= done < count and done - shown <= together
    report = tmp_path / "report.json"
    again = subprocess.run([*words, "--resume", "--report", report], env=environment, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    records = json.loads(report.read_text())["curves"]
    assert [record["earlier"] for record in records] == [True] * done + [False] * (count - done)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out.blend"))
    counts = {record["object"]: record["n_triangles"] for record in records}
    assert counts == {name: len(bpy.data.objects[f"{name} Mesh"].data.polygons) for name in counts}


@settings(max_examples=60, deadline=None)
@given(
    counts=st.lists(st.integers(0, 5), min_size=1, max_size=6),
    ending=st.sampled_from(["jsonl", "bin"]),
    damage=st.sampled_from(["cut", "zeros", "removed"]),
    at=st.integers(0, 10_000),
)
def test_a_journal_that_was_damaged_anywhere_has_its_whole_entries(tmp_path_factory, counts, ending, damage, at):
    target = tmp_path_factory.mktemp("journal") / "out.blend"
    journal.folder_of(target).mkdir(parents=True)
    writing = journal.Journal(target, "1")
    for number, count in enumerate(counts):
        arrays = [np.full((count, 2), number, dtype=np.float64), np.arange(count, dtype=np.int32)]
        writing.add(str(number), {"status": "meshed", "edge_lengths": (0.1, 1 / 3, 2e-7)}, arrays)
    writing.close()
    (path,) = journal.folder_of(target).glob(f"*.{ending}")
    raw = path.read_bytes()
    at %= len(raw) + 1
    ends = [i + 1 for i, byte in enumerate(raw) if byte == 10] if ending == "jsonl" else None
    path.write_bytes(raw[:at] + bytes(len(raw) - at) * (damage == "zeros"))
    if damage == "removed":
        path.unlink()
    entries = journal.Journal(target, "2").entries
    assert list(entries) == [str(number) for number in range(len(entries))]
    if damage == "removed":
        assert not entries
    elif ends:  # a line may do without its end
        assert len(entries) in {sum(end <= at for end in ends), sum(end - 1 <= at for end in ends)}
    for number, entry in enumerate(entries.values()):
        first, second = journal.load(entry)
        assert np.array_equal(first, np.full((counts[number], 2), number)) and len(second) == counts[number]


@pytest.mark.parametrize(
    ("damaged", "left"),
    [
        ("*.jsonl", b"\0" * 2000),
        ("*.jsonl", b"null\n[]\n\xff\n"),
        ("*.bin", None),
        ("*.bin", b""),
        ("done.json", b""),
        ("done.json", b"{}"),
        ("done.json", b"null"),
    ],
)
def test_what_is_damaged_is_meshed_again(tmp_path, damaged, left):
    bow_tie_and_others(1)
    run(tmp_path)
    (path,) = journal.folder_of(tmp_path / "out.blend").glob(damaged)
    path.unlink() if left is None else path.write_bytes(left)
    status, records = run(tmp_path, "--resume")
    assert status == 1 and {name: record["status"] for name, record in records.items()} == {
        "A0": "meshed",
        "Z": "failed",
    }
    assert records["A0"]["earlier"] == (damaged == "done.json")


def test_a_dry_run_of_what_is_left_leaves_out_what_is_done(tmp_path, capsys):
    bow_tie_and_others(2)
    scene = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(scene))
    words = ["mesh", str(scene), "--edge-length", "0.3", "--output", str(tmp_path / "out.blend"), "--resume"]

    def planned():
        capsys.readouterr()
        status, said = command.run([*words, "--dry-run"]), capsys.readouterr()
        return status, [line.split(" loop")[0] for line in said.out.splitlines() if " -> " in line], said.err

    every = [f"scene.blend: {name}: 1" for name in ("A0", "A1", "Z")]
    assert planned() == (0, every, "")
    command.run(words)
    assert planned()[:2] == (0, every[2:]) and "scene.blend: 2 curves are meshed already" in planned()[2]
    bpy.data.objects.remove(bpy.data.objects["Z"])
    bpy.ops.wm.save_as_mainfile(filepath=str(scene))
    assert planned()[:2] == (0, [])
    assert command.run(words) == 0
    assert planned()[:2] == (0, []) and "scene.blend: done already" in planned()[2]


def test_ctrl_c_ends_the_command_after_the_curves_in_hand(tmp_path, capsys, monkeypatch):
    meshed, before = meshing.mesh_tasks, signal.getsignal(signal.SIGINT)

    def mesh_tasks(tasks):
        if tasks[0].obj.name == "A1":
            signal.raise_signal(signal.SIGINT)
        return meshed(tasks)

    monkeypatch.setattr(meshing, "mesh_tasks", mesh_tasks)
    monkeypatch.setattr(meshing, "_TOGETHER", 1)
    bow_tie_and_others()
    status, records = run(tmp_path)
    assert status == 130 and list(records) == ["A0", "A1"] and not (tmp_path / "out.blend").exists()
    assert "--resume goes on" in json.loads((tmp_path / "report.json").read_text())["stopped"]
    assert "tessera: stopped by Ctrl-C: the same command with --resume goes on" in capsys.readouterr().err
    assert signal.getsignal(signal.SIGINT) == before
    monkeypatch.undo()
    status, records = run(tmp_path, "--resume")
    assert status == 1 and [name for name, record in records.items() if record["earlier"]] == ["A0", "A1"]
    assert json.loads((tmp_path / "report.json").read_text())["stopped"] is None


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a full disk is a file of Linux here")
def test_a_run_that_a_full_disk_stops_reports_what_is_done(tmp_path, capsys, monkeypatch):
    adds, count = journal.Journal.add, []

    def add(self, *arguments):
        count.append(arguments)
        if len(count) == 2:
            self._arrays = open("/dev/full", "ab")
        return adds(self, *arguments)

    monkeypatch.setattr(journal.Journal, "add", add)
    bow_tie_and_others()
    status, records = run(tmp_path)
    assert status == 1 and list(records) == ["A0"] and records["A0"]["output"] is None
    said = capsys.readouterr().err
    assert f"tessera: stopped at '{tmp_path / '.tessera'}" in said and "No space left" in said and "--resume" in said


def test_an_earlier_runs_process_leaves_a_later_runs_files_alone(tmp_path, capsys, monkeypatch):
    """A helper that is left of a run that was killed, or one that does not know yet, after the next has begun."""
    poly_curve(SQUARE, name="A")
    scene, target, together = tmp_path / "scene.blend", tmp_path / "out.obj", batch.mesh_curves
    bpy.ops.wm.save_as_mainfile(filepath=str(scene))
    words = ["mesh", str(scene), "--output", str(target), "--edge-length", "0.5"]
    folder = journal.folder_of(target) / "run-1"

    def later(job, curves, own):
        journal.take(target, "run-2")
        journal.Journal(target, "run-2").add("A", {"status": "meshed"}, [np.zeros(3)])
        return together(job, curves, own)

    def killed(job, curves, own):
        shutil.rmtree(folder)
        return together(job, curves, own)

    monkeypatch.setattr(batch, "mesh_curves", later)
    assert command.run(words) == 1
    assert "stopped, as a later run makes the same files" in capsys.readouterr().err
    assert "A" in journal.Journal(target, "run-3").entries
    monkeypatch.setattr(batch, "mesh_curves", killed)
    journal.take(target, "run-1")
    folder.mkdir()
    Claims("run-1", folder).lead()
    assert command.run([*words, "--helps", str(folder)]) == 3
    assert not target.exists() and not (journal.folder_of(target) / "done.json").exists()
    assert "A" in journal.Journal(target, "run-3").entries


def test_what_is_left_of_processes_of_another_run_is_removed_whichever_file_comes_first(tmp_path):
    for name in "bc":
        (tmp_path / f"{name}.svg").write_text(
            '<svg xmlns="http://www.w3.org/2000/svg"><rect width="90" height="45"/></svg>'
        )
    folder = journal.folder_of(tmp_path / "out" / "c.blend")
    for name in ("run-1", "new-1"):
        (folder / name).mkdir(parents=True)
    (folder / "run-1-0.log").touch()
    assert run(tmp_path, tmp_path / "*.svg", "--output", tmp_path / "out", "--resume")[0] == 0
    assert sorted(path.name for path in folder.iterdir()) == ["done.json", "run"]


def test_a_claim_is_given_once_and_none_when_no_one_leads(tmp_path):
    first, second = Claims("run", tmp_path), Claims("run", tmp_path)
    first.lead()
    assert first.claim(0, 1) and not second.claim(0, 1) and second.claim(0) and second.is_claimed(0, 1)
    assert not first.is_claimed(1) and first.count() == 2
    os.utime(tmp_path / "alive", (0, time.time() - PATIENCE - 1))
    with pytest.raises(RunIsOver):
        second.claim(5)
