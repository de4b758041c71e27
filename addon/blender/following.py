"""Linked meshes that follow their source: at each change of it they are meshed again, once Blender is idle.

Those that take long are drafted at each change, and meshed as their settings say when the source rests. What is read of
the source is compared with what the mesh was made of, so that nothing is done for nothing: a change of the selection is
none, and after undo only what is out of date is meshed.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import bpy
from bpy.app.handlers import persistent

from .linked import (
    depends_on,
    fingerprint,
    is_being_edited,
    is_draft,
    is_linked,
    linked_settings,
    made_of,
    problem,
    read_from,
)

# Meshes that take longer than this many seconds are drafted while their source changes. Where drafts take longer than
# that, they wait, too, until it has not changed for as long as _REST.
_QUICK, _QUICK_DRAFT, _REST = 0.1, 0.3, 0.5
# A window that stands still for more seconds than this is no help: such meshes follow no longer by themselves.
_TOO_LONG = 3.0
# Steps of smoothing that a draft has instead of the networks' passes.
_SMOOTH = 1
# What is said at a mesh that waits until it is edited no longer.
_WAITS = "It is being edited, and will be meshed again in Object Mode"

# Names of meshes: that may be out of date, and whose source is to rest first.
_wanted: set[str] = set()
_resting: set[str] = set()
# Seconds that each mesh took the last time in full, and the last draft since then.
_seconds: dict[str, float] = {}
_draft_seconds: dict[str, float] = {}
_at_work = False


def want(obj: bpy.types.Object) -> None:
    """Mesh this object again soon, if it is linked and follows its source; without a window, at once."""
    if not is_linked(obj) or not obj.tessera.automatic or _at_work:
        return
    _wanted.add(obj.name)
    if has_window():
        _soon(_catch_up)
    else:
        _catch_up()


def has_window() -> bool:
    """Whether there is someone to wait for: else timers do not run, and nothing is drafted."""
    return not bpy.app.background


def _soon(work: Callable[[], None], seconds: float = 0.0) -> None:
    if not bpy.app.timers.is_registered(work):
        bpy.app.timers.register(work, first_interval=seconds)


def _forget(work: Callable[[], None]) -> None:
    if bpy.app.timers.is_registered(work):
        bpy.app.timers.unregister(work)


def _catch_up() -> None:
    """Mesh what is quick, and draft the rest."""
    try:
        for obj in _each(_wanted):
            if not obj.tessera.automatic:
                continue
            if not has_window() or _seconds.get(obj.name, _TOO_LONG) <= _QUICK:
                _mesh(obj, _wanted)
                continue
            changed = _draft_seconds.get(obj.name, 0.0) > _QUICK_DRAFT or _mesh(obj, _wanted, draft=True)
            if changed:
                _resting.add(obj.name)
                _forget(_finish)
            if changed or is_draft(obj):
                _soon(_finish, _REST)
    finally:
        if _wanted:  # one could not be meshed: the others next
            _soon(_catch_up)


def _finish() -> None:
    """Mesh what has been waiting for its source to rest, and all drafts."""
    _resting.update(obj.name for obj in bpy.data.objects if is_draft(obj))
    try:
        for obj in _each(_resting):
            if obj.tessera.automatic or is_draft(obj):
                _mesh(obj, _resting)
                # However long it took: the first one has loaded the networks.
                _draft_seconds.pop(obj.name, None)
                stop_if_slow(obj, _seconds.get(obj.name, 0.0))
    finally:
        if _resting:
            _soon(_finish)


def _each(names: set[str]) -> Iterator[bpy.types.Object]:
    """The linked meshes of these names, taken out one by one."""
    while names:
        name = min(names)
        names.remove(name)
        obj = bpy.data.objects.get((name, None))  # not a library's
        if is_linked(obj):
            yield obj


def _mesh(obj: bpy.types.Object, names: set[str], draft: bool = False) -> bool:
    """`mesh_again`, timed, without an answer to the changes that it makes itself.

    names: gets those of the meshes that follow this one, as Blender tells of no change that is made at a change.
    """
    global _at_work
    _at_work, since = True, time.perf_counter()
    try:
        was_due = mesh_again(obj, draft)
    finally:
        _at_work = False
    if was_due:
        (_draft_seconds if draft else _seconds)[obj.name] = time.perf_counter() - since
        names.update(other.name for other in _following() if _follows(other, {_key(obj)}))
    return was_due


def stop_if_slow(obj: bpy.types.Object, seconds: float) -> None:
    """Let a mesh that took too long follow no longer, and say so at it."""
    if seconds > _TOO_LONG:
        obj.tessera.automatic = False
        obj.tessera.message = f"Meshing took {seconds:.0f} s, so Follow Changes was switched off: use Mesh Again"


def mesh_again(obj: bpy.types.Object, draft: bool = False) -> bool:
    """Mesh a linked object if it is out of date; whether it was. What is wrong with its source is noted at it.

    draft: faster and poorer; it stays out of date.
    """
    from .. import tessera  # here, so that enabling the add-on does not load the mesher
    from . import meshing, results

    if trouble := problem(obj):
        obj.tessera.message = trouble
        return False
    if is_being_edited(obj):
        obj.tessera.message = _WAITS
        return False
    settings, depsgraph = linked_settings(obj), bpy.context.evaluated_depsgraph_get()
    try:
        task = meshing.read_task(obj.tessera.source, depsgraph, settings)
        if made_of(obj) == fingerprint(task, settings) and (draft or not is_draft(obj)):
            if obj.tessera.message:
                obj.tessera.message = ""
            return False
        if draft:
            task = replace(task, settings=replace(settings, passes=0, smooth=max(settings.smooth, _SMOOTH)))
        results.rewrite(obj, meshing.finish(meshing.mesh_task(task)), draft)
    except (meshing.Failure, tessera.RuntimeProblem) as failure:
        obj.tessera.message = str(failure)
        return False
    return True


@persistent
def _after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    changed = {_key(update.id.original) for update in depsgraph.updates if _matters(update)}
    if changed:
        for obj in _following():
            if _follows(obj, changed) or _has_waited(obj):
                want(obj)


def _follows(obj: bpy.types.Object, changed: set[tuple[str, str]]) -> bool:
    """Whether a linked mesh is made of something that has changed, by `_key`; what is made of the mesh does not count.

    Meshes that size each other would else be meshed for ever.
    """
    return any(not changed.isdisjoint(_keys(part)) and not depends_on(part, obj) for part in read_from(obj))


def _has_waited(obj: bpy.types.Object) -> bool:
    return obj.tessera.message == _WAITS and not is_being_edited(obj)


def _key(block: bpy.types.ID) -> tuple[str, str]:
    return block.id_type, block.name_full


def _keys(obj: bpy.types.Object) -> tuple[tuple[str, str], ...]:
    """Those of an object and of its data."""
    return (_key(obj),) if obj.data is None else (_key(obj), _key(obj.data))


def _matters(update: bpy.types.DepsgraphUpdate) -> bool:
    return update.is_updated_geometry or (update.is_updated_transform and isinstance(update.id, bpy.types.Object))


@persistent
def _after_undo(scene: bpy.types.Scene, _) -> None:
    for obj in _following():
        want(obj)


@persistent
def _before_save(_path: str, _) -> None:
    """No file has drafts, nor meshes that are still to follow."""
    _resting.update(_wanted)
    _wanted.clear()
    _finish()


@persistent
def _after_load(_path: str, _) -> None:
    """In the window, what is out of date is meshed once Blender is idle; without one, a file stays as it was saved."""
    for names in (_wanted, _resting, _seconds, _draft_seconds):
        names.clear()
    if has_window():
        for obj in _following():
            want(obj)


def _following() -> Iterator[bpy.types.Object]:
    # The rarest first: this is asked of all objects of the file, at each change.
    return (obj for obj in bpy.data.objects if obj.tessera.automatic and is_linked(obj))


def _handlers() -> tuple:
    handlers = bpy.app.handlers
    return (
        (handlers.depsgraph_update_post, _after_update),
        (handlers.undo_post, _after_undo),
        (handlers.redo_post, _after_undo),
        (handlers.save_pre, _before_save),
        (handlers.load_post, _after_load),
    )


def register() -> None:
    """Listen to changes."""
    for handlers, function in _handlers():
        handlers.append(function)


def unregister() -> None:
    """Listen no more."""
    for handlers, function in _handlers():
        handlers.remove(function)
    for work in (_catch_up, _finish):
        _forget(work)
