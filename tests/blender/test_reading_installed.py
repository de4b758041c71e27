"""Every kind of object, in a real Blender, by the files of the installed extension."""

import json

import pytest

from tests.blender.test_extension import zips  # noqa: F401  (a fixture)
from tests.blender.test_installed import HERE, blender  # noqa: F401  (a fixture)

# Pieces less holes.
EULER = {"bezier": 1, "nurbs": 1, "poly": 0, "text": 3 - 5, "curves": 1, "strokes": 1, "mesh": 1, "instance": 1}


@pytest.fixture(scope="module")
def found(blender, tmp_path_factory):  # noqa: F811
    """What `mesh_kinds.py` has found."""
    result = tmp_path_factory.mktemp("kinds") / "result.json"
    ran = blender("-b", "--python-exit-code", 1, "--python", HERE / "mesh_kinds.py", "--", result)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return json.loads(result.read_text())


def test_it_is_the_installed_extension(found):
    assert "user_default/tessera" in found["file"]


@pytest.mark.parametrize("way", ["", " in place"])
@pytest.mark.parametrize("kind", EULER)
def test_every_kind_is_meshed(found, kind, way):
    made = found["made"][kind + way]
    assert (made["type"], made["corners"], made["broken"]) == ("MESH", [3], False)
    assert made["triangles"] > 50 and made["euler"] == EULER[kind]


def test_a_flat_part_is_meshed_again(found):
    made = found["made"]["edited"]
    assert (made["corners"], made["broken"], made["euler"]) == ([3], False, 2) and made["triangles"] > 200
