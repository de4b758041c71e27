"""What all operators that mesh have in common: they block for scripts, and go in slices in the window."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from .. import notes
from ..layout import draw_failures
from ..progress import Done, Steps, advance

if TYPE_CHECKING:
    from ..meshing import Batch

# Work of less than this is done at once; seconds.
PATIENCE = 0.5
# In the window, Blender is asked for events after so many seconds.
_SLICE = 0.08
_PAUSE = 0.01
_LINE, _MOST_FAILURES = 90, 8  # characters of a popup's line; how many failures it shows


class Refusal(Exception):
    """Why nothing can be meshed at all, in the words that the user sees."""


# An onnxruntime that is broken or too old is an ImportError, with a message for the user.
_REFUSALS = Refusal, ImportError


class Stepping:
    """Of an operator: `steps` meshes without a change to the scene, `write` puts what was meshed into it."""

    def steps(self, context: bpy.types.Context) -> Steps[Batch]:
        """What is to be done. Raises Refusal."""
        raise NotImplementedError

    def write(self, context: bpy.types.Context, batch: Batch) -> None:
        """Change the scene; called once something was meshed."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Mesh everything, and only then change the scene."""
        try:
            batch = _block(context, self.steps(context))
        except _REFUSALS as refusal:
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
        except _REFUSALS as refusal:
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
        """A slice at each timer's event; Esc ends it. Nothing else gets through, so that the scene stays as read."""
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Cancelled: nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            outcome = advance(self._steps, _SLICE)
        except BaseException as error:
            self.cancel(context)
            if not isinstance(error, _REFUSALS):
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

    def _show(self, context: bpy.types.Context, progress) -> None:
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
