"""Linked meshes that follow in a window: drafted at each change, meshed in full when their source rests.

Timers do not run without a window, so these stand for them: what is due first is done first.
"""

import bpy
import pytest

from addon.blender import following
from addon.blender.linked import is_draft
from tests.blender.drawing import circle, move, poly_curve, right, select


class Timers:
    """What following asks of `bpy.app.timers`, with a clock of its own."""

    def __init__(self):
        self.due, self.now, self.done = {}, 0.0, []

    def soon(self, work, seconds=0.0):
        self.due.setdefault(work, self.now + seconds)

    def forget(self, work):
        self.due.pop(work, None)

    def run(self, seconds=60.0):
        """What is due within these seconds; gives the names of what was done, in turn."""
        end, self.done = self.now + seconds, []
        while self.due and min(self.due.values()) <= end:
            work = min(self.due, key=self.due.get)
            self.now = max(self.now, self.due.pop(work)) + 0.01
            self.done.append(work.__name__)
            work()
            bpy.context.view_layer.update()
            assert len(self.done) < 20, "it never ends"
        self.now = end
        return self.done


@pytest.fixture
def timers(monkeypatch):
    found = Timers()
    following._after_load("", None)
    monkeypatch.setattr(following, "has_window", lambda: True)
    monkeypatch.setattr(following, "_soon", found.soon)
    monkeypatch.setattr(following, "_forget", found.forget)
    monkeypatch.setattr(following, "_QUICK", 0.0)  # every mesh takes long
    monkeypatch.setattr(following, "_QUICK_DRAFT", 60.0)
    return found


def follow(mesh):
    mesh.tessera.automatic = True
    return mesh


def drafted(square, timers):
    """The curve and its mesh, which follows it and is a draft by now."""
    curve, mesh = square
    follow(mesh)
    timers.run()
    move(curve, 1, 2.0)
    timers.run(0.1)
    assert is_draft(mesh)
    return curve, mesh


def test_a_change_is_drafted_and_finished_when_the_curve_rests(square, timers):
    curve, mesh = square
    follow(mesh)
    timers.run()
    for x in (2.0, 2.5, 3.0):
        move(curve, 1, x)
        assert timers.run(0.4) == ["_catch_up"]
        assert right(mesh) == x and is_draft(mesh)
    poorer = mesh.tessera.q_mean
    assert timers.run() == ["_finish"]
    assert not is_draft(mesh) and mesh.tessera.q_mean > poorer and right(mesh) == 3.0
    assert timers.run() == []


def test_quick_meshes_are_meshed_at_once(square, timers, monkeypatch):
    curve, mesh = square
    follow(mesh)
    timers.run()
    monkeypatch.setattr(following, "_QUICK", 60.0)
    move(curve, 1, 2.0)
    timers.run()  # the first time it may take long, as far as is known
    move(curve, 1, 3.0)
    assert timers.run() == ["_catch_up"] and right(mesh) == 3.0 and not is_draft(mesh)


def test_slow_drafts_wait_until_the_curve_rests(square, timers, monkeypatch):
    curve, mesh = square
    follow(mesh)
    timers.run()
    monkeypatch.setattr(following, "_QUICK_DRAFT", 0.0)
    move(curve, 1, 2.0)
    timers.run(0.2)
    move(curve, 1, 3.0)
    assert timers.run(0.2) == ["_catch_up"] and right(mesh) == 2.0
    timers.run()
    assert right(mesh) == 3.0 and not is_draft(mesh)


@pytest.mark.parametrize("how", ["near", "name"])
def test_a_mesh_whose_own_changes_come_back_is_finished(square, timers, how):
    """Another mesh follows this one, or its data has the name of the curve."""
    curve, mesh = square
    follow(mesh)
    if how == "name":
        mesh.data.name = curve.data.name
    else:
        select(circle())
        bpy.ops.tessera.mesh_curve(edge_length=0.4, keep_linked=True)
        other = bpy.context.object
        other.tessera.settings.object_name = mesh
        other.tessera.settings.use_object = True
        follow(other)
    timers.run()
    move(curve, 1, 2.0)
    timers.run()
    assert right(mesh) == 2.0 and not any(is_draft(obj) for obj in bpy.data.objects)


@pytest.mark.parametrize("how", ["switched off", "renamed", "unlinked", "saved"])
def test_no_draft_stays(square, timers, how, tmp_path):
    _, mesh = drafted(square, timers)
    poorer = mesh.tessera.q_mean
    if how == "switched off":
        mesh.tessera.automatic = False
    elif how == "renamed":
        mesh.name = "Another"
    elif how == "unlinked":
        select(mesh)
        bpy.ops.tessera.unlink()
    else:
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "drafted.blend"))
        assert not is_draft(mesh)
    timers.run()
    assert not is_draft(mesh) and mesh.tessera.q_mean > poorer


def test_one_that_goes_wrong_does_not_keep_the_others(square, timers, monkeypatch):
    _, mesh = square
    mesh.name = "First"
    select(poly_curve([(0, 0), (1, 0), (0, 1)], name="Triangle"))
    bpy.ops.tessera.mesh_curve(edge_length=0.3, keep_linked=True)
    other = follow(bpy.context.object)
    follow(mesh)
    timers.run()
    real = following.mesh_again

    def wrong(obj, draft=False):
        if obj == mesh:
            raise MemoryError
        return real(obj, draft)

    monkeypatch.setattr(following, "mesh_again", wrong)
    following._wanted.add("First")
    move(bpy.data.objects["Triangle"], 1, 2.0)
    with pytest.raises(MemoryError):
        timers.run()
    timers.run()
    assert right(other) == 2.0 and not is_draft(other)


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT"])
@pytest.mark.parametrize("windowed", [True, False])
def test_a_mesh_that_is_edited_itself_follows_when_that_ends(square, timers, monkeypatch, mode, windowed):
    curve, mesh = square
    monkeypatch.setattr(following, "has_window", lambda: windowed)
    follow(mesh)
    timers.run()
    bpy.ops.object.mode_set(mode=mode)
    move(curve, 1, 3.0)
    timers.run()
    assert right(mesh) == pytest.approx(1.0, abs=1e-5) or mode == "EDIT"
    assert "is being edited" in mesh.tessera.message
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    timers.run()
    assert right(mesh) == pytest.approx(3.0, abs=1e-5) and not mesh.tessera.message


@pytest.mark.parametrize("how", ["itself", "each other", "a ring"])
def test_meshes_that_size_each_other_are_not_meshed_for_ever(square, timers, how):
    curve, mesh = square
    meshes = [mesh]
    for number in range({"itself": 0, "each other": 1, "a ring": 2}[how]):
        select(circle(name=f"C{number}"))
        bpy.ops.tessera.mesh_curve(edge_length=0.4, keep_linked=True)
        meshes.append(bpy.context.object)
    for each, near in zip(meshes, [*meshes[1:], mesh], strict=True):
        each.tessera.settings.object_name, each.tessera.settings.use_object = near, True
        follow(each)
    timers.run()
    move(curve, 1, 2.0)
    timers.run()
    assert timers.run() == [] and not any(is_draft(obj) for obj in bpy.data.objects)
    assert right(mesh) == (1.0 if how == "itself" else 2.0)


def test_a_file_that_is_saved_at_once_has_what_follows_in_full(square, timers, tmp_path):
    curve, mesh = square
    select(follow(mesh))
    bpy.ops.tessera.mesh_curve(edge_length=0.3, keep_linked=True)
    second = follow(bpy.context.object)
    timers.run()
    move(curve, 1, 2.0)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "moved.blend"))
    assert right(mesh) == right(second) == 2.0 and not is_draft(mesh) and not is_draft(second)


@pytest.mark.parametrize("windowed", [True, False])
def test_what_is_out_of_date_in_a_file_is_meshed_once_it_is_open_in_a_window(
    square, timers, monkeypatch, windowed, tmp_path
):
    curve, mesh = square
    follow(mesh)
    timers.run()
    move(curve, 1, 2.0)
    with monkeypatch.context() as without:
        without.setattr(following, "_finish", lambda: None)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "stale.blend"))
    timers.due.clear()
    monkeypatch.setattr(following, "has_window", lambda: windowed)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "stale.blend"))
    assert right(bpy.data.objects["Square Mesh"]) == 1.0
    timers.run()
    assert right(bpy.data.objects["Square Mesh"]) == (2.0 if windowed else 1.0)


def test_a_draft_that_cannot_be_finished_is_unlinked_with_a_word_of_it(square, timers, capfd):
    curve, mesh = drafted(square, timers)
    move(curve, 0, 3.0)  # it crosses itself now
    select(mesh)
    assert bpy.ops.tessera.unlink() == {"FINISHED"} and mesh.tessera.source is None
    assert "Mesh 'Square Mesh' stays the draft that it is: Curve 'Square', spline 1 crosses" in capfd.readouterr().out


def test_undo_brings_back_the_meshes_of_copies_too(square, timers):
    """Undo may bring back an object, and leave the mesh that following has given it."""
    curve, mesh = square
    follow(mesh)
    timers.run()
    copy = mesh.copy()
    copy.data = mesh.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    bpy.ops.ed.undo_push(message="copy")
    names = curve.name, mesh.name, copy.name
    move(curve, 1, 3.0)
    bpy.ops.ed.undo_push(message="move")
    timers.run()
    assert right(mesh) == right(copy) == 3.0
    bpy.ops.ed.undo()
    timers.run()
    _, mesh, copy = (bpy.data.objects[name] for name in names)
    assert right(mesh) == right(copy) == 1.0
