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

from .kinds import shows_collection
from .linked import fingerprint, is_linked, linked_settings, source_is_there

# Meshes that take longer than this many seconds are drafted while their source changes. Where drafts take longer than
# that, they wait, too, until it has not changed for as long as _REST.
_QUICK, _QUICK_DRAFT, _REST = 0.1, 0.3, 0.5
# A window that stands still for more seconds than this is no help: such meshes follow no longer by themselves.
_TOO_LONG = 3.0
# Steps of smoothing that a draft has instead of the networks' passes.
_SMOOTH = 2

_wanted: set[str] = set()  # names of meshes that may be out of date
_seconds = float("inf")  # that the last meshes took, and the last drafts
_draft_seconds = 0.0
_at_work = False


def want(obj: bpy.types.Object) -> None:
    """Mesh this object again soon, if it is linked and follows its source; without a window, at once."""
    if not is_linked(obj) or not obj.tessera.automatic or _at_work:
        return
    _wanted.add(obj.name)
    if bpy.app.background:
        _finish()
        return
    slow = _seconds > _QUICK
    if slow:
        _forget(_finish)
        if _draft_seconds <= _QUICK_DRAFT:
            _soon(_draft)
    _soon(_finish, _REST if slow else 0.0)


def _soon(work: Callable[[], None], seconds: float = 0.0) -> None:
    if not bpy.app.timers.is_registered(work):
        bpy.app.timers.register(work, first_interval=seconds)


def _forget(work: Callable[[], None]) -> None:
    if bpy.app.timers.is_registered(work):
        bpy.app.timers.unregister(work)


def _draft() -> None:
    """Draft what may be out of date, and leave it out of date."""
    global _draft_seconds
    _draft_seconds = sum(_mesh_wanted(draft=True).values()) or _draft_seconds


def _finish() -> None:
    """Mesh what may be out of date."""
    global _seconds, _draft_seconds
    seconds = _mesh_wanted()
    _wanted.clear()
    _seconds = sum(seconds.values()) or _seconds
    _draft_seconds = 0.0  # the next changes are drafted again, however long the last draft took
    if not bpy.app.background:
        for name, its in seconds.items():
            stop_if_slow(bpy.data.objects[name], its)


def _mesh_wanted(draft: bool = False) -> dict[str, float]:
    """Mesh what is wanted, and how long each took that was out of date."""
    global _at_work
    seconds = {}
    _at_work = True
    try:
        for name in sorted(_wanted):
            obj = bpy.data.objects.get(name)
            if is_linked(obj) and obj.tessera.automatic:
                since = time.perf_counter()
                if mesh_again(obj, draft):
                    seconds[name] = time.perf_counter() - since
    finally:
        _at_work = False
    return seconds


def stop_if_slow(obj: bpy.types.Object, seconds: float) -> None:
    """Let a mesh that took too long follow no longer, and say so at it."""
    if seconds > _TOO_LONG:
        obj.tessera.automatic = False
        obj.tessera.message = f"Meshing took {seconds:.0f} s, so Follow Changes was switched off: use Mesh Again"


def mesh_again(obj: bpy.types.Object, draft: bool = False) -> bool:
    """Mesh a linked object if it is out of date; whether it was. What is wrong with its source is noted at it.

    draft: in a third of the time, poorer, and it stays out of date.
    """
    from . import meshing, results  # here, so that enabling the add-on does not load the mesher

    if not source_is_there(obj):
        obj.tessera.message = "Its source is in no scene"
        return False
    settings, depsgraph = linked_settings(obj), bpy.context.evaluated_depsgraph_get()
    try:
        task = meshing.read_task(obj.tessera.source, depsgraph, settings)
        if fingerprint(task, settings) == obj.tessera.fingerprint:
            if obj.tessera.message:
                obj.tessera.message = ""
            return False
        if draft:
            task = replace(task, settings=replace(settings, passes=0, smooth=max(settings.smooth, _SMOOTH)))
        results.rewrite(obj, meshing.finish(meshing.mesh_task(task)), not draft)
    except meshing.Failure as failure:
        obj.tessera.message = str(failure)
        return False
    return True


@persistent
def _after_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    changed = {update.id.original.name for update in depsgraph.updates if _matters(update)}
    if changed:
        for obj in _following():
            near = obj.tessera.settings.object_name
            if changed & {*_names(obj.tessera.source), near.name if near else ""}:
                want(obj)


def _names(source: bpy.types.Object) -> Iterator[str]:
    """What the source is made of: itself, its data, and the objects of the collection that it shows, by name."""
    shown = source.instance_collection.all_objects if shows_collection(source) else ()
    for obj in (source, *shown):
        yield obj.name
        if obj.data is not None:
            yield obj.data.name


def _matters(update: bpy.types.DepsgraphUpdate) -> bool:
    return update.is_updated_geometry or (update.is_updated_transform and isinstance(update.id, bpy.types.Object))


@persistent
def _after_undo(scene: bpy.types.Scene, _) -> None:
    for obj in _following():
        want(obj)


@persistent
def _after_load(_path: str, _) -> None:
    _wanted.clear()


def _following() -> Iterator[bpy.types.Object]:
    # The rarest first: this is asked of all objects of the file, at each change.
    return (obj for obj in bpy.data.objects if obj.tessera.automatic and is_linked(obj))


def _handlers() -> tuple:
    handlers = bpy.app.handlers
    return (
        (handlers.depsgraph_update_post, _after_update),
        (handlers.undo_post, _after_undo),
        (handlers.redo_post, _after_undo),
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
    for work in (_draft, _finish):
        _forget(work)
