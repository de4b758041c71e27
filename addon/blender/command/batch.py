"""One file: its curves are read, meshed a handful at a time, and written."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace

import bpy

from .. import meshing
from . import console, interrupts
from .arguments import Request
from .claims import Claims, RunIsOver
from .curves import Curve, internal, known, mesh_curves, read_curve, write
from .files import Job
from .inputs import InputError, choose, open_file
from .journal import Journal, is_taken, read_done, write_done
from .outputs import OutputError, write_file
from .records import Record, failed, name_of


def mesh_file(job: Job, request: Request, claims: Claims, number: int = 0) -> list[Record]:
    """Make the file of a job, and note in its journal that it is done. What the journal has already is not done again.

    number: of the job, by which processes claim it. Raises RunIsOver, Interrupted, and OSError where the journal cannot
    be read or written.
    """
    records = done_by(job, request, claims)
    if records is not None:
        for record in records:
            console.show(record)
        return records
    _check(job, request, claims)
    key = _key(job, request, claims.run)
    journal = Journal(job.target, claims.run)
    try:
        records = _mesh_opened(job, request, claims, number, journal)
    except InputError as error:
        records = [failed(job.name, None, "input", str(error))]
        console.show(records[0])
    finally:
        journal.close()
    _check_owner(job, request, claims)
    write_done(job.target, key, claims.run, [asdict(record) for record in records])
    if all(record.status != "failed" for record in records):
        journal.drop()
    return records


def done_by(job: Job, request: Request, claims: Claims) -> list[Record] | None:
    """The records of a file that this run or an earlier one has made, else None."""
    done = read_done(job.target, _key(job, request, claims.run), claims.run)
    return None if done is None else [Record(**record) for record in done]


def so_far(job: Job, request: Request, claims: Claims) -> list[Record]:
    """What a run that was stopped has done of a file: where that is not written, the curves that are meshed."""
    records = done_by(job, request, claims)
    if records is not None:
        return records
    entries = Journal(job.target, claims.run).entries.values()
    return [Record(**entry.record) for entry in entries if not entry.earlier]


def fill_journal(job: Job, request: Request, claims: Claims, number: int) -> None:
    """Mesh those curves of a file that this process can claim, into the journal; the file itself is written later.

    Raises as `mesh_file` does.
    """
    if done_by(job, request, claims) is not None:
        return
    try:
        open_file(job.source)
        objects = choose(request.objects)
    except InputError:
        return  # said by the process that writes the file
    journal = Journal(job.target, claims.run)
    own = (obj for index, obj in enumerate(objects) if claims.claim(number, index))
    read = (known(job, curve, journal) for curve in _read(job, request, claims, own))
    try:
        for some in _handfuls(read, request):
            mesh_curves(job, some, journal)
    finally:
        journal.close()


def _read(job: Job, request: Request, claims: Claims, objects: Iterable[bpy.types.Object]) -> Iterator[Curve]:
    """One after the other, for as long as this process may go on."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for obj in objects:
        _check(job, request, claims)
        yield read_curve(job, obj, depsgraph, request)


def _check(job: Job, request: Request, claims: Claims) -> None:
    """Raises Interrupted or RunIsOver where this process must not go on with a file."""
    interrupts.check()
    _check_owner(job, request, claims)


def _check_owner(job: Job, request: Request, claims: Claims) -> None:
    """Raises RunIsOver where a later run makes the file, or the process is left of a run that has ended."""
    if request.helps is not None:
        claims.check()
    if not is_taken(job.target, claims.run):
        raise RunIsOver


def _handfuls(curves: Iterable[Curve], request: Request) -> Iterator[list[Curve]]:
    """Those that are meshed together; where a process has ended over one of them, each by itself."""
    if request.alone:
        return ([curve] for curve in curves)
    return meshing.handfuls(curves, lambda curve: curve.expected_triangles)


def plan_file(job: Job, request: Request) -> list[Record]:
    """Say what would be meshed, without meshing it. Returns the records of what could not be read, or is done already.

    Raises Interrupted.
    """
    none = Claims("no run")
    if request.resume and (done := done_by(job, request, none)) is not None:
        console.say(f"{job.name}: done already")
        return done
    try:
        open_file(job.source)
        objects = choose(request.objects)
    except InputError as error:
        records = [failed(job.name, None, "input", str(error))]
        console.show(records[0])
        return records
    depsgraph = bpy.context.evaluated_depsgraph_get()
    journal = Journal(job.target, none.run)
    records, earlier, wanted = [], 0, 0
    for obj in objects:
        interrupts.check()
        curve = read_curve(job, obj, depsgraph, request)
        if request.resume:
            curve = known(job, curve, journal)
        if curve.record is None:
            wanted += 1
            console.plan(name_of(job.name, obj.name), _size(curve.task), job.target)
            continue
        records.append(curve.record)
        if curve.record.status == "meshed":
            earlier += 1
        else:
            console.show(curve.record)
    if earlier:
        console.say(f"{job.name}: {earlier} {'curve is' if earlier == 1 else 'curves are'} meshed already")
    return records if wanted or earlier else _nothing_said(job, records)


def _mesh_opened(job: Job, request: Request, claims: Claims, number: int, journal: Journal) -> list[Record]:
    open_file(job.source)
    objects = choose(request.objects)
    progress = console.Progress("curves", len(objects))
    read = (
        known(job, curve, journal, claims.is_claimed(number, index))
        for index, curve in enumerate(_read(job, request, claims, objects))
    )
    curves = []
    for some in _handfuls(read, request):
        for curve in mesh_curves(job, some, journal):
            console.show(curve.record)
            curves.append(curve)
        progress.reached(len(curves), job.source.name if job.source else "")
    _check(job, request, claims)
    records = [curve.record for curve in curves]
    meshed = [curve for curve in curves if curve.record.status == "meshed"]
    if not meshed:
        return _nothing_said(job, records)
    failure = _write(job, request, claims, meshed)
    if failure is not None:
        console.show(failure)
        return [failure]
    return [replace(each, output=str(job.target)) if each.status == "meshed" else each for each in records]


def _write(job: Job, request: Request, claims: Claims, meshed: list[Curve]) -> Record | None:
    """Write the file of a job; the record of what has kept it from being written, if anything has."""
    try:
        made = write(meshed)
        _check_owner(job, request, claims)
        write_file(job.target, made)
    except RunIsOver:
        raise
    except OutputError as error:
        return failed(job.name, None, "output", str(error))
    except Exception as error:
        return internal(job, None, error)
    return None


def _nothing_said(job: Job, records: list[Record]) -> list[Record]:
    """The records of a file of which nothing is meshed; where none of them is a failure, the file is one."""
    if any(record.status == "failed" for record in records):
        return records
    nothing = failed(job.name, None, "nothing", "there is no planar closed curve in it to mesh")
    console.show(nothing)
    return [*records, nothing]


def _key(job: Job, request: Request, run: str) -> str:
    """What a file is made of: with the same again, it need not be made again."""
    source = str(job.source or bpy.data.filepath)
    about = os.stat(source) if os.path.exists(source) else None
    identity = [about.st_size, about.st_mtime_ns] if about else [run]  # what was never saved is another each time
    return json.dumps([source, identity, request.objects, asdict(request.settings)])


def _size(task: meshing.Task) -> str:
    """How large triangles would be, and of how many loops."""
    loops = sum(len(outline.loops) for outline in task.outlines)
    if task.settings.size_by == "TRIANGLE_COUNT":
        wanted = f"{task.settings.triangle_count} triangles"
    else:
        wanted = f"edge length {meshing.automatic_edge_length(task.outlines, task.settings):g}"
    return f"{loops} {'loop' if loops == 1 else 'loops'}, {wanted}"
