"""The zip, installed into a real Blender with folders of its own: the operator, and the command line.

The Blender is that of the environment variable BLENDER; without it, those that the tool named by REAL_BLENDER has set
up. Where there is none, these tests are skipped and say why.
"""

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

from scripts.fetch_wheels import ROOT
from tests.blender.test_extension import zips  # noqa: F401  (a fixture)

HERE = Path(__file__).resolve().parent
TOOL = Path(os.environ.get("REAL_BLENDER") or HERE.parents[2] / "shared" / "tools" / "real-blender")
VERSIONS = ("BLENDER",) if os.environ.get("BLENDER") else ("4.3", "5.2")


@pytest.fixture(scope="session", params=VERSIONS)
def blender(request, zips, tmp_path_factory):  # noqa: F811
    """A function that runs Blender with the extension installed and returns the finished process."""
    executable = _executable(request.param)
    user = tmp_path_factory.mktemp("user")
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(user), "PYTHONNOUSERSITE": "1"}

    def run(*arguments, until=None, end=lambda process: os.killpg(process.pid, signal.SIGKILL)):
        """until: asked every now and then; once it says so, `end` is done to the process, once.

        By default, Blender and all that it has started are killed.
        """
        process = subprocess.Popen(
            [executable, *map(str, arguments)],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        try:
            for _ in range(30_000 if until else 0):
                if process.poll() is not None:
                    break
                if until():
                    end(process)
                    break
                time.sleep(0.01)
            said, complained = process.communicate(timeout=300)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
        return subprocess.CompletedProcess(process.args, process.returncode, said, complained)

    installed = run("--command", "extension", "install-file", "--repo", "user_default", "--enable", zips["linux-x64"])
    assert installed.returncode == 0, installed.stdout + installed.stderr
    return run


def _executable(version):
    """A Blender that runs, or a skip that says what is missing."""
    path = os.environ.get("BLENDER")
    if not path:
        if not TOOL.exists():
            pytest.skip(f"no Blender {version}: name one with BLENDER=/path/to/blender")
        path = subprocess.run([TOOL, "where", version], capture_output=True, text=True, check=True).stdout.strip()
    try:
        answer = subprocess.run([path, "--version"], capture_output=True, text=True, timeout=120)
    except OSError as error:
        pytest.skip(f"{path} does not run: {error}")
    if answer.returncode:
        pytest.skip(f"no Blender {version}: {answer.stderr.strip() or answer.stdout.strip()}")
    return path


@pytest.fixture(scope="session")
def scene(blender, tmp_path_factory):
    """A .blend with an outline, a text, a camera's path and a curve that crosses itself."""
    path = tmp_path_factory.mktemp("scene") / "scene.blend"
    made = blender("-b", "--factory-startup", "--python-exit-code", 1, "--python", HERE / "make_scene.py", "--", path)
    assert made.returncode == 0, made.stdout + made.stderr
    return path


def _processes(folder, helpers):
    """The numbers of the processes of a run whose files are in a folder: those that help, or those that lead."""
    lines = {int(path.parent.name): _line(path) for path in Path("/proc").glob("[0-9]*/cmdline")}
    return [n for n, line in lines.items() if os.fsencode(folder) in line and (b"--helps" in line) == helpers]


def _line(path):
    try:
        return path.read_bytes()
    except OSError:  # it has just ended
        return b""


def test_the_operator_in_the_installed_extension(blender, tmp_path):
    result = tmp_path / "result.json"
    ran = blender("-b", "--python-exit-code", 1, "--python", HERE / "use_operator.py", "--", result)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    facts = json.loads(result.read_text())
    assert facts["module"].startswith("bl_ext.user_default.tessera.")
    assert facts["heavy_before"] == []
    assert "site-packages" in facts["onnxruntime"]
    assert 100 < facts["triangles"] < 5000
    assert facts["q_mean"] > 0.85
    assert "crosses" in facts["refusal"] and "'Bow tie'" in facts["refusal"]
    assert facts["objects_after_refusal"] == facts["objects_before_refusal"]
    assert facts["menus_after_disabling"] == 0


def test_the_command_meshes_every_outline_of_the_file(blender, scene, tmp_path):
    out = tmp_path / "out.blend"
    ran = blender("-b", scene, "--command", "tessera", "mesh", "--edge-length", 0.1, "--output", out)
    assert ran.returncode == 1  # the one that crosses itself
    assert "Outline: " in ran.stdout and "triangles, q_worst 0." in ran.stdout
    assert "Path: passed over (open)" in ran.stdout
    assert "Bow tie: failed (self-intersection)" in ran.stderr
    assert out.exists()


def test_the_command_meshes_those_named_and_says_so_with_its_exit_status(blender, scene, tmp_path):
    out = tmp_path / "out.blend"
    arguments = ("mesh", "--edge-length", 0.1, "--output", out, "--boundary", "keep", "--objects", "Outline", "Words")
    ran = blender("-b", scene, "--command", "tessera", *arguments)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert [line.split(":")[0] for line in ran.stdout.splitlines() if "q_worst" in line] == ["Outline", "Words"]
    names = (
        "import bpy; print('NAMES', sorted(o.name for o in bpy.data.objects if o.type == 'MESH' and o.data.polygons))"
    )
    looked = blender("-b", out, "--python-expr", names)
    assert "NAMES ['Outline Mesh', 'Words Mesh']" in looked.stdout


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (("mesh", "--output", "OUT", "--objects", "Nobody"), 2, "named 'Nobody'"),
        (("mesh",), 2, "--output"),
        (("mesh", "--output", "OUT", "--objects", "Path"), 1, "Path: failed (open)"),
        (
            ("mesh", "--output", "OUT", "--edge-length", "1e-9", "--objects", "Outline"),
            1,
            "failed (too-many-triangles)",
        ),
        (("mesh", "--help"), 0, "--edge-length"),
    ],
)
def test_the_commands_exit_status_when_nothing_is_written(blender, scene, tmp_path, arguments, status, said):
    out = tmp_path / "out.blend"
    ran = blender("-b", scene, "--command", "tessera", *(out if word == "OUT" else word for word in arguments))
    assert ran.returncode == status, ran.stdout + ran.stderr
    assert said in ran.stdout + ran.stderr
    assert not out.exists()


def test_the_scripts_of_the_manual_run(blender, tmp_path):
    scripts = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs" / "batch.md").read_text(), re.MULTILINE | re.DOTALL)
    script = tmp_path / "script.py"
    script.write_text("".join(scripts) + "\nprint('OBJECTS', sorted(bpy.data.objects.keys()))\n")
    ran = blender("-b", "--python-exit-code", 1, "--python", script)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "OBJECTS ['BézierCircle', 'BézierCircle Mesh', 'Plate']" in ran.stdout


def test_every_zip_is_valid_to_this_blender(blender, zips):  # noqa: F811
    for path in zips.values():
        checked = blender("--command", "extension", "validate", path)
        assert checked.returncode == 0, checked.stdout + checked.stderr


def test_a_folder_is_meshed_by_two_processes(blender, scene, tmp_path):
    inputs, outputs, report = tmp_path / "in", tmp_path / "out", tmp_path / "report.json"
    inputs.mkdir()
    for name in ("a.blend", "b.blend"):
        (inputs / name).write_bytes(scene.read_bytes())
    (inputs / "logo.svg").write_bytes((ROOT / "examples" / "logo.svg").read_bytes())
    words = ("mesh", inputs, "--output", outputs, "--format", "glb", "--jobs", 2, "--report", report)
    ran = blender("-b", "--command", "tessera", *words, "--size-by", "triangle-count", "--triangle-count", 50)
    assert ran.returncode == 1, ran.stdout + ran.stderr  # the outline that crosses itself, twice
    assert sorted(path.name for path in outputs.glob("*.*") if path.is_file()) == ["a.glb", "b.glb", "logo.glb"]
    assert all(path.read_bytes()[:4] == b"glTF" for path in outputs.glob("*.glb"))
    records = json.loads(report.read_text())["curves"]
    failed = [(Path(record["input"]).name, record["object"]) for record in records if record["status"] == "failed"]
    assert failed == [("a.blend", "Bow tie"), ("b.blend", "Bow tie")]
    assert sum(record["status"] == "meshed" for record in records) > 4


def test_two_processes_on_one_file_are_killed_and_taken_up_again(blender, tmp_path):
    scene, report, alone = tmp_path / "scene.blend", tmp_path / "report.json", tmp_path / "alone.obj"
    blender("-b", "--factory-startup", "--python", HERE / "make_scene.py", "--", scene, 12)
    command = ("-b", scene, "--command", "tessera", "mesh", "--edge-length", 0.3)
    helped = (*command, "--output", tmp_path / "out.obj", "--jobs", 2)
    journal = tmp_path / ".tessera" / "out.obj"
    killed = blender(*helped, until=lambda: sum(p.read_text().count("\n") for p in journal.glob("*.jsonl")) >= 3)
    assert killed.returncode == -signal.SIGKILL and not (tmp_path / "out.obj").exists()
    done = sum(path.read_text().count("\n") for path in journal.glob("*.jsonl"))
    ran = blender(*helped, "--resume", "--report", report)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    records = json.loads(report.read_text())["curves"]
    assert len(records) == 12 and sum(record["earlier"] for record in records) == done
    assert blender(*command, "--output", alone).returncode == 0
    assert (tmp_path / "out.obj").read_text().replace("out.mtl", "alone.mtl") == alone.read_text()


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_ends_all_processes_after_the_curves_in_hand(blender, tmp_path, jobs):
    scene, report, journal = tmp_path / "scene.blend", tmp_path / "report.json", tmp_path / ".tessera" / "out.obj"
    blender("-b", "--factory-startup", "--python", HERE / "make_scene.py", "--", scene, 30)
    words = ("mesh", "--edge-length", 0.1, "--output", tmp_path / "out.obj", "--jobs", jobs, "--report", report)

    def some_are_done():
        return any(path.stat().st_size for path in journal.glob("*.jsonl"))

    def press(process):
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does

    command = ("-b", scene, "--command", "tessera", *words)
    ran = blender(*command, until=some_are_done, end=press)
    assert ran.returncode == 130, ran.stdout + ran.stderr
    assert "tessera: stopped by Ctrl-C: the same command with --resume goes on" in ran.stderr
    assert "another takes its place" not in ran.stderr and not (tmp_path / "out.obj").exists()
    assert not _processes(tmp_path, helpers=True) and not list(journal.glob("run-*/"))
    stopped = json.loads(report.read_text())
    assert stopped["stopped"] and 0 < stopped["counts"]["meshed"] < 30
    assert blender(*command, "--resume").returncode == 0
    records = json.loads(report.read_text())["curves"]
    assert len(records) == 30 and sum(record["earlier"] for record in records) == stopped["counts"]["meshed"]


def test_helpers_of_a_run_that_was_killed_leave_the_next_run_alone(blender, tmp_path):
    """They have a file each in hand, which the next run makes, too."""
    inputs, outputs, report = tmp_path / "in", tmp_path / "out", tmp_path / "report.json"
    inputs.mkdir()
    blender("-b", "--factory-startup", "--python", HERE / "make_scene.py", "--", inputs / "a.blend", 30)
    (inputs / "b.blend").write_bytes((inputs / "a.blend").read_bytes())
    words = ("mesh", inputs, "--output", outputs, "--format", "obj", "--edge-length", 0.1, "--jobs", 2)

    def both_are_begun():
        return len([path for path in outputs.glob(".tessera/*/*.jsonl") if path.stat().st_size]) == 2

    left = []

    def kill(_):
        for number in _processes(tmp_path, helpers=False):
            os.kill(number, signal.SIGKILL)
        left.extend(_processes(tmp_path, helpers=True))

    command = ("-b", "--command", "tessera", *words)
    blender(*command, until=both_are_begun, end=kill)
    ran = blender(*command, "--resume", "--report", report)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    records = json.loads(report.read_text())["curves"]
    assert len(left) == 2 and len(records) == 60 and any(record["earlier"] for record in records)


@pytest.mark.parametrize("times", [1, 2])
def test_what_a_process_had_in_hand_when_it_ended_is_done_once_more_each_by_itself(blender, tmp_path, times):
    scene, report = tmp_path / "scene.blend", tmp_path / "report.json"
    blender("-b", "--factory-startup", "--python", HERE / "make_scene.py", "--", scene, 30)
    journal = tmp_path / ".tessera" / "out.stl"
    words = ("mesh", "--edge-length", 0.1, "--output", tmp_path / "out.stl", "--jobs", 2, "--report", report)
    ended = []

    def end_some():
        """Kill a process that has claimed something: of the first ones, then of those that do it once more."""
        wanted = (b"--helps", b"--alone")[len(ended)] if len(ended) < times else None
        claimed = list(journal.glob("run-*-again/*-*" if ended else "run-*/*-*"))
        for path in Path("/proc").glob("[0-9]*/cmdline") if wanted and claimed else ():
            if wanted in (line := path.read_bytes()) and os.fsencode(tmp_path) in line:
                os.kill(int(path.parent.name), signal.SIGKILL)
                ended.append(line)
                return

    ran = blender("-b", scene, "--command", "tessera", *words, until=end_some)
    assert len(ended) == times, ran.stdout + ran.stderr
    assert ran.stderr.count("another takes its place") == times
    records = json.loads(report.read_text())["curves"]
    failed = [record["reason"] for record in records if record["status"] == "failed"]
    assert failed in (["process"] * (times - 1), []), failed  # none, if it was between two curves
    assert ran.returncode == bool(failed) and (tmp_path / "out.stl").exists()
    assert sum(record["status"] == "meshed" for record in records) == 30 - len(failed)
    assert not list(journal.glob("run-*/"))
