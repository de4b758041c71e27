"""Run inside Blender's window with the extension installed: mesh a text, and open Adjust Last Operation.

`main` is called once the window is drawn, and a picture of the screen taken afterwards; Blender must have been started
with --enable-event-simulate.
"""

import bpy


def main() -> None:
    """Put a text into the empty scene, look at it from the top, mesh it, and press F9 below it."""
    bpy.context.preferences.view.smooth_view = 0
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    view = area.spaces[0]
    with bpy.context.temp_override(window=window, area=area, region=region):
        for obj in list(bpy.data.objects):
            bpy.data.objects.remove(obj)
        data = bpy.data.curves.new("Words", "FONT")
        data.body = "DO MESH"
        words = bpy.data.objects.new("Words", data)
        bpy.context.collection.objects.link(words)
        bpy.context.view_layer.objects.active = words
        words.select_set(True)
        bpy.ops.view3d.view_axis(type="TOP")
        view.region_3d.view_perspective = "ORTHO"
        bpy.ops.view3d.view_selected()
        view.region_3d.view_distance *= 0.5
        bpy.ops.ed.undo_push(message="Add Text")  # what Adjust Last Operation goes back to
        bpy.ops.tessera.mesh_curve("EXEC_DEFAULT", True)
        words.hide_set(True)
        bpy.context.object.show_wire = bpy.context.object.show_all_edges = True
        bpy.context.object.select_set(False)
    middle = {"x": area.x + area.width // 2, "y": area.y + area.height // 4}
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", **middle)
    window.event_simulate(type="F9", value="PRESS", **middle)
    window.event_simulate(type="F9", value="RELEASE", **middle)
