"""Blender's window from within: what a user would do with mouse and keys, and pictures of what is then to be seen."""

from __future__ import annotations

import inspect
import itertools
import os
import subprocess
import traceback
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import bpy
from mathutils import Vector

PACE = 0.4  # seconds for Blender to handle the events of a step
_PATIENCE = 60.0  # seconds
_COLOURS = 128


def take(steps: Iterator[None], caller: dict) -> None:
    """Take the steps, a while after each other, and end Blender: with status 1 where one raised an error.

    caller: the global names of the script that opened the window, which would end it by itself after a few steps.
    """
    if "steps" in caller:
        caller["steps"] = itertools.repeat("redraw")

    def advance() -> float:
        try:
            next(steps)
            return PACE
        except StopIteration:
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)

    bpy.app.timers.register(advance, first_interval=PACE)


def called_from() -> dict:
    """The global names of whatever called the function that calls this."""
    return inspect.currentframe().f_back.f_back.f_globals


def area() -> bpy.types.Area:
    """The 3D view."""
    screen = bpy.context.window_manager.windows[0].screen
    return next(area for area in screen.areas if area.type == "VIEW_3D")


def view() -> bpy.types.SpaceView3D:
    """The 3D view's own settings."""
    return area().spaces[0]


def in_view(function: Callable, *arguments, **more):
    """Call an operator as from the 3D view."""
    region = next(region for region in area().regions if region.type == "WINDOW")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=area(), region=region):
        return function(*arguments, **more)


def empty_scene() -> None:
    """Object Mode, and no object."""
    if bpy.context.mode != "OBJECT":
        in_view(bpy.ops.object.mode_set, mode="OBJECT")
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    bpy.context.preferences.view.smooth_view = 0
    bpy.context.window_manager.tessera_show_quality = False
    view().overlay.show_cursor = view().overlay.show_object_origins = False
    sidebar(False)


def add(name: str, data: bpy.types.ID) -> bpy.types.Object:
    """A new object in the scene."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(obj)
    return obj


def select(*objects: bpy.types.Object) -> None:
    """Select these alone; the first is the active one."""
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0]


def look_down(objects: Sequence[bpy.types.Object], fill: float = 0.8, aside: float = 0.0) -> None:
    """Select the objects and see them from the top; fill: their share of the view; aside: how much they go left."""
    select(*objects)
    in_view(bpy.ops.view3d.view_axis, type="TOP")
    region = view().region_3d
    region.view_perspective = "ORTHO"
    corners = [obj.matrix_world @ Vector(corner) for obj in objects for corner in obj.bound_box]
    low, high = (Vector(map(extreme, zip(*corners, strict=True))) for extreme in (min, max))
    # Of the longer side of the view, a lens of 50 mm shows 72 mm.
    wide = max(high.x - low.x, (high.y - low.y) * area().width / area().height) / fill
    region.view_distance = wide * view().lens / 72
    region.view_location = (low + high) / 2 + Vector((aside * wide, 0, 0))


def sidebar(shown: bool) -> None:
    """Show the sidebar's tab Tessera, or hide the sidebar; its tab can be chosen a step after it is shown."""
    view().show_region_ui = shown


def choose_tab() -> None:
    """The sidebar's tab Tessera."""
    next(region for region in area().regions if region.type == "UI").active_panel_category = "Tessera"


def press(kind: str, across: float = 0.5, up: float = 0.5, **more) -> None:
    """A key or a mouse button, with the mouse at a share of the 3D view's width and height."""
    here = {"x": area().x + int(across * area().width), "y": area().y + int(up * area().height)}
    for value in ("PRESS", "RELEASE"):
        bpy.context.window_manager.windows[0].event_simulate(type=kind, value=value, **here, **more)


def move(across: float = 0.5, up: float = 0.5) -> None:
    """The mouse alone."""
    here = {"x": area().x + int(across * area().width), "y": area().y + int(up * area().height)}
    bpy.context.window_manager.windows[0].event_simulate(type="MOUSEMOVE", value="NOTHING", **here)


def remember(message: str) -> None:
    """A step that undo, and Adjust Last Operation, can go back to."""
    bpy.ops.ed.undo_push(message=message)


def until(condition: Callable[[], object]) -> Iterator[None]:
    """Wait for it, for a minute at most."""
    for _ in range(round(_PATIENCE / PACE)):
        yield
        if condition():
            return
    raise TimeoutError(inspect.getsource(condition))


def picture(path: Path, box: tuple[int, int, int, int] | None = None, width: int = 1000) -> None:
    """What is to be seen, as a small PNG.

    box: left, top, width and height in pixels of the screen; without one, the 3D view. width: to which it is made
    smaller.
    """
    if box is None:
        window = bpy.context.window_manager.windows[0]
        box = area().x, window.height - area().y - area().height, area().width, area().height
    left, top, wide, high = box
    cut = ["-crop", f"{wide}x{high}+{left}+{top}", "+repage", "-resize", f"{width}x>"]
    small = ["-strip", "+dither", "-colors", str(_COLOURS), "-define", "png:compression-level=9"]
    subprocess.run(["import", "-window", "root", *cut, *small, f"PNG8:{path}"], check=True)
