"""What is written: the whole file as .blend, or the new meshes alone by one of Blender's exporters."""

from __future__ import annotations

import os
import shutil
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import addon_utils
import bpy

from .journal import folder_of


class OutputError(Exception):
    """A file that cannot be written, in words for the user."""


def write_file(target: Path, made: list[bpy.types.Object]) -> None:
    """Write what is open, or of the other formats than .blend only the objects that were made. Raises OutputError.

    The file is there whole, or as it was before: Blender itself writes a .blend beside it first, as is done here.
    """
    try:
        if target.suffix.lower() == ".blend":
            bpy.ops.wm.save_as_mainfile(filepath=str(target), check_existing=False, copy=True)
            return
        folder = folder_of(target) / f"new-{os.getpid()}"  # an earlier run's process may still have one
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        _select(made)
        with _in_a_window():
            _export(folder / target.name)
        # The file itself comes last, after what it refers to.
        for path in sorted(folder.iterdir(), key=lambda path: path.name == target.name):
            os.replace(path, target.with_name(path.name))
        folder.rmdir()
    except (RuntimeError, OSError) as error:
        raise OutputError(f"'{target}' was not written: {str(error).strip()}") from error


def _in_a_window() -> AbstractContextManager:
    """With a file that was named on Blender's command line there is no current window, and exporters ask for one."""
    context = bpy.context
    if context.window is not None:
        return nullcontext()
    window = context.window_manager.windows[0]
    return context.temp_override(window=window, scene=context.scene, view_layer=context.view_layer)


def _export(path: Path) -> None:
    """Export what is selected, at Blender's own axes and scale."""
    kind, file = path.suffix.lower(), str(path)
    if kind == ".obj":
        bpy.ops.wm.obj_export(filepath=file, check_existing=False, export_selected_objects=True, path_mode="ABSOLUTE")
    elif kind == ".stl":
        bpy.ops.wm.stl_export(filepath=file, check_existing=False, export_selected_objects=True)
    elif kind == ".ply":
        bpy.ops.wm.ply_export(filepath=file, check_existing=False, export_selected_objects=True)
    else:
        addon_utils.enable("io_scene_gltf2")  # an add-on, which the user may have switched off
        bpy.ops.export_scene.gltf(filepath=file, check_existing=False, export_format="GLB", use_selection=True)
    if not path.exists():
        raise OSError("the exporter wrote nothing")


def _select(made: list[bpy.types.Object]) -> None:
    """Select what was made and nothing else."""
    bpy.context.view_layer.update()  # before that, it does not list all new objects
    wanted = set(made)
    for obj in bpy.context.view_layer.objects:
        # Only what has to be set: each setting makes Blender look through the whole scene.
        for hiding in ("hide_select", "hide_viewport"):
            if obj in wanted and getattr(obj, hiding):
                setattr(obj, hiding, False)
        if obj in wanted and obj.hide_get():
            obj.hide_set(False)
        if obj.select_get() != (obj in wanted):
            obj.select_set(obj in wanted)
    for obj in made:
        if not obj.select_get():
            raise OSError(f"'{obj.name}' is in a collection that is switched off, and cannot be exported")
