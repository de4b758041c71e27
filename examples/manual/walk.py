"""Run in Blender's window by ``python -m examples.manual``: what each page of the manual shows, in order.

The folder of the pictures is named by MANUAL_PICTURES. Blender must have been started with --enable-event-simulate and
--python-use-system-env, and the extension be installed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import bpy

from examples.manual import shapes
from examples.manual.window import (
    add,
    called_from,
    choose_tab,
    empty_scene,
    in_view,
    look_down,
    move,
    picture,
    press,
    remember,
    select,
    sidebar,
    take,
    until,
    view,
)

OUT = Path(os.environ["MANUAL_PICTURES"])


def main() -> None:
    """Take the walk."""
    take(walk(), called_from())


def walk() -> Iterator[None]:
    """Each yield gives Blender time."""
    for page in (text, logo, cloth, airfoil, faces, cancelling, failing):
        empty_scene()
        yield
        yield from page()


def meshes() -> list[bpy.types.Object]:
    """The mesh objects that are there."""
    return [obj for obj in bpy.data.objects if obj.type == "MESH"]


def mesh(sources: list[bpy.types.Object], **settings) -> Iterator[None]:
    """Mesh with the operator, as from a menu, all settings that are not named at their defaults.

    Then the sources are hidden, so that nothing is seen twice, and the edges of the meshes shown.
    """
    select(*sources)
    remember("Select")
    before = len(meshes())
    in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True, **defaults() | settings)
    yield from until(lambda: len(meshes()) > before)
    for obj in sources:
        obj.hide_set(True)
    for obj in meshes():
        obj.show_wire = obj.show_all_edges = True
        obj.select_set(False)


def defaults() -> dict:
    """The operator's own settings, which would else be those of its last use."""
    properties = bpy.ops.tessera.mesh_curve.get_rna_type().properties
    return {each.identifier: each.default for each in properties if each.identifier != "rna_type"}


def redraw() -> Iterator[None]:
    """Give Blender two steps and have all drawn anew."""
    for _ in range(2):
        for each in bpy.context.window_manager.windows[0].screen.areas:
            each.tag_redraw()
        yield


def text() -> Iterator[None]:
    """A menu, and Adjust Last Operation."""
    words = shapes.words("DO 8")
    look_down([words], 0.5, 0.2)
    move(0.3, 0.92)
    yield
    in_view(bpy.ops.wm.call_menu, name="VIEW3D_MT_object_convert")
    yield
    move(0.24, 0.8)
    yield
    move(0.25, 0.797)
    yield from redraw()
    yield from redraw()
    picture(OUT / "menu.png")
    press("ESC", 0.3, 0.8)
    yield
    yield from mesh([words])
    yield from redraw()
    move(0.68, 0.5)
    yield
    press("F9", 0.68, 0.5)
    yield from redraw()
    picture(OUT / "text.png", (0, 25, 1320, 875))
    picture(OUT.parent / "window.png", (0, 0, 1600, 900), 1280)
    press("ESC", 0.68, 0.5)
    yield


def logo() -> Iterator[None]:
    """An imported SVG, in the colours of its materials."""
    curves = shapes.logo()
    sidebar(True)
    yield
    choose_tab()
    look_down(curves, 0.85, 0.08)
    yield from mesh(curves, edge_length=0.07)
    view().shading.color_type = "MATERIAL"
    yield from redraw()
    picture(OUT / "logo.png")
    view().shading.color_type = "TEXTURE"


def cloth() -> Iterator[None]:
    """Two pieces of a pattern, kept linked, with the sidebar; then one of them after a change of its curve."""
    pieces = [shapes.bodice(), shapes.sleeve()]
    sidebar(True)
    yield
    choose_tab()
    look_down(pieces, 0.65, 0.1)
    yield from mesh(pieces, edge_length=0.02, keep_linked=True)
    linked = {obj.tessera.source.name: obj for obj in meshes()}
    bpy.context.view_layer.objects.active = linked["Front"]
    linked["Front"].tessera.automatic = True
    yield from redraw()
    picture(OUT / "cloth.png")
    pieces[0].hide_set(False)
    curve = pieces[0].data
    for point in curve.splines[0].bezier_points[1:3]:
        for name in ("co", "handle_left", "handle_right"):
            setattr(point, name, getattr(point, name) + type(point.co)((0.05, 0.0, 0.0)))
    curve.update_tag()
    before = linked["Front"].tessera.n_triangles
    yield from until(lambda: linked["Front"].tessera.n_triangles != before)
    yield from redraw()
    picture(OUT / "cloth_followed.png")


def airfoil() -> Iterator[None]:
    """A channel around an airfoil, smaller triangles along it, coloured by quality."""
    channel = shapes.around_the_airfoil()
    sidebar(True)
    yield
    choose_tab()
    look_down([channel], 0.7, 0.1)
    yield from mesh(
        [channel],
        edge_length=0.16,
        use_curvature=True,
        use_object=True,
        object_name=_along_the_airfoil(),
        object_length=0.02,
        gradation=1.2,
    )
    bpy.context.window_manager.tessera_show_quality = True
    yield from redraw()
    picture(OUT / "airfoil.png")


def _along_the_airfoil() -> str:
    """The name of a curve that lies where the airfoil is, and is not seen."""
    channel = bpy.data.objects["Channel"]
    near = add("Airfoil", channel.data.copy())
    near.data.splines.remove(near.data.splines[0])
    near.hide_set(True)
    return near.name


def faces() -> Iterator[None]:
    """The n-gon of a mesh's top, in Edit Mode."""
    bracket = shapes.bracket()
    look_down([bracket], 0.7)
    in_view(bpy.ops.view3d.view_axis, type="FRONT")
    in_view(bpy.ops.view3d.view_orbit, type="ORBITUP", angle=0.9)
    in_view(bpy.ops.view3d.view_orbit, type="ORBITLEFT", angle=0.5)
    in_view(bpy.ops.object.mode_set, mode="EDIT")
    in_view(bpy.ops.mesh.select_mode, type="FACE")
    in_view(bpy.ops.mesh.select_all, action="DESELECT")
    in_view(bpy.ops.object.mode_set, mode="OBJECT")
    next(face for face in bracket.data.polygons if face.normal.z > 0.9).select = True
    in_view(bpy.ops.object.mode_set, mode="EDIT")
    remember("Select")
    yield
    in_view(bpy.ops.tessera.remesh_faces, "INVOKE_DEFAULT", True, edge_length=0.15)
    yield from redraw()
    picture(OUT / "faces.png")


def cancelling() -> Iterator[None]:
    """Long work: its progress in the status bar."""
    words = shapes.words("DO 8")
    look_down([words], 0.5)
    in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True, **defaults() | {"edge_length": 0.002})
    yield
    yield
    picture(OUT / "progress.png", (0, 875, 600, 25), 600)
    press("ESC")
    yield


def failing() -> Iterator[None]:
    """A curve that crosses itself: the popup, and the point that its button selects."""
    tie = shapes.bow_tie()
    look_down([tie], 0.4, -0.1)
    move(0.2, 0.85)
    yield
    in_view(bpy.ops.tessera.mesh_curve, "INVOKE_DEFAULT", True, **defaults())
    yield
    move(0.201, 0.85)
    yield from redraw()
    picture(OUT / "failure.png")
    press("ESC", 0.2, 0.85)
    yield
