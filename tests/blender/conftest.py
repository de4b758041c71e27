"""An empty Blender file, with the add-on registered, around every test; and the ways tests draw curves."""

import bpy
import pytest

import addon.blender


@pytest.fixture(autouse=True)
def empty_file():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.blender.register()
    yield
    addon.blender.unregister()
