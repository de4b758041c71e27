"""One file: its curves are read, meshed a handful at a time, and written."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace

import bpy

from .. import meshing
from . import console
from .arguments import Request
from .claims import Claims
from .curves import Curve, known, mesh_curves, read_curve, write
from .files import Job
from .inputs import InputError, choose, open_file
from .journal import Journal, read_done, write_done
from .outputs import OutputError, write_file
from .records import Record, failed, name_of


def mesh_file(job: Job, request: Request, claims: Claims, number: int = 0) -> list[Record]:
    """Make the file of a job, and note in its journal that it is done. What the journal has already is not done again.

    number: of the job, by which processes claim it.
    """
    records = done_by(job, request, claims)
    if records is not None:
        for record in records:
            console.show(record)
        return records
    key = _key(job, request, claims.run)
    journal = Journal(job.target, claims.run)
    try:
        records = _mesh_opened(job, request, claims, number, journal)
    except (InputError, OutputError) as error:
        reason = "input" if isinstance(error, InputError) else "output"
        records = [failed(job.name, None, reason, str(error))]
        console.show(records[0])
    finally:
        journal.close()
    write_done(job.target, key, claims.run, [asdict(record) for record in records])
    if all(record.status != "failed" for record in records):
        journal.drop()
    return records


def done_by(job: Job, request: Request, claims: Claims) -> list[Record] | None:
    """The records of a file that this run or an earlier one has made, else None."""
    done = read_done(job.target, _key(job, request, claims.run), claims.run)
    return None if done is None else [Record(**record) for record in done]


def fill_journal(job: Job, request: Request, claims: Claims, number: int) -> None:
    """Mesh those curves of a file that this process can claim, into the journal; the file itself is written later."""
    if done_by(job, request, claims) is not None:
        return
    try:
        open_file(job.source)
        objects = choose(request.objects)
    except InputError:
        return  # said by the process that writes the file
    journal = Journal(job.target, claims.run)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    own = (
        known(job, read_curve(job, obj, depsgraph, request), journal)
        for index, obj in enumerate(objects)
        if claims.claim(number, index)
    )
    for some in _handfuls(own, request):
        mesh_curves(job, some, journal)
    journal.close()


def _handfuls(curves: Iterable[Curve], request: Request) -> Iterator[list[Curve]]:
    """Those that are meshed together; where a process has ended over one of them, each by itself."""
    if request.alone:
        return ([curve] for curve in curves)
    return meshing.handfuls(curves, lambda curve: curve.expected_triangles)


def plan_file(job: Job, request: Request) -> list[Record]:
    """Say what would be meshed, without meshing it. Returns the records of what could not be read."""
    try:
        open_file(job.source)
        objects = choose(request.objects)
    except InputError as error:
        records = [failed(job.name, None, "input", str(error))]
        console.show(records[0])
        return records
    depsgraph = bpy.context.evaluated_depsgraph_get()
    curves = [read_curve(job, obj, depsgraph, request) for obj in objects]
    for curve in curves:
        if curve.task is None:
            console.show(curve.record)
        else:
            print(f"{name_of(job.name, curve.task.obj.name)}: {_size(curve.task)} -> {job.target}")
    records = [curve.record for curve in curves if curve.record is not None]
    return records if len(records) < len(curves) else _nothing_said(job, records)


def _mesh_opened(job: Job, request: Request, claims: Claims, number: int, journal: Journal) -> list[Record]:
    open_file(job.source)
    objects = choose(request.objects)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    progress = console.Progress("curves", len(objects))
    curves = []
    read = (
        known(job, read_curve(job, obj, depsgraph, request), journal, claims.is_claimed(number, index))
        for index, obj in enumerate(objects)
    )
    for some in _handfuls(read, request):
        for curve in mesh_curves(job, some, journal):
            console.show(curve.record)
            curves.append(curve)
        progress.reached(len(curves), job.source.name if job.source else "")
    records = [curve.record for curve in curves]
    meshed = [curve for curve in curves if curve.record.status == "meshed"]
    if not meshed:
        return _nothing_said(job, records)
    write_file(job.target, write(meshed))
    return [replace(each, output=str(job.target)) if each.status == "meshed" else each for each in records]


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
