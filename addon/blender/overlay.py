"""The overlay of the 3D view that colours triangles by their quality."""

from __future__ import annotations

import bpy
import gpu
import numpy as np
from bpy.app.handlers import persistent
from gpu_extras.batch import batch_for_shader

ATTRIBUTE = "element_quality"
# From poor to even, at these qualities; the same colours as in the documentation's pictures.
_AT = (0.4, 0.55, 0.7, 0.85, 1.0)
_COLOURS = ((0.85, 0.39, 0.29), (0.95, 0.76, 0.50), (0.96, 0.93, 0.80), (0.75, 0.88, 0.82), (0.50, 0.77, 0.74))
_OPACITY = 0.85
_FORWARD = 2e-5  # of the depth, so that the overlay lies in front of the faces

_batches: dict[str, gpu.types.GPUBatch] = {}
_handle = None


def colours(quality: np.ndarray) -> np.ndarray:
    """(m, 4) float32, red, green, blue and opacity of elements of quality (m,)."""
    channels = [np.interp(quality, _AT, channel) for channel in zip(*_COLOURS, strict=True)]
    return np.column_stack([*channels, np.full(len(quality), _OPACITY)]).astype(np.float32)


def draw_legend(layout: bpy.types.UILayout) -> None:
    """What the colours mean, in words: the panel has no colours of its own to show."""
    layout.label(text=f"From red, {_AT[0]:g} or less, to blue-green, {_AT[-1]:g}")


def coloured_triangles(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray] | None:
    """Corners (3 k, 3) of the triangles of a mesh, and a colour (3 k, 4) for each; None without a quality."""
    attribute = mesh.attributes.get(ATTRIBUTE)
    if attribute is None or attribute.domain != "FACE" or attribute.data_type != "FLOAT" or not len(attribute.data):
        return None
    quality = np.empty(len(mesh.polygons), dtype=np.float32)
    attribute.data.foreach_get("value", quality)
    points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    mesh.calc_loop_triangles()
    corners = np.empty((len(mesh.loop_triangles), 3), dtype=np.int32)
    polygons = np.empty(len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners.ravel())
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    return points[corners.ravel()], np.repeat(colours(quality[polygons]), 3, axis=0)


def _draw() -> None:
    context = bpy.context
    if not context.window_manager.tessera_show_quality or not context.space_data.overlay.show_overlays:
        return
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.blend_set("ALPHA")
    shader = gpu.shader.from_builtin("FLAT_COLOR")
    depsgraph = context.evaluated_depsgraph_get()
    with gpu.matrix.push_pop_projection():
        projection = gpu.matrix.get_projection_matrix()
        projection[2] -= _FORWARD * projection[3]
        gpu.matrix.load_projection_matrix(projection)
        for obj in context.visible_objects:
            batch = _batch(obj, shader, depsgraph) if obj.type == "MESH" and obj.mode == "OBJECT" else None
            if batch is not None:
                with gpu.matrix.push_pop():
                    gpu.matrix.multiply_matrix(obj.matrix_world)
                    batch.draw(shader)
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")


def _batch(obj: bpy.types.Object, shader: gpu.types.GPUShader, depsgraph: bpy.types.Depsgraph):
    """What is drawn of an object, kept until it changes; None without a quality."""
    key = obj.name_full  # a library may have an object of the same name
    if key not in _batches:
        made = coloured_triangles(obj.evaluated_get(depsgraph).data)
        _batches[key] = made and batch_for_shader(shader, "TRIS", {"pos": made[0], "color": made[1]})
    return _batches[key]


@persistent
def _forget_changed(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    for update in depsgraph.updates:
        if update.is_updated_geometry:
            _batches.pop(update.id.name_full, None)


@persistent
def _forget_all(*_) -> None:
    _batches.clear()


def _redraw(_manager, context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _handlers() -> tuple:
    handlers = bpy.app.handlers
    return (
        (handlers.depsgraph_update_post, _forget_changed),
        *((each, _forget_all) for each in (handlers.load_post, handlers.undo_post, handlers.redo_post)),
    )


def register() -> None:
    """Draw in all 3D views, once it is switched on."""
    global _handle
    bpy.types.WindowManager.tessera_show_quality = bpy.props.BoolProperty(
        name="Colour by Quality",
        description="Colour the triangles of all meshes that Tessera has made by their quality, from red (poor) to "
        "blue-green (equilateral), in all 3D views",
        options={"SKIP_SAVE"},
        update=_redraw,
    )
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")
    for handlers, function in _handlers():
        handlers.append(function)


def unregister() -> None:
    """Draw no more."""
    global _handle
    for handlers, function in _handlers():
        handlers.remove(function)
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None
    _batches.clear()
    del bpy.types.WindowManager.tessera_show_quality
