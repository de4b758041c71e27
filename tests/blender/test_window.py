"""The installed extension in Blender's real window, on a virtual screen: what a user clicks, and what is to be seen.

It needs the tool named by REAL_BLENDER, whose `gui` opens the window; without it these tests are skipped.
"""

import json
import os
import subprocess

import matplotlib.image
import numpy as np
import pytest

from tests.blender.test_extension import zips  # noqa: F401  (a fixture)
from tests.blender.test_installed import HERE, TOOL


@pytest.fixture(scope="module", params=["4.3", "5.2"])
def walk(request, zips, tmp_path_factory):  # noqa: F811
    """What happened on a walk through the window (click_through.py), and the folder of its pictures."""
    if not TOOL.exists():
        pytest.skip("no tool that opens Blender's window on a virtual screen: name one with REAL_BLENDER")
    folder = tmp_path_factory.mktemp("window")
    facts = folder / "facts.json"
    environment = os.environ | {
        "BLENDER_USER_RESOURCES": str(tmp_path_factory.mktemp("user")),
        "PYTHONNOUSERSITE": "1",
        "CLICK_THROUGH": str(facts),
    }

    def tool(*words):
        return subprocess.run([TOOL, *map(str, words)], env=environment, capture_output=True, text=True, timeout=400)

    install = ("--command", "extension", "install-file", "--repo", "user_default", "--enable", zips["linux-x64"])
    installed = tool("run", request.param, *install)
    if "not set up" in installed.stderr:
        pytest.skip(f"no Blender {request.param}: {installed.stderr.strip()}")
    assert installed.returncode == 0, installed.stdout + installed.stderr
    shot = folder / "end.png"
    ran = tool("gui", request.param, shot, HERE / "click_through.py", "--enable-event-simulate")
    assert facts.exists(), ran.stdout + ran.stderr
    happened = json.loads(facts.read_text())
    assert "error" not in happened, happened["error"]
    return happened, folder


def seen(folder, name):
    """The left part of a picture, where the 3D view is: (height, width, 3) from 0 to 1."""
    picture = matplotlib.image.imread(folder / f"{name}.png")[..., :3]
    return picture[:, : 3 * picture.shape[1] // 4]


def test_what_search_finds_meshes_at_the_first_click(walk):
    happened, _ = walk
    (n_triangles,) = happened["searched"].values()
    assert 300 < n_triangles < 5000 and happened["operator"] == "TESSERA_OT_mesh_curve"
    assert 0.01 < happened["length shown"] < 0.1
    assert happened["preferred"] == 2  # of the preferences


def test_undo_is_one_step_and_a_changed_length_meshes_again(walk):
    happened, _ = walk
    assert happened["undone"] == ["Words"]
    assert list(happened["adjusted"]) == ["Words Mesh"]
    assert happened["adjusted"]["Words Mesh"] < 0.5 * happened["searched"]["Words Mesh"]
    # A length that suits one object rarely suits another, so the next use starts anew.
    assert happened["length next time"] == happened["length shown"]


def test_long_work_shows_its_progress_and_esc_cancels_it(walk):
    happened, folder = walk
    assert happened["started"] == ["RUNNING_MODAL"]
    assert happened["cancelled"] == [{}, True]
    # The status bar is the lowest line, and empty at its left but for the progress.
    bar, before = (seen(folder, name)[-22:-2, :300].mean(axis=2) for name in ("progress", "quality"))
    assert np.ptp(bar) > 0.3 > np.ptp(before)


def test_a_failure_opens_a_popup_whose_button_selects_the_point(walk):
    happened, folder = walk
    assert happened["failed"] == [{}, True]
    mode, selected = happened["place"]
    assert mode == "EDIT_CURVE" and sum(selected) == 1
    assert np.abs(seen(folder, "failure") - seen(folder, "quality")).max() > 0.5


def test_a_linked_mesh_follows_its_text(walk):
    happened, _ = walk
    (n_triangles,), width, wanted = happened["followed"][0].values(), *happened["followed"][1:]
    assert n_triangles > 50 and width == pytest.approx(wanted, rel=0.02)


def test_the_overlay_colours_the_triangles_and_the_sidebar_has_the_numbers(walk):
    _, folder = walk
    red, green, blue = np.moveaxis(seen(folder, "quality"), -1, 0)
    good = (green > 0.6) & (green - red > 0.1) & (abs(green - blue) < 0.12)
    assert good.mean() > 0.02  # the letters; nothing in Blender's window is of that colour
    plain = np.moveaxis(seen(folder, "progress"), -1, 0)
    assert ((plain[1] > 0.6) & (plain[1] - plain[0] > 0.1)).mean() < 0.005
    bars = (blue > 0.6) & (blue - red > 0.3)
    assert bars.mean() > 0.001
