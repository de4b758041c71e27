"""An empty Blender file, with the add-on registered, around every test; and the ways tests draw curves."""

import os
import sys

import bpy
import pytest

import addon.blender
from tests.blender.drawing import SQUARE, poly_curve


@pytest.fixture(autouse=True)
def empty_file():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.blender.register()
    yield
    addon.blender.unregister()


@pytest.fixture
def square():
    """A square, and the linked mesh of it, which is active."""
    curve = poly_curve(SQUARE, name="Square")
    assert bpy.ops.tessera.mesh_curve(edge_length=0.2, keep_linked=True, flips=True) == {"FINISHED"}
    return curve, bpy.context.object


_status = pytest.ExitCode.OK


def pytest_sessionfinish(exitstatus):
    """Remember how the tests ended."""
    global _status
    _status = exitstatus


@pytest.hookimpl(trylast=True)
def pytest_unconfigure():
    """End the process here: hypothesis keeps modules, and `bpy` freed as late as that crashes or hangs."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(int(_status))
