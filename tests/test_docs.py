"""The documents are true: their examples run, and what they link to is there."""

import ast
import doctest
import re
import runpy
from pathlib import Path

import pytest

import tessera

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted(page for pattern in ("*.md", "docs/**/*.md", "training/*.md") for page in ROOT.glob(pattern))


@pytest.mark.parametrize("page", ["README.md", "docs/python.md", "docs/airfoil.md"])
def test_examples_run(page):
    result = doctest.testfile(str(ROOT / page), module_relative=False)
    assert result.attempted > 5 and not result.failed


def test_the_package_example_runs():
    result = doctest.testmod(tessera)
    assert result.attempted and not result.failed


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)#]+)\)", page.read_text()):
        if "://" not in link:
            assert (page.parent / link).exists(), f"{page.name} links to {link}"


def test_make_targets_that_are_named_exist():
    targets = set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    for page in PAGES:
        for target in re.findall(r"`make (\w+)`|^make (\w+)", page.read_text(), re.MULTILINE):
            assert "".join(target) in targets, f"{page.name} names make {''.join(target)}"


def reasons():
    """Every reason that the code can give: of its errors, of the command's failures, or noted before as `reason`."""
    for path in (ROOT / "addon").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "reason":
                yield from (part.value for part in ast.walk(node.value) if isinstance(part, ast.Constant))
            if isinstance(node, ast.Call):
                at = {"ContourError": 0, "OutlineError": 0, "failed": 2}.get(getattr(node.func, "id", ""))
                if at is not None and len(node.args) > at and isinstance(node.args[at], ast.Constant):
                    yield node.args[at].value


def test_every_reason_is_explained_and_no_other():
    page = (ROOT / "docs" / "troubleshooting.md").read_text()
    explained = re.findall(r"^\| `([\w-]+)` \|", page, re.MULTILINE)
    assert len(set(reasons())) > 15
    assert sorted(explained) == sorted(set(reasons()))


def test_every_setting_is_explained_by_its_label_and_its_name():
    page = (ROOT / "docs" / "settings.md").read_text()
    settings = runpy.run_path(str(ROOT / "addon" / "blender" / "settings.py"))["table"]()
    assert len(settings) > 20
    for name, shown in settings.items():
        label = page.find(f"**{shown.label}**")
        assert label >= 0 and f"`{name}`" in page, f"{shown.label} ({name}) is not in the settings"


@pytest.mark.parametrize("picture", sorted((ROOT / "docs" / "images" / "manual").glob("*.png")), ids=lambda p: p.name)
def test_the_manuals_pictures_are_small_and_all_are_shown(picture):
    assert picture.stat().st_size < 300_000
    assert any(picture.name in page.read_text() for page in PAGES)
