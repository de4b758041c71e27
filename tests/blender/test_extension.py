"""The extension's zips: what is in them, and that their wheels are the pinned ones, for the machines they name."""

import compileall
import hashlib
import io
import tomllib
import zipfile
from pathlib import Path

import pytest

from scripts.build_extension import build
from scripts.fetch_wheels import ROOT, locked, unlike_the_lock

MANIFEST = tomllib.loads((ROOT / "blender_manifest.toml").read_text())
ALLOWED = ("addon/", "onnx_models/", "wheels/")
ALLOWED_FILES = {"blender_manifest.toml", "__init__.py", "LICENSE", "README.md"}
PYTHONS = {
    "linux-x64": ["cp311", "cp313", "cp314"],
    "windows-x64": ["cp311", "cp313", "cp314"],
    "windows-arm64": ["cp311", "cp313", "cp314"],
    "macos-arm64": ["cp311", "cp313", "cp314"],
    "macos-x64": ["cp311", "cp313"],
}


@pytest.fixture(scope="session")
def zips(tmp_path_factory):
    """The path of each platform's zip, built from wheels that are those of the lock."""
    wrong = unlike_the_lock()
    if wrong:
        pytest.skip(f"{len(wrong)} wheels are not in wheels/ as locked: run `make wheels`")
    output = tmp_path_factory.mktemp("extension")
    compileall.compile_dir(ROOT / "addon", quiet=2)  # what lies about in a folder that was worked in
    build(output)
    return {path.stem.rpartition("-")[2].replace("_", "-"): path for path in output.glob("*.zip")}


def test_the_manifest_names_the_locked_wheels():
    assert sorted(Path(wheel).name for wheel in MANIFEST["wheels"]) == sorted(name for _, name in locked())


def test_there_is_a_zip_below_80_megabytes_for_each_platform(zips):
    assert sorted(zips) == sorted(MANIFEST["platforms"]) == sorted(PYTHONS)
    assert all(1e6 < path.stat().st_size < 80e6 for path in zips.values())


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


@pytest.mark.parametrize("platform", PYTHONS)
def test_a_zip_has_one_pinned_wheel_for_each_python_and_none_for_another_machine(zips, platform):
    archive = zipfile.ZipFile(zips[platform])
    wheels = sorted(name for name in archive.namelist() if name.startswith("wheels/"))
    assert [Path(wheel).name.split("-")[2] for wheel in wheels] == PYTHONS[platform]
    digests = {name: digest for digest, name in locked()}
    for wheel in wheels:
        content = archive.read(wheel)
        assert hashlib.sha256(content).hexdigest() == digests[Path(wheel).name]
        assert _machines(zipfile.ZipFile(io.BytesIO(content))) == {platform}


def _machines(wheel):
    """The platforms that the compiled modules of a wheel are for, by their own headers."""
    return {_machine(wheel.read(name)[:4096]) for name in wheel.namelist() if name.endswith((".so", ".pyd", ".dylib"))}


def _machine(header):
    if header[:4] == b"\x7fELF":
        return {62: "linux-x64", 183: "linux-arm64"}[int.from_bytes(header[18:20], "little")]
    if header[:2] == b"MZ":
        start = int.from_bytes(header[0x3C:0x40], "little")
        assert header[start : start + 4] == b"PE\0\0"
        kind = int.from_bytes(header[start + 4 : start + 6], "little")
        return {0x8664: "windows-x64", 0xAA64: "windows-arm64"}[kind]
    assert header[:4] == b"\xcf\xfa\xed\xfe"  # Mach-O of one machine; a universal one begins with cafebabe
    return {0x01000007: "macos-x64", 0x0100000C: "macos-arm64"}[int.from_bytes(header[4:8], "little")]
