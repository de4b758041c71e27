"""More than one process: the same command in more Blenders, which share the work by claims.

As many files as processes, or more: each process makes whole files. Fewer: the processes mesh the curves of one file
after the other into its journal, and the leading process writes it.
"""

from __future__ import annotations

import subprocess
import sys
import time

import bpy

from . import console, interrupts
from .arguments import Request
from .batch import fill_journal, mesh_file
from .claims import Claims

# How often a process that has ended badly is started anew, in all.
_RESTARTS = 10
_PAUSE = 0.2


def work(request: Request) -> None:
    """Be one of the processes that help, until there is nothing left to claim."""
    claims = Claims(request.helps.name, request.helps)
    if request.alone:
        claims = claims.once_more()
    for number, job in enumerate(request.jobs):
        if not _by_files(request):
            fill_journal(job, request, claims, number)
        elif claims.claim(number):
            mesh_file(job, request, claims, number)


def run_workers(request: Request, words: list[str], claims: Claims) -> Claims:
    """Start the processes and wait until they have ended; one that ends badly is started anew a few times.

    Where one has ended over a handful of curves, what is missing is done once more, each curve by itself: the claims
    that are returned tell what was in hand in the end.
    """
    command = [*_blender(), *words, "--helps", str(claims.folder)]
    if _run(request, command, claims) and not _by_files(request):
        claims = claims.once_more()
        claims.folder.mkdir()
        _run(request, [*command, "--alone"], claims)
    return claims


def _run(request: Request, command: list[str], claims: Claims) -> bool:
    """Run the processes; whether one has ended badly."""
    claims.lead()
    count = min(request.workers, len(request.jobs)) if _by_files(request) else request.workers
    what = "files" if _by_files(request) else "curves"
    progress = console.Progress(what, len(request.jobs) if _by_files(request) else None)
    processes, restarts = [], _RESTARTS
    try:
        for number in range(count):
            processes.append(_start(command, claims, number))
        while processes:
            time.sleep(_PAUSE)
            interrupts.check()
            claims.lead()
            progress.reached(max(0, claims.count() - len(processes)))
            for process in [process for process in processes if process.poll() is not None]:
                processes.remove(process)
                if process.returncode and restarts:
                    restarts -= 1
                    console.say(f"a process ended with status {process.returncode}; another takes its place")
                    processes.append(_start(command, claims, count + _RESTARTS - restarts))
    finally:
        claims.end()
        for process in processes:  # if this one is stopped: each has its curves in hand
            process.wait()
    return restarts < _RESTARTS


def can_start() -> bool:
    """Whether this is the Blender program, and not the module, which cannot be started again."""
    return bool(bpy.app.binary_path) and _command_index() is not None


def _by_files(request: Request) -> bool:
    return len(request.jobs) >= request.workers


def _start(command: list[str], claims: Claims, number: int) -> subprocess.Popen:
    log = claims.folder.with_name(f"{claims.folder.name}-{number}.log")
    with open(log, "wb") as file:
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT)


def _blender() -> list[str]:
    """This Blender and its arguments up to the command's own, the open file among them."""
    return [bpy.app.binary_path, *sys.argv[1 : _command_index() + 2]]


def _command_index() -> int | None:
    """Where `--command tessera` is in the arguments."""
    for index, word in enumerate(sys.argv[:-1]):
        if word in ("-c", "--command") and sys.argv[index + 1] == "tessera":
            return index
    return None
