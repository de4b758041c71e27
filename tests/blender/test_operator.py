"""The operators' ways: F9, undo, cancelling, batches, failures that change nothing, and what settings do."""

from unittest.mock import Mock

import bpy
import numpy as np
import pytest

from addon import tessera
from addon.blender import notes
from addon.blender.operators.stepping import Stepping
from addon.blender.settings import Settings
from addon.tessera.quality import element_quality
from tests.blender.drawing import SQUARE, circle, poly_curve, select, star, text, triangles, vertices
from tests.blender.sources import grease_pencil, hair_curves

BOW_TIE = ((0, 0), (1, 1), (1, 0), (0, 1))


def run(**settings):
    """The new objects."""
    before = set(bpy.data.objects)
    assert bpy.ops.tessera.mesh_curve(**settings) == {"FINISHED"}
    return sorted(set(bpy.data.objects) - before, key=lambda obj: obj.name)


def lengths_at(obj, chosen):
    """The mean length of the edges of the triangles whose centre is chosen."""
    points, tris = vertices(obj), triangles(obj)
    corners = points[tris[chosen(points[tris].mean(axis=1))]]
    assert len(corners)
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()


# -- F9 and undo --


def step_back():
    """As Adjust Last Operation does before it runs an operator again."""
    bpy.ops.ed.undo_push(message="mesh")
    bpy.ops.ed.undo()


def test_undo_is_one_step():
    circle()
    bpy.ops.ed.undo_push(message="circle")
    run(edge_length=0.3)
    step_back()
    assert [obj.name for obj in bpy.data.objects] == ["Circle"]


@pytest.mark.parametrize(
    ("first", "changed", "more"),
    [
        ({"edge_length": 0.4}, {"edge_length": 0.2}, 4),
        ({"size_by": "TRIANGLE_COUNT", "triangle_count": 100}, {"triangle_count": 500}, 5),
        ({"edge_length": 0.4}, {"use_distance": True, "distance_length": 0.1}, 6),
    ],
)
def test_run_change_a_property_run_again(first, changed, more):
    circle()
    bpy.ops.ed.undo_push(message="circle")
    n_first = len(run(**first)[0].data.polygons)
    step_back()
    select(bpy.data.objects["Circle"])
    (made,) = run(**first | changed)
    assert len(bpy.data.objects) == 2
    assert 0.5 * more < len(made.data.polygons) / n_first < 2 * more


def test_the_operator_can_be_adjusted_once_the_new_mesh_is_selected():
    curve = circle()
    run(edge_length=0.4)
    assert not curve.select_get() and bpy.ops.tessera.mesh_curve.poll()
    bpy.ops.object.mode_set(mode="EDIT")  # of the mesh
    assert not bpy.ops.tessera.mesh_curve.poll() and bpy.ops.tessera.remesh_faces.poll()


def test_a_curve_in_edit_mode_is_meshed_as_it_is_and_undone_in_one_step():
    curve = poly_curve(SQUARE, name="Square")
    bpy.ops.ed.undo_push(message="square")
    bpy.ops.object.mode_set(mode="EDIT")
    curve.data.splines[0].points[0].co.x = -1.0
    bpy.ops.ed.undo_push(message="moved")
    (made,) = run(edge_length=0.2)
    assert bpy.context.mode == "OBJECT" and bpy.context.object == made
    assert vertices(made)[:, 0].min() == -1.0
    step_back()
    assert [obj.name for obj in bpy.data.objects] == ["Square"]


# -- settings --


@pytest.mark.parametrize("wanted", [60, 700])
def test_a_triangle_count_is_met_for_each_object(wanted):
    select(poly_curve(star(), name="Star"), circle(radius=20.0))
    for made in run(size_by="TRIANGLE_COUNT", triangle_count=wanted):
        assert abs(len(made.data.polygons) / wanted - 1) <= 0.1


def test_an_edge_length_of_0_is_by_the_size_of_each_object():
    small, large = circle(radius=0.01, name="A"), circle(radius=300.0, name="B")
    select(small, large)
    first, second = run()
    assert 500 < len(first.data.polygons) < 3000
    assert abs(len(first.data.polygons) / len(second.data.polygons) - 1) < 0.1


def test_curvature_distance_and_thickness_make_smaller_triangles_where_they_should():
    poly_curve(SQUARE, (np.array(SQUARE) * 0.2 + (0.4, 0.7)).tolist())  # a hole near the upper side
    plain = lengths_at(run(edge_length=0.15)[0], lambda c: c[:, 1] > 0.9)
    select(bpy.data.objects["Outline"])
    thin = lengths_at(run(edge_length=0.15, use_thickness=True, thickness_elements=4)[0], lambda c: c[:, 1] > 0.9)
    assert thin < 0.6 * plain
    select(bpy.data.objects["Outline"])
    (made,) = run(edge_length=0.15, use_distance=True, distance_length=0.02)
    assert lengths_at(made, lambda c: c[:, 1] < 0.02) < 0.4 * lengths_at(
        made, lambda c: np.abs(c[:, :2] - (0.5, 0.35)).max(axis=1) < 0.1
    )
    circle(radius=1.0)
    (made,) = run(edge_length=0.5, use_curvature=True, curvature_ratio=0.1)
    assert lengths_at(made, lambda c: np.linalg.norm(c, axis=1) > 0.95) == pytest.approx(0.1, rel=0.3)


def stroke(*points):
    """A mesh of edges in a row, a little above the outline's plane."""
    mesh = bpy.data.meshes.new("Stroke")
    mesh.from_pydata([(*point, 0.3) for point in points], [(i, i + 1) for i in range(len(points) - 1)], [])
    return mesh


@pytest.mark.parametrize("kind", ["empty", "mesh", "strokes", "curves"])
def test_triangles_are_smaller_near_an_object(kind):
    curve = poly_curve(SQUARE)
    if kind in ("strokes", "curves"):
        make = grease_pencil if kind == "strokes" else hair_curves
        near = make(np.column_stack([np.zeros(9), np.linspace(0, 0.8, 9), np.zeros(9)]), cyclic=False)
        near.name = "Near"
    else:
        near = bpy.data.objects.new("Near", None if kind == "empty" else stroke((0, 0), (0, 0.8)))
        bpy.context.scene.collection.objects.link(near)
    near.location = (0.2, 0.1, 2.0)
    select(curve)
    (made,) = run(edge_length=0.2, use_object=True, object_name="Near", object_length=0.02)
    around = lengths_at(made, lambda c: np.linalg.norm(c[:, :2] - (0.2, 0.1), axis=1) < 0.05)
    along = lengths_at(made, lambda c: np.linalg.norm(c[:, :2] - (0.2, 0.6), axis=1) < 0.1)
    far = lengths_at(made, lambda c: c[:, 0] > 0.8)
    assert around < 0.035 and far > 0.1
    assert (along < 0.04) == (kind != "empty")


def test_triangles_are_smaller_where_control_points_weigh_more():
    curve = poly_curve(SQUARE)
    for point, weight in zip(curve.data.splines[0].points, (0.0, 0.0, 1.0, 1.0), strict=True):
        point.weight_softbody = weight
    (made,) = run(edge_length=0.2, use_weight=True, weight_name="weight", weight_length=0.03)
    assert lengths_at(made, lambda c: c[:, 1] > 0.95) < 0.05
    assert lengths_at(made, lambda c: c[:, 1] < 0.1) > 0.1


def test_triangles_are_smaller_where_a_vertex_group_of_a_mesh_is_painted():
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=10, y_subdivisions=10, size=2)
    flat = bpy.context.object
    group = flat.vertex_groups.new(name="Fine")
    group.add([vertex.index for vertex in flat.data.vertices if vertex.co.x > 0.5], 1.0, "REPLACE")
    settings = {"edge_length": 0.4, "use_weight": True, "weight_name": "Fine", "weight_length": 0.06}
    (made,) = run(**settings)
    assert lengths_at(made, lambda c: c[:, 0] > 0.7) < 0.09
    assert lengths_at(made, lambda c: c[:, 0] < -0.5) > 0.2
    select(flat)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    assert bpy.ops.tessera.remesh_faces(**settings) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert lengths_at(flat, lambda c: (c[:, 0] > 0.7) & (abs(c[:, 1]) < 0.8)) < 0.12


def test_names_that_are_not_there_are_one_clear_report():
    poly_curve(SQUARE, name="Square")
    with pytest.raises(RuntimeError, match=r"Curve 'Square': .*none named 'Nobody'\. Choose one"):
        bpy.ops.tessera.mesh_curve(use_object=True, object_name="Nobody")
    with pytest.raises(RuntimeError, match=r"no weights named 'x'; it has 'weight', 'radius', 'tilt'\. Choose one"):
        bpy.ops.tessera.mesh_curve(use_weight=True, weight_name="x")


def test_a_sizing_without_a_name_has_no_effect_yet_and_says_so(capfd):
    poly_curve(SQUARE, name="Square")
    plain, waiting = run(edge_length=0.4), run(edge_length=0.4, use_object=True, use_weight=True)
    assert len(waiting[0].data.polygons) == len(plain[0].data.polygons)
    said = capfd.readouterr()
    assert "By Object has no effect yet" in said.out + said.err and "By Weight has no effect yet" in said.out + said.err


def test_what_a_sizing_refers_to_and_is_no_number_is_one_clear_report():
    near = bpy.data.objects.new("Near", None)
    bpy.context.scene.collection.objects.link(near)
    near.location.y = float("nan")
    square = poly_curve(SQUARE, name="Square")
    square.data.splines[0].points[2].radius = float("nan")
    with pytest.raises(RuntimeError, match=r"^Error: Curve 'Square': .*'Near' .*not finite"):
        bpy.ops.tessera.mesh_curve(use_object=True, object_name="Near")
    with pytest.raises(RuntimeError, match=r"^Error: Curve 'Square': .*'radius' .*not a finite number"):
        bpy.ops.tessera.mesh_curve(use_weight=True, weight_name="radius")


def test_a_setting_that_is_no_number_is_one_clear_report():
    poly_curve(SQUARE, name="Square")
    with pytest.raises(RuntimeError, match=r"^Error: Curve 'Square': .*must be a positive number"):
        bpy.ops.tessera.mesh_curve(use_curvature=True, curvature_ratio=float("nan"))


@pytest.mark.parametrize("name", ["gradation", "corner_angle"])
def test_a_limit_that_is_no_number_is_one_clear_report(name):
    poly_curve(SQUARE, name="Square")
    with pytest.raises(RuntimeError, match=r"^Error: Curve 'Square': The .* is nan; it must be a number between 1"):
        bpy.ops.tessera.mesh_curve(**{name: float("nan")})


def test_smoothing_and_flips_better_the_triangles():
    poly_curve(star())
    mean = []
    for settings in ({}, {"flips": True, "smooth": 5}):
        select(bpy.data.objects["Outline"])
        (made,) = run(edge_length=0.12, **settings)
        mean.append(element_quality(vertices(made)[:, :2], triangles(made)).mean())
        assert made.tessera.q_mean == pytest.approx(mean[-1], abs=1e-4)
    assert mean[1] > mean[0] + 0.001


def test_results_in_place_and_joined():
    select(poly_curve(SQUARE, name="A"), poly_curve(np.array(SQUARE) + 2, name="B"))
    made = run(edge_length=0.3, result="JOIN")
    assert len(made) == 1 and bpy.context.selected_objects == made
    assert made[0].tessera.n_triangles == len(made[0].data.polygons)
    bpy.data.objects.remove(made[0])
    select(bpy.data.objects["A"], bpy.data.objects["B"])
    assert bpy.ops.tessera.mesh_curve(edge_length=0.3, result="REPLACE") == {"FINISHED"}
    assert sorted((obj.name, obj.type, obj.select_get()) for obj in bpy.data.objects) == [
        ("A", "MESH", True),
        ("B", "MESH", True),
    ]
    assert bpy.context.view_layer.objects.active.name == "A"


def test_warnings_name_the_object_also_where_it_is_replaced(capfd):
    poly_curve(SQUARE, name="Coarse")
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1, boundary="KEEP", result="REPLACE") == {"FINISHED"}
    assert "Coarse: 4 of the 4 kept boundary edges are longer" in capfd.readouterr().out


def test_a_warnings_place_is_in_the_world(capfd):
    curve = poly_curve(SQUARE, [(x + 1, y + 1) for x, y in SQUARE], name="Corners")
    curve.location, curve.scale = (10, 20, 30), (2, 2, 2)
    bpy.context.view_layer.update()
    assert bpy.ops.tessera.mesh_curve(edge_length=0.5) == {"FINISHED"}
    assert "Corners: contours touch at (12, 22, 30): " in capfd.readouterr().out


@pytest.mark.parametrize("kind", ["CURVE", "FONT", "CURVES", "GREASEPENCIL"])
def test_what_is_being_edited_is_meshed_as_it_is_there(kind):
    loop = np.column_stack([SQUARE, np.zeros(4)])
    draw = {
        "CURVE": lambda: poly_curve(SQUARE),
        "FONT": lambda: text("I"),
        "CURVES": lambda: hair_curves(loop),
        "GREASEPENCIL": lambda: grease_pencil(loop),
    }
    source = draw[kind]()
    bpy.ops.object.mode_set(mode="EDIT_GPENCIL" if source.type == "GPENCIL" else "EDIT")
    if kind == "FONT":
        bpy.ops.font.text_insert(text="II")
    assert bpy.ops.tessera.mesh_curve(edge_length=0.1) == {"FINISHED"}
    made = bpy.context.object
    assert bpy.context.mode == "OBJECT" and made.type == "MESH" and made != source
    points = vertices(made)[np.unique(triangles(made))]
    assert np.ptp(points[:, 0]) == pytest.approx(1.0) if kind != "FONT" else np.ptp(points[:, 0]) > 0.5


def test_flat_faces_are_remeshed_in_edit_mode_and_the_rest_stays():
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    top = next(polygon for polygon in cube.data.polygons if polygon.normal.z > 0.5)
    top.select = True
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.tessera.remesh_faces(edge_length=0.4) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    on_top = [polygon for polygon in cube.data.polygons if polygon.normal.z > 0.5]
    assert len(on_top) > 40 and all(polygon.loop_total == 3 for polygon in on_top)
    assert sum(polygon.area for polygon in cube.data.polygons) == pytest.approx(24.0, rel=1e-5)
    below = [polygon for polygon in cube.data.polygons if polygon.normal.z < -0.5]
    assert len(below) == 1 and below[0].loop_total == 4


# -- failures --


def saved(path):
    """What Blender would save now, four times over (4, n) uint8: in 4.2, each time with another pointer of its own."""
    files = []
    for _ in range(4):
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
        files.append(np.frombuffer(path.read_bytes(), dtype=np.uint8))
    return np.stack(files)


def unchanged(before, after):
    """Whether nothing differs but what every saving changes, which is next to nothing: a few pointers of 8 bytes."""
    if before.shape != after.shape:
        return False
    varies = (before != before[0]).any(axis=0) | (after != after[0]).any(axis=0)
    varies = np.convolve(varies, np.ones(15), mode="same") > 0
    assert np.count_nonzero(varies) < 200
    return bool((before[0] == after[0])[~varies].all())


@pytest.mark.parametrize(
    "settings", [{}, {"keep_linked": True}, {"result": "REPLACE"}, {"use_object": True, "object_name": "Nobody"}]
)
def test_a_failure_leaves_the_scene_byte_for_byte_as_it_was(tmp_path, settings):
    poly_curve(BOW_TIE, name="Broken")
    bpy.context.view_layer.update()
    before = saved(tmp_path / "scene.blend")
    with pytest.raises(RuntimeError):
        bpy.ops.tessera.mesh_curve(edge_length=0.2, **settings)
    assert unchanged(before, saved(tmp_path / "scene.blend"))
    bpy.data.objects["Broken"].location.x = 1
    assert not unchanged(before, saved(tmp_path / "scene.blend"))


def test_in_a_batch_the_others_go_on_and_a_summary_says_what_failed(capfd):
    good, broken = poly_curve(SQUARE, name="Good"), poly_curve(BOW_TIE, name="Broken")
    select(broken, good)
    (made,) = run(edge_length=0.2)
    assert made.name == "Good Mesh" and bpy.context.view_layer.objects.active == made
    assert broken.select_get() and not good.select_get()
    said = capfd.readouterr().out
    assert "1 of 2 objects were not meshed: 'Broken'" in said
    assert "Curve 'Broken', spline 1 crosses or touches itself near (0.5, 0.5, 0): move points" in said
    assert [noted.obj for noted in notes.last] == ["Broken"]


def test_the_point_of_a_failure_can_be_selected():
    curve = poly_curve(SQUARE, np.array(BOW_TIE) + (5, 0), name="Broken")
    curve.location = (0, 0, 3)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match=r"spline 2 crosses or touches itself near \(5.5, 0.5, 3\)"):
        bpy.ops.tessera.mesh_curve()
    (noted,) = notes.last
    bpy.ops.object.select_all(action="DESELECT")
    button = {"object_name": noted.obj, "spline": noted.spline, "place": noted.place}
    assert bpy.ops.tessera.select_place(**button) == {"FINISHED"}
    assert bpy.context.mode == "EDIT_CURVE" and bpy.context.object == curve
    selected = [[point.select for point in spline.points] for spline in curve.data.splines]
    assert sum(selected[0]) == 0 and sum(selected[1]) == 1
    assert tuple(bpy.context.scene.cursor.location) == pytest.approx((5.5, 0.5, 3))


@pytest.mark.parametrize("draw", [grease_pencil, hair_curves])
def test_the_point_of_a_strokes_failure_can_be_selected(draw):
    if bpy.app.version < (4, 3):
        pytest.skip("its strokes are of another kind")
    loops = [np.column_stack([np.array(loop) + (x, 0), np.zeros(4)]) for loop, x in ((SQUARE, 0), (BOW_TIE, 5))]
    obj = draw(*loops)
    obj.location, obj.rotation_euler = (0, 2, 0), (0, 0, 0.5)
    if draw is grease_pencil:
        obj.data.layers[0].translation = (1, 0, 0)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="crosses or touches itself"):
        bpy.ops.tessera.mesh_curve()
    (noted,) = notes.last
    button = {"object_name": noted.obj, "spline": noted.spline, "place": noted.place}
    assert noted.spline == 2 and bpy.ops.tessera.select_place(**button) == {"FINISHED"}
    assert bpy.context.mode == ("EDIT_GREASE_PENCIL" if draw is grease_pencil else "EDIT_CURVES")
    holder = obj.data if draw is hair_curves else obj.data.layers[0].frames[0].drawing
    chosen = [point.value for point in holder.attributes[".selection"].data]
    assert sum(chosen[:4]) == 0 and sum(chosen[4:]) == 1


def test_the_vertex_of_a_meshs_failure_is_seen_also_where_faces_are_selected():
    bpy.ops.mesh.primitive_monkey_add()
    bpy.context.tool_settings.mesh_select_mode = (False, False, True)
    with pytest.raises(RuntimeError, match="It is not flat"):
        bpy.ops.tessera.mesh_curve()
    (noted,) = notes.last
    assert bpy.ops.tessera.select_place(object_name=noted.obj, place=noted.place) == {"FINISHED"}
    assert bpy.context.object.data.total_vert_sel == 1
    assert tuple(bpy.context.tool_settings.mesh_select_mode) == (True, False, False)


def test_a_success_forgets_the_failures_of_before():
    poly_curve(BOW_TIE, name="Broken")
    with pytest.raises(RuntimeError):
        bpy.ops.tessera.mesh_curve()
    circle()
    run(edge_length=0.4)
    assert notes.last == []


# -- several objects --


@pytest.mark.parametrize("wanted", [{"edge_length": 0.3}, {"size_by": "TRIANGLE_COUNT", "triangle_count": 60}, {}])
def test_objects_that_are_meshed_together_have_the_meshes_that_they_have_alone(wanted):
    from addon.blender import meshing

    objects = [poly_curve(star(5 + i), name=f"S{i}") for i in range(3)]
    objects += [poly_curve(BOW_TIE, name="Bow tie"), text("ab"), circle()]
    objects[1].scale = 40, -40, 40
    bpy.context.view_layer.update()
    depsgraph, settings = bpy.context.evaluated_depsgraph_get(), Settings(**wanted)
    together = meshing.finish(meshing.mesh_all(objects, depsgraph, [settings] * len(objects)))
    alone = [meshing.finish(meshing.mesh_all([obj], depsgraph, [settings])) for obj in objects]
    assert [str(failure) for failure in together.failures] == [str(f) for batch in alone for f in batch.failures]
    assert len(together.failures) == 1 and len(together.meshed) == 5
    for one, other in zip(together.meshed, (meshed for batch in alone for meshed in batch.meshed), strict=True):
        assert one.task.obj == other.task.obj and one.edge_length == other.edge_length
        assert one.warnings == other.warnings
        for piece, same in zip(one.pieces, other.pieces, strict=True):
            np.testing.assert_array_equal(piece.vertices, same.vertices)
            np.testing.assert_array_equal(piece.triangles, same.triangles)


def test_a_handful_is_of_as_many_as_are_worth_it_and_all_come_in_their_order():
    from addon.blender import meshing

    sizes = [10, 3000, 2000, 9000, 1, 1, 1]
    handfuls = list(meshing.handfuls(iter(sizes), float))
    assert handfuls == [[10, 3000], [2000], [9000], [1, 1, 1]]
    assert list(meshing.handfuls([], float)) == []


# -- what is wrong with the surroundings --


@pytest.mark.parametrize("kind", [tessera.RuntimeProblem, ImportError])
def test_only_what_is_wrong_with_onnxruntime_is_said_without_a_traceback(monkeypatch, kind):
    from addon.blender import meshing

    def broken(_tasks):
        raise kind("cannot load it")
        yield

    monkeypatch.setattr(meshing, "mesh_tasks", broken)
    circle()
    with pytest.raises(RuntimeError, match="cannot load it") as error:
        bpy.ops.tessera.mesh_curve()
    assert ("Traceback" in str(error.value)) == (kind is ImportError)


@pytest.mark.parametrize("how", ["removed", "deleted", "edited"])
def test_an_object_that_goes_while_it_is_meshed_in_another_window_is_said(how):
    class InWindow(Stepping):
        bl_label, said = "Mesh", ()

        def chosen(self, context):
            return [(context.object, Settings(edge_length=0.02))]

        def report(self, _kind, sentence):
            self.said += (sentence,)

    anything = Mock()
    context = Mock(object=circle(), evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get)
    operator = InWindow()
    operator._steps, operator._timer = operator.steps(context), anything
    next(operator._steps)
    if how == "removed":
        bpy.data.objects.remove(context.object)
    elif how == "deleted":
        bpy.context.scene["still"] = context.object  # as a linked mesh refers to its source
        bpy.ops.object.delete()
    else:
        bpy.ops.object.mode_set(mode="EDIT")
    assert operator.modal(context, Mock(type="TIMER")) == {"CANCELLED"}
    assert operator.said[0].startswith("'Circle' was deleted or undone in another window, or is in another mode")


# -- cancelling; the window's own way is tested in test_window.py --


def test_steps_that_are_given_up_leave_the_scene_byte_for_byte_as_it_was(tmp_path):
    from addon.blender import meshing

    objects = [circle(), poly_curve(star(), name="Star")]
    bpy.context.view_layer.update()
    before = saved(tmp_path / "scene.blend")
    settings = [Settings(edge_length=0.05, flips=True, smooth=2)] * 2
    for n_steps in (1, 3, 8):
        steps = meshing.mesh_all(objects, bpy.context.evaluated_depsgraph_get(), settings)
        shares = [next(steps).share for _ in range(n_steps)]
        assert shares == sorted(shares) and 0 <= shares[0] and shares[-1] < 1
        steps.close()
        assert unchanged(before, saved(tmp_path / "scene.blend"))
