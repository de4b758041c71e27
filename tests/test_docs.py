"""The documents are true: their examples run, and what they link to is there."""

import doctest
import re
from pathlib import Path

import pytest

import tessera

ROOT = Path(__file__).resolve().parents[1]
PAGES = sorted(page for pattern in ("*.md", "docs/**/*.md", "training/*.md") for page in ROOT.glob(pattern))


@pytest.mark.parametrize("page", ["README.md"])
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
