"""What is read: a .blend or .svg file is opened, and its curves are chosen."""

from __future__ import annotations

from pathlib import Path

import addon_utils
import bpy

from ..kinds import is_readable

# What is meshed unless objects are named: a mesh, strokes or an instance may well be no outline at all.
_CURVES = frozenset({"CURVE", "FONT", "CURVES"})


class InputError(Exception):
    """An input that cannot be used, in words for the user."""


def open_file(source: Path | None) -> None:
    """Open a file in place of what is open; None: stay with that. Raises InputError."""
    if source is not None:
        try:
            if source.suffix.lower() == ".svg":
                _open_svg(source)
            else:
                bpy.ops.wm.open_mainfile(filepath=str(source), load_ui=False)
        except (RuntimeError, AttributeError) as error:  # AttributeError: this Blender has no importer
            raise InputError(f"'{source}' cannot be read: {_last_line(error)}") from error
    if bpy.context.mode != "OBJECT" and bpy.context.object is not None:
        bpy.ops.object.mode_set(mode="OBJECT")  # a file that was saved in Edit Mode


def choose(names: tuple[str, ...] | None) -> list[bpy.types.Object]:
    """The curves and texts of the scene that are not hidden, by name, or those named. Raises InputError."""
    objects = bpy.context.view_layer.objects
    if names is None:
        return sorted((obj for obj in objects if obj.type in _CURVES and obj.visible_get()), key=lambda obj: obj.name)
    chosen = []
    for name in names:
        obj = objects.get(name)
        if obj is None or not is_readable(obj):
            raise InputError(f"there is no curve, text, mesh or the like named '{name}' in the scene")
        chosen.append(obj)
    return chosen


def _open_svg(source: Path) -> None:
    """An empty file with the curves of an SVG. Raises InputError.

    Its importer is an add-on, which the user may have switched off.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True, load_ui=False)
    addon_utils.enable("io_curve_svg")
    if bpy.ops.import_curve.svg(filepath=str(source)) != {"FINISHED"}:
        raise InputError(f"'{source}' cannot be read: it is no SVG file")


def _last_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return lines[-1].removeprefix("Error: ").rstrip(".") if lines else repr(error)
