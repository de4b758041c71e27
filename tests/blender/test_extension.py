"""The extension's zips: what is in them, and that the wheels they name are the pinned ones."""

import tomllib
import zipfile
from pathlib import Path

import pytest

from scripts.build_extension import build
from scripts.fetch_wheels import ROOT, WHEELS, locked

MANIFEST = tomllib.loads((ROOT / "blender_manifest.toml").read_text())
ALLOWED = ("addon/", "onnx_models/", "wheels/")
ALLOWED_FILES = {"blender_manifest.toml", "__init__.py", "LICENSE", "README.md"}


@pytest.fixture(scope="session")
def zips(tmp_path_factory):
    missing = [name for _, name in locked() if not (WHEELS / name).exists()]
    if missing:
        pytest.skip(f"{len(missing)} wheels are not in wheels/: run `make wheels`")
    output = tmp_path_factory.mktemp("extension")
    build(output)
    return {path.stem.rpartition("-")[2].replace("_", "-"): path for path in output.glob("*.zip")}


def test_the_manifest_names_the_locked_wheels():
    assert sorted(Path(wheel).name for wheel in MANIFEST["wheels"]) == sorted(name for _, name in locked())


def test_there_is_a_zip_for_each_platform(zips):
    assert sorted(zips) == sorted(MANIFEST["platforms"])
    assert all(path.stat().st_size < 80e6 for path in zips.values())


def test_a_zip_holds_the_add_on_and_nothing_else(zips):
    for path in zips.values():
        names = zipfile.ZipFile(path).namelist()
        assert ALLOWED_FILES - {"README.md"} <= set(names)
        assert not [name for name in names if not name.startswith(ALLOWED) and name not in ALLOWED_FILES]
        assert not [name for name in names if "__pycache__" in name or name.endswith(".pyc")]
        for folder in ("addon", "onnx_models"):
            here = {
                p.relative_to(ROOT).as_posix() for p in (ROOT / folder).rglob("*.*") if p.suffix in (".py", ".onnx")
            }
            assert here == {name for name in names if name.startswith(f"{folder}/")}


def test_a_zip_has_one_wheel_for_each_python_of_its_platform(zips):
    marks = {"linux-x64": "manylinux", "windows-x64": "win_amd64", "macos-arm64": "macosx"}
    for platform, path in zips.items():
        wheels = [name for name in zipfile.ZipFile(path).namelist() if name.startswith("wheels/")]
        assert sorted(name.split("-")[2] for name in wheels) == ["cp311", "cp313", "cp314"]
        assert all(marks[platform] in name for name in wheels)
