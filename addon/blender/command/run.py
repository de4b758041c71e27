"""The command from its words to its exit status."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator

import bpy

from . import console, interrupts
from .arguments import Request, UsageError, parse
from .claims import Claims, RunIsOver
from .files import identity
from .inputs import InputError, choose
from .journal import folder_of, forget, is_taken, take
from .records import Record, exit_status, failed, summary, write_report


def run(arguments: list[str]) -> int:
    """Exit status: 0 all were meshed, 1 some failed or there was nothing, 2 usage, 130 stopped by Ctrl-C."""
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
        with interrupts.heeded():
            if request.helps is not None:
                return _help(request)
            return _plan(request) if request.dry_run else _lead(request, arguments)
    except (tessera.RuntimeProblem, interrupts.Interrupted, RunIsOver, OSError) as error:
        console.say(_reason(error))
        return 130 if isinstance(error, interrupts.Interrupted) else 1


def _reason(error: Exception) -> str:
    """Why the run was stopped, for the user."""
    if isinstance(error, OSError):  # of the journal: the disk is full, or the folder cannot be read or written
        where = f" at '{error.filename}'" if error.filename else ""
        return f"stopped{where}: {error.strerror}; once that is mended, the same command with --resume goes on"
    return str(error)


def _check(request: Request) -> None:
    """Raise where it is known before anything is done that it cannot be done."""
    from . import workers

    if request.workers > 1 and not workers.can_start():
        raise UsageError("--jobs needs the Blender program: the bpy module cannot be started again")
    if request.jobs[0].source is None:
        _check_open_file(request)
    result = request.settings.result
    if request.settings.keep_linked and result != "NEW" and request.helps is None:
        console.say(f"warning: --keep-linked has no effect with --result {result.lower()}: leave one of them out")


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
    try:
        records = _mesh(request, words, claims)
    except RunIsOver:  # and the report is the later run's, too
        raise
    except Exception as error:
        from .batch import so_far

        records = [record for job in request.jobs for record in so_far(job, request, claims)]
        _report(request, records, time.monotonic() - start, _reason(error))
        raise
    finally:
        if claims.folder is not None:
            claims.remove()
    seconds = time.monotonic() - start
    if exit_status(records) == 0 and not request.resume:
        for job in request.jobs:
            if is_taken(job.target, claims.run):
                forget(job.target)
    console.say(summary(records, seconds))
    return exit_status(records) if _report(request, records, seconds) else 1


def _mesh(request: Request, words: list[str], claims: Claims) -> list[Record]:
    if claims.folder is not None:
        from . import workers

        claims = workers.run_workers(request, words, claims)
    return list(_records(request, claims))


def _prepare(request: Request) -> Claims:
    """The folder to write to is made, and an earlier run's journals are removed, or its processes' claims alone."""
    request.jobs[0].target.parent.mkdir(exist_ok=True)
    run = f"run-{time.time_ns():x}-{os.getpid():x}"
    for job in request.jobs:
        folder = folder_of(job.target)
        if not request.resume:
            forget(job.target)
        for old in (*folder.glob("run-*/"), *folder.glob("new-*/")):
            shutil.rmtree(old, ignore_errors=True)
        for old in folder.glob("*.log"):
            old.unlink()
        take(job.target, run)
    if request.workers == 1:
        return Claims(run)
    claims = Claims(run, folder_of(request.jobs[0].target) / run)
    claims.folder.mkdir()
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


def _report(request: Request, records: list[Record], seconds: float, stopped: str | None = None) -> bool:
    """Write the report, if one is wanted; whether it is as it should be."""
    if request.report is None:
        return True
    try:
        write_report(request.report, records, request.settings, seconds, bpy.app.version_string, stopped)
    except OSError as error:
        console.say(f"the report was not written: {error}")
        return False
    return True
