"""What all operators that mesh have in common: they block for scripts, and go in slices in the window."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy

from .. import notes
from ..layout import draw_failures
from ..progress import Done, Steps, advance

if TYPE_CHECKING:
    from ..meshing import Batch
    from ..settings import Settings

# Work of less than this is done at once; seconds.
PATIENCE = 0.5
# In the window, Blender is asked for events after so many seconds.
_SLICE = 0.08
_PAUSE = 0.01
_LINE, _MOST_FAILURES = 90, 8  # characters of a popup's line; how many failures it shows


class Refusal(Exception):
    """Why nothing can be meshed at all, in the words that the user sees."""


def _refusals() -> tuple[type[Exception], ...]:
    """What has a message for the user: also an onnxruntime that is broken or too old."""
    from ...tessera import RuntimeProblem  # here, so that enabling the add-on does not load the mesher

    return Refusal, RuntimeProblem


class Stepping:
    """Of an operator: what is `chosen` is meshed without a change to the scene, `write` puts that into it.

    targets: the objects besides the chosen ones that `write` changes.
    """

    targets: Sequence[bpy.types.Object] = ()

    def chosen(self, context: bpy.types.Context) -> list[tuple[bpy.types.Object, Settings]]:
        """What is to be meshed, each by its settings. Raises Refusal."""
        raise NotImplementedError

    def write(self, context: bpy.types.Context, batch: Batch) -> None:
        """Change the scene; called once something was meshed."""
        raise NotImplementedError

    def steps(self, context: bpy.types.Context) -> Steps[Batch]:
        """What is to be done. Raises Refusal."""
        from .. import meshing  # here, so that enabling the add-on does not load the mesher

        objects, settings = map(list, zip(*self.chosen(context), strict=True))
        self._needed = [(obj, obj.name, obj.mode) for obj in (*objects, *self.targets)]
        return meshing.mesh_all(objects, context.evaluated_depsgraph_get(), settings)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Mesh everything, and only then change the scene."""
        try:
            batch = _block(context, self.steps(context))
        except _refusals() as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        return self._end(context, batch, in_window=False)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """The same; what takes long goes on in slices, with its progress in the status bar."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self._steps = self.steps(context)
            outcome = advance(self._steps, PATIENCE)
        except _refusals() as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        if isinstance(outcome, Done):
            return self._end(context, outcome.result, in_window=True)
        manager = context.window_manager
        self._timer = manager.event_timer_add(_PAUSE, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        self._show(context, outcome)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """A slice at each timer's event; Esc ends it. Nothing else gets through, so that the scene stays as read.

        That is in this window: in another one, the user can go on.
        """
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Cancelled: nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            self._check_there()
            # As long as Blender takes to draw, where that is longer: else drawing would be most of the work.
            drawing = time.perf_counter() - self._rested
            outcome = advance(self._steps, min(max(_SLICE, drawing), PATIENCE))
        except BaseException as error:
            self.cancel(context)
            if not isinstance(error, _refusals()):
                raise
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if isinstance(outcome, Done):
            self.cancel(context)
            return self._end(context, outcome.result, in_window=True)
        self._show(context, outcome)
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Leave the window as it was; Blender calls it too, when the window closes."""
        self._steps.close()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _check_there(self) -> None:
        there = {obj for scene in bpy.data.scenes for obj in scene.objects}
        for obj, name, mode in self._needed:
            if obj not in there or obj.mode != mode:
                what = "was deleted or undone in another window, or is in another mode"
                raise Refusal(f"'{name}' {what} by now, so nothing was changed. Run {self.bl_label} again")

    def _show(self, context: bpy.types.Context, progress) -> None:
        self._rested = time.perf_counter()
        percent = int(100 * progress.share)
        context.window_manager.progress_update(percent)
        context.workspace.status_text_set(f"{self.bl_label}: {percent} % ({progress.stage})    Esc: cancel")

    def _end(self, context: bpy.types.Context, batch: Batch, in_window: bool) -> set[str]:
        notes.note(batch.failures)
        if in_window and batch.failures:
            _pop_up(context)
        if not batch.meshed:
            # In the window, the popup says it, with more than a report can.
            for failure in batch.failures:
                self.report({"WARNING" if in_window else "ERROR"}, str(failure))
            return {"CANCELLED"}
        self._summarise(batch)  # before the sources are replaced
        self.write(context, batch)
        return {"FINISHED"}

    def _summarise(self, batch: Batch) -> None:
        for failure in batch.failures:
            self.report({"WARNING"}, str(failure))
        for meshed in batch.meshed:
            for warning in meshed.warnings:
                self.report({"WARNING"}, f"{meshed.task.obj.name}: {warning}")
        triangles = sum(meshed.n_triangles for meshed in batch.meshed)
        mean = sum(meshed.q_mean * meshed.n_triangles for meshed in batch.meshed) / triangles
        worst = min(meshed.q_worst for meshed in batch.meshed)
        if batch.failures:
            total = len(batch.failures) + len(batch.meshed)
            names = ", ".join(f"'{failure.obj}'" for failure in batch.failures)
            self.report({"WARNING"}, f"{len(batch.failures)} of {total} objects were not meshed: {names}")
        self.report({"INFO"}, f"{triangles} triangles, quality {mean:.3f} on average, {worst:.3f} at worst")


def _block(context: bpy.types.Context, steps: Steps[Batch]) -> Batch:
    """Take all steps, for scripts and for Adjust Last Operation; what takes long shows its progress at the cursor."""
    outcome = advance(steps, PATIENCE)
    if isinstance(outcome, Done):
        return outcome.result
    manager = context.window_manager
    manager.progress_begin(0, 100)
    try:
        while not isinstance(outcome, Done):
            manager.progress_update(int(100 * outcome.share))
            outcome = advance(steps, PATIENCE)
    finally:
        manager.progress_end()
    return outcome.result


def _pop_up(context: bpy.types.Context) -> None:
    """Say what failed, and offer to go there."""

    def draw(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
        draw_failures(menu.layout, _MOST_FAILURES, _LINE)

    context.window_manager.popup_menu(draw, title="Not Meshed", icon="ERROR")
