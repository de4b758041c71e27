"""Menus, sidebar, preferences and overlay, as far as they are there without a window; test_window.py looks at them."""

import sys
from dataclasses import fields
from itertools import pairwise

import bpy
import numpy as np
import pytest

from addon.blender import overlay, preferences
from addon.blender.linked import BINS
from addon.blender.settings import Settings, table
from addon.tessera.quality import element_quality
from tests.blender.drawing import SQUARE, circle, poly_curve, select, text, triangles, vertices


class Layout:
    """Takes what a panel or menu draws, and lists it; everything in it is a layout as well."""

    def __init__(self, log=None):
        self.log = [] if log is None else log

    def __getattr__(self, kind):
        def draw(*words, **more):
            inner = Layout(self.log)
            inner.kind, inner.words, inner.more = kind, words, more
            self.log.append(inner)
            return inner

        return draw

    def named(self, kind):
        return [inner for inner in self.log if inner.kind == kind]


def drawn(cls, **context):
    """What a panel draws in the context."""
    panel = type("Panel", (), {"layout": Layout()})()
    cls.draw(panel, bpy.context)
    return panel.layout


@pytest.mark.parametrize(
    ("menu", "operator"),
    [
        ("VIEW3D_MT_object_convert", "tessera.mesh_curve"),
        ("VIEW3D_MT_object_context_menu", "tessera.mesh_curve"),
        ("VIEW3D_MT_edit_curve", "tessera.mesh_curve"),
        ("VIEW3D_MT_edit_font", "tessera.mesh_curve"),
        ("VIEW3D_MT_edit_curves", "tessera.mesh_curve"),
        ("VIEW3D_MT_edit_greasepencil", "tessera.mesh_curve"),
        ("VIEW3D_MT_edit_mesh_faces", "tessera.remesh_faces"),
    ],
)
def test_menus_have_the_operators_by_the_words_that_users_search_for(menu, operator):
    circle()
    ours = [f for f in getattr(bpy.types, menu).draw._draw_funcs if f.__module__.startswith("addon.")]
    (draw,) = ours
    holder = type("Menu", (), {"layout": Layout()})()
    draw(holder, bpy.context)
    (entry,) = holder.layout.named("operator")
    assert entry.words == (operator,)
    words = {"triangulate", "remesh"} | ({"mesh curve"} if operator.endswith("curve") else set())
    assert all(word in entry.more["text"].lower() for word in words)


@pytest.mark.parametrize("menu", ["VIEW3D_MT_object_convert", "VIEW3D_MT_object_context_menu"])
def test_the_menus_ask_what_is_selected_and_not_what_is_active(menu):
    (draw,) = [f for f in getattr(bpy.types, menu).draw._draw_funcs if f.__module__.startswith("addon.")]

    def is_there():
        holder = type("Menu", (), {"layout": Layout()})()
        draw(holder, bpy.context)
        return bool(holder.layout.named("operator"))

    curve = circle()
    for active in (curve, None):  # None: after Select Objects in the Outliner
        bpy.context.view_layer.objects.active = active
        assert is_there()
    bpy.ops.object.camera_add()
    assert not is_there() or menu == "VIEW3D_MT_object_convert"  # which search looks through
    curve.select_set(True)
    assert is_there()


def test_the_sidebar_has_the_numbers_of_the_mesh():
    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.2)
    made = bpy.context.object
    quality = element_quality(vertices(made)[:, :2], triangles(made))
    labels = [label.more["text"] for label in drawn(bpy.types.TESSERA_PT_mesh).named("label")]
    facts = dict(pairwise(labels))
    assert facts["Triangles"] == f"{len(quality):,}"
    assert float(facts["Worst quality"]) == pytest.approx(quality.min(), abs=6e-4)
    assert float(facts["Mean quality"]) == pytest.approx(quality.mean(), abs=6e-4)
    bars = drawn(bpy.types.TESSERA_PT_mesh).named("progress")
    assert [bar.more["factor"] for bar in bars] == pytest.approx(
        np.histogram(quality, BINS)[0] / len(quality), abs=1.5 / len(quality)
    )
    corners = vertices(made)[triangles(made)]
    lengths = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert made.tessera.edge_lengths[0] == pytest.approx(lengths.min(), rel=1e-4)
    assert made.tessera.edge_lengths[2] == pytest.approx(lengths.max(), rel=1e-4)


def test_linked_meshes_and_failures_have_panels():
    broken = poly_curve(((0, 0), (1, 1), (1, 0), (0, 1)), name="Broken")
    good = poly_curve(SQUARE, name="Good")
    select(good, broken)
    bpy.ops.tessera.mesh_curve(edge_length=0.3, keep_linked=True)
    linked, failures = bpy.types.TESSERA_PT_linked, bpy.types.TESSERA_PT_failures
    assert linked.poll(bpy.context) and failures.poll(bpy.context)
    shown = [inner.words for inner in drawn(linked).named("operator")]
    assert shown == [("tessera.mesh_again",), ("tessera.unlink",)]
    said = " ".join(label.more["text"] for label in drawn(failures).named("label"))
    assert "Curve 'Broken', spline 1 crosses or touches itself near (0.5, 0.5, 0)" in said
    (button,) = drawn(failures).named("operator")
    assert (button.words, button.object_name, button.spline) == (("tessera.select_place",), "Broken", 1)
    select(good)
    assert not linked.poll(bpy.context)
    bpy.data.objects.remove(broken)
    assert not failures.poll(bpy.context)


def test_what_cannot_be_selected_is_shown():
    select(text("a"))
    with pytest.raises(RuntimeError, match=r"Text 'Text': .*triangles.*a larger Shortest Edge"):
        bpy.ops.tessera.mesh_curve(edge_length=0.1, use_distance=True, distance_length=1e-9)
    buttons = drawn(bpy.types.TESSERA_PT_failures).named("operator")
    assert [button.more["text"] for button in buttons] == ["Show the Place"]


def test_the_sidebar_says_that_a_mesh_was_edited():
    def labels():
        return [label.more["text"] for label in drawn(bpy.types.TESSERA_PT_mesh).named("label")]

    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.2)
    assert not any("Edited" in label for label in labels())
    bpy.context.object.data.vertices[3].co.z += 1
    assert any("Edited since it was meshed" in label for label in labels())


def test_another_file_has_no_failures_yet(tmp_path):
    poly_curve(SQUARE, name="Broken")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    bpy.data.objects["Broken"].data.splines[0].points[0].co.x = 3.0
    with pytest.raises(RuntimeError):
        bpy.ops.tessera.mesh_curve()
    failures = bpy.types.TESSERA_PT_failures
    assert failures.poll(bpy.context)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "other.blend"))
    assert not failures.poll(bpy.context)


def test_settings_that_have_no_effect_are_greyed_out():
    from addon.blender.layout import draw_settings

    for changed, active in (({}, False), ({"use_thickness": True}, True)):
        owner = type("Owner", (), {each.name: each.default for each in fields(Settings)} | changed)()
        layout = Layout()
        draw_settings(layout, owner)
        rows = {prop.words[1]: row for row, prop in pairwise(layout.log) if prop.kind == "prop"}
        assert rows["thickness_elements"].active == active and rows["gradation"].active == active
        assert rows["edge_length"].active and not rows["triangle_count"].active
        assert set(rows) | {"object_name"} >= set(table())


@pytest.fixture
def enabled():
    """The add-on's preferences, as when it is enabled."""
    addon = bpy.context.preferences.addons.new()
    addon.module = preferences.PACKAGE
    yield addon.preferences
    bpy.context.preferences.addons.remove(addon)


def test_preferences_say_where_results_go_and_how_the_networks_run(enabled):
    from addon.tessera import networks

    enabled.collection, enabled.threads = "Meshes", 2
    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.4)
    assert [each.name for each in bpy.context.object.users_collection] == ["Meshes"]
    assert networks.session("nn1").get_session_options().intra_op_num_threads == 2
    enabled.threads = 1
    select(bpy.data.objects["Circle"])
    bpy.ops.tessera.mesh_curve(edge_length=0.4)
    assert networks.session("nn1").get_session_options().intra_op_num_threads == 1
    assert len(bpy.data.collections["Meshes"].objects) == 2


def test_a_script_does_not_depend_on_the_preferences(enabled):
    enabled.defaults.boundary = "KEEP"
    assert preferences.default_settings().boundary == "KEEP"
    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.4)
    by_script = len(bpy.context.object.data.polygons)
    select(bpy.data.objects["Circle"])
    bpy.ops.tessera.mesh_curve(edge_length=0.4, boundary="KEEP")
    assert len(bpy.context.object.data.polygons) > 1.2 * by_script


def test_the_overlay_has_a_colour_for_each_triangle_by_its_quality():
    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.3)
    made = bpy.context.object
    made.modifiers.new("Thick", "SOLIDIFY")  # what modifiers make is coloured like what they make it of
    mesh = made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    corners, colours = overlay.coloured_triangles(mesh)
    assert len(corners) == len(colours) > 3 * 2 * len(made.data.polygons)
    best, worst = overlay.colours(np.array([1.0, 0.1]))
    assert best[1] > best[0] and worst[0] > worst[1]
    quality = np.repeat(element_quality(vertices(made)[:, :2], triangles(made)), 3)
    plain = overlay.coloured_triangles(made.data)
    assert np.allclose(plain[1], overlay.colours(quality), atol=1e-3)


def test_a_librarys_mesh_has_an_overlay_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(overlay, "batch_for_shader", lambda _shader, _kind, content: len(content["pos"]))
    circle()
    bpy.ops.tessera.mesh_curve(edge_length=0.3)
    own = bpy.context.object
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {own})
    bpy.ops.tessera.mesh_curve(edge_length=0.1, result="REPLACE")
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, to):
        to.objects = [own.name]
    bpy.context.scene.collection.objects.link(to.objects[0])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for obj in (own, to.objects[0]):
        assert overlay._batch(obj, None, depsgraph) == 3 * len(obj.data.polygons)


def test_a_broken_onnxruntime_offers_no_providers(monkeypatch):
    assert "CPUExecutionProvider" in preferences._providers(None, None, "cpu")
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    assert preferences._providers(None, None, "cpu") == []


def test_a_mesh_of_another_kind_has_no_overlay():
    bpy.ops.mesh.primitive_cube_add()
    assert overlay.coloured_triangles(bpy.context.object.data) is None
