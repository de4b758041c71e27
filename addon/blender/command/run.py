"""The command from its words to its exit status."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator

import bpy

from . import console
from .arguments import Request, UsageError, parse
from .claims import Claims, RunIsOver
from .files import identity
from .inputs import InputError, choose
from .journal import folder_of, forget
from .records import Record, exit_status, failed, summary, write_report


def run(arguments: list[str]) -> int:
    """Exit status: 0 all were meshed, 1 some failed or there was nothing, 2 usage."""
    try:
        request = parse(arguments)
        _check(request)
    except (UsageError, InputError) as error:
        console.say(str(error))
        return 2
    except SystemExit as end:  # argparse's
        return int(end.code or 0)
    from ... import tessera  # here, so that enabling the add-on does not load the mesher

    try:
        if request.helps is not None:
            return _help(request)
        return _plan(request) if request.dry_run else _lead(request, arguments)
    except tessera.RuntimeProblem as problem:
        console.say(str(problem))
    except OSError as error:  # of the journal: the disk is full, or the folder cannot be written to
        console.say(f"stopped, as '{error.filename}' cannot be written: {error.strerror}")
    return 1


def _check(request: Request) -> None:
    """Raise where it is known before anything is done that it cannot be done."""
    from . import workers

    if request.workers > 1 and not workers.can_start():
        raise UsageError("--jobs needs the Blender program: the bpy module cannot be started again")
    if request.jobs[0].source is None:
        _check_open_file(request)


def _check_open_file(request: Request) -> None:
    """Raise where the open file is an input, and would be written over, or has not the objects that are named."""
    for option, path in (("--output", request.jobs[0].target), ("--report", request.report)):
        if path and bpy.data.filepath and identity(path) == identity(bpy.data.filepath):
            raise UsageError(f"'{path}' is the open file, and would be written over: give another {option}")
    if request.objects is not None:
        choose(request.objects)


def _help(request: Request) -> int:
    """Be one of several processes."""
    from . import workers

    try:
        workers.work(request)
    except RunIsOver:
        return 3
    return 0


def _plan(request: Request) -> int:
    from .batch import plan_file

    records = [record for job in request.jobs for record in plan_file(job, request)]
    return 1 if any(record.status == "failed" for record in records) else 0


def _lead(request: Request, words: list[str]) -> int:
    """Mesh everything, in this process or with others, and say what became of it."""
    start = time.monotonic()
    claims = _prepare(request)
    folder = claims.folder
    if folder is not None:
        from . import workers

        claims = workers.run_workers(request, words, claims)
    records = list(_records(request, claims))
    seconds = time.monotonic() - start
    if folder is not None:
        for each in {folder, claims.folder}:
            shutil.rmtree(each)
    if exit_status(records) == 0 and not request.resume:
        for job in request.jobs:
            forget(job.target)
    console.say(summary(records, seconds))
    return _reported(request, records, seconds)


def _prepare(request: Request) -> Claims:
    """The folder to write to is made, and an earlier run's journals are removed, or its processes' claims alone."""
    request.jobs[0].target.parent.mkdir(exist_ok=True)
    run = f"{time.time_ns():x}-{os.getpid():x}"
    first = folder_of(request.jobs[0].target)
    for old in first.glob("run-*/"):  # folders
        shutil.rmtree(old, ignore_errors=True)
    for old in first.glob("*.log"):
        old.unlink()
    if not request.resume:
        for job in request.jobs:
            forget(job.target)
    for job in request.jobs:
        folder_of(job.target).mkdir(parents=True, exist_ok=True)
    if request.workers == 1:
        return Claims(run)
    claims = Claims(f"run-{run}", first / f"run-{run}")
    claims.folder.mkdir(parents=True)
    return claims


def _records(request: Request, claims: Claims) -> Iterator[Record]:
    """Of all files, each made now, or by another process of this run, or by an earlier run."""
    from .batch import done_by, mesh_file

    progress = console.Progress("files", len(request.jobs))
    for number, job in enumerate(request.jobs):
        if claims.is_claimed(number) and not done_by(job, request, claims):
            message = "the process that had it in hand ended: see its output in the folder .tessera, or run --resume"
            records = [failed(job.name, None, "process", message)]
            console.show(records[0])
        else:
            records = mesh_file(job, request, claims, number)
        yield from records
        if len(request.jobs) > 1:
            progress.reached(number + 1)


def _reported(request: Request, records: list[Record], seconds: float) -> int:
    """Write the report, if one is wanted; the exit status."""
    status = exit_status(records)
    if request.report is not None:
        try:
            write_report(request.report, records, request.settings, seconds, bpy.app.version_string)
        except OSError as error:
            console.say(f"the report was not written: {error}")
            status = 1
    return status
