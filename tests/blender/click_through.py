"""Run in Blender's window by test_window.py, with events that stand for a user's: writes what happened as JSON.

The window must have been started with --enable-event-simulate. The file to write is named by CLICK_THROUGH; pictures of
the steps are put beside it.
"""

import inspect
import itertools
import json
import os
import subprocess
import traceback
from pathlib import Path

import bpy

OUT = Path(os.environ["CLICK_THROUGH"])
PACE = 0.4  # seconds for Blender to handle the events of a step
facts = {}


def main():
    """Start the steps. Who calls this would take a picture and quit after a few of its own: now the walk does that."""
    caller = inspect.currentframe().f_back.f_globals
    if "steps" in caller:
        caller["steps"] = itertools.repeat("redraw")
    steps = walk()
    bpy.app.timers.register(lambda: advance(steps), first_interval=PACE)


def advance(steps):
    try:
        next(steps)
        return PACE
    except StopIteration:
        pass
    except Exception:
        facts["error"] = traceback.format_exc()
    OUT.write_text(json.dumps(facts))
    os._exit(0)


def walk():
    """What a user does; each yield gives Blender time."""
    remove(*bpy.data.objects)
    bpy.context.preferences.view.smooth_view = 0
    (name,) = [name for name in bpy.context.preferences.addons.keys() if name.endswith(".tessera")]
    bpy.context.preferences.addons[name].preferences.defaults.smooth = 2
    words = text("DO 8")
    look(words)
    bpy.ops.ed.undo_push(message="text")
    yield from search("mesh curve by")
    yield from until(meshes)
    facts["searched"] = meshes()
    last = bpy.context.window_manager.operators[-1]
    facts["length shown"], facts["operator"] = last.properties.edge_length, last.bl_idname
    facts["preferred"] = last.properties.smooth
    press("F9")
    yield
    yield
    picture("adjust")
    press("ESC")
    yield
    key("Z", ctrl=True)
    yield from until(lambda: not meshes())
    facts["undone"] = sorted(obj.name for obj in bpy.data.objects)
    yield from search("mesh curve by")
    yield from until(meshes)
    last = bpy.context.window_manager.operators[-1]
    last.properties.edge_length *= 2
    in_view(bpy.ops.ed.undo_redo)  # what Adjust Last Operation does after a change
    yield
    facts["adjusted"] = meshes()
    remove(bpy.data.objects["Words Mesh"])
    select("Words")
    in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True)
    yield from until(meshes)
    facts["length next time"] = bpy.context.window_manager.operators[-1].properties.edge_length
    yield from cancelling()
    yield from failing()
    yield from linking()


def remove(*objects):
    for obj in objects:
        bpy.data.objects.remove(obj)


def cancelling():
    remove(bpy.data.objects["Words Mesh"])
    select("Words")
    before = saved()
    facts["started"] = sorted(in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True, edge_length=0.002))
    yield
    picture("progress")
    yield
    press("ESC")
    yield
    facts["cancelled"] = meshes(), saved() == before


def failing():
    data = bpy.data.curves.new("Bow tie", "CURVE")
    spline = data.splines.new("POLY")
    spline.points.add(3)
    for point, (x, y) in zip(spline.points, [(0, 1), (1, 2), (1, 1), (0, 2)], strict=True):
        point.co = (x, y, 0, 1)
    spline.use_cyclic_u = True
    bpy.context.collection.objects.link(bpy.data.objects.new("Bow tie", data))
    select("Bow tie")
    before = saved()
    move()
    yield
    in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True)
    yield
    move(1)
    yield
    picture("failure")
    facts["failed"] = meshes(), saved() == before
    press("LEFTMOUSE", 1)  # the popup opens with its button under the mouse
    yield
    facts["place"] = bpy.context.mode, [point.select for point in data.splines[0].points]
    in_view(bpy.ops.object.mode_set, mode="OBJECT")
    yield


def linking():
    select("Words")
    in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True, edge_length=0.06, keep_linked=True)
    yield from until(meshes)
    yield
    mesh, words = bpy.context.object, bpy.data.objects["Words"]
    mesh.tessera.automatic = True
    words.data.body = "AB"
    yield
    yield
    facts["followed"] = meshes(), round(max(vertex.co.x for vertex in mesh.data.vertices), 3), words.dimensions.x
    yield from until(lambda: mesh.data.tessera_made_of)  # not a draft, which stays out of date
    words.hide_set(True)
    mesh.select_set(False)
    area().spaces[0].show_region_ui = True
    bpy.context.window_manager.tessera_show_quality = True
    yield
    sidebar = next(region for region in area().regions if region.type == "UI")
    sidebar.active_panel_category = "Tessera"
    look(mesh)
    mesh.select_set(False)
    yield
    area().tag_redraw()
    yield
    picture("quality")


def text(body):
    data = bpy.data.curves.new("Words", "FONT")
    data.body = body
    obj = bpy.data.objects.new("Words", data)
    bpy.context.collection.objects.link(obj)
    return obj


def area():
    screen = bpy.context.window_manager.windows[0].screen
    return next(area for area in screen.areas if area.type == "VIEW_3D")


def in_view(function, *arguments, **more):
    """Call an operator as from the 3D view."""
    region = next(region for region in area().regions if region.type == "WINDOW")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=area(), region=region):
        return function(*arguments, **more)


def look(obj):
    select(obj.name)
    in_view(bpy.ops.view3d.view_axis, type="TOP")
    area().spaces[0].region_3d.view_perspective = "ORTHO"
    in_view(bpy.ops.view3d.view_selected)


def select(name):
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.name == name)
    bpy.context.view_layer.objects.active = bpy.data.objects[name]


def simulate(kind, value, aside=0, **more):
    here = {"x": area().x + area().width // 3 + aside, "y": area().y + area().height // 2}
    bpy.context.window_manager.windows[0].event_simulate(type=kind, value=value, **here, **more)


def move(aside=0):
    simulate("MOUSEMOVE", "NOTHING", aside)


def press(kind, aside=0):
    simulate(kind, "PRESS", aside)
    simulate(kind, "RELEASE", aside)


def key(kind, **held):
    simulate(kind, "PRESS", **held)
    simulate(kind, "RELEASE", **held)


def search(words):
    """As with F3: type, and take the first that is found."""
    move()
    yield
    press("F3")
    yield
    for letter in words:
        kind = letter.upper() if letter != " " else "SPACE"
        simulate(kind, "PRESS", unicode=letter)
        simulate(kind, "RELEASE")
    yield
    yield
    picture("search")
    press("RET")
    yield


def until(condition):
    """Wait, for half a minute at most."""
    for _ in range(round(30 / PACE)):
        yield
        if condition():
            return
    raise TimeoutError(inspect.getsource(condition))


def meshes():
    """The number of triangles of each mesh object, by name."""
    return {obj.name: len(obj.data.polygons) for obj in bpy.data.objects if obj.type == "MESH"}


def saved():
    """What would be saved of the objects: names, modes, selection and all control points."""
    return [
        (obj.name, obj.type, obj.select_get(), obj.mode, tuple(map(tuple, obj.matrix_world)))
        for obj in bpy.data.objects
    ]


def picture(name):
    subprocess.run(["import", "-window", "root", str(OUT.with_name(f"{name}.png"))], check=True)
