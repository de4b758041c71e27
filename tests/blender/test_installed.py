"""The zip, installed into a real Blender with folders of its own: the operator, and the command line.

The Blender is that of the environment variable BLENDER; without it, those that the tool named by REAL_BLENDER has set
up. Where there is none, these tests are skipped and say why.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

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

    def run(*arguments):
        return subprocess.run(
            [executable, *map(str, arguments)], env=environment, capture_output=True, text=True, timeout=300
        )

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
        (("mesh", "--output", "OUT", "--objects", "Nobody"), 2, "no curve or text named 'Nobody'"),
        (("mesh",), 2, "--output"),
        (("mesh", "--output", "OUT", "--objects", "Path"), 1, "Path: failed (open)"),
        (("mesh", "--output", "OUT", "--edge-length", "0"), 1, "failed (edge-length)"),
        (("mesh", "--help"), 0, "--edge-length"),
    ],
)
def test_the_commands_exit_status_when_nothing_is_written(blender, scene, tmp_path, arguments, status, said):
    out = tmp_path / "out.blend"
    ran = blender("-b", scene, "--command", "tessera", *(out if word == "OUT" else word for word in arguments))
    assert ran.returncode == status, ran.stdout + ran.stderr
    assert said in ran.stdout + ran.stderr
    assert not out.exists()
