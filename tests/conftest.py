"""The root's ``__init__.py`` is the extension's entry, which imports Blender: to pytest the root is a plain folder.

This file is not in the root itself, as pytest would then import the root as a package by its folder's name, `tessera`.
"""

from pathlib import Path

import pytest


def pytest_collect_directory(path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect the root as a folder, not as a package."""
    return pytest.Dir.from_parent(parent, path=path) if path == Path(__file__).parents[1] else None
