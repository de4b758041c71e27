"""What is asked for on the command line. No `bpy` here."""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass
from pathlib import Path

from ..options import add_options, settings_from
from ..settings import Settings
from .files import FORMATS, Job, absolute, identity, jobs_of

_EXAMPLES = """examples:
  every curve and text of a scene, beside them in a copy of the file:
    blender -b scene.blend --command tessera mesh --output out.blend

  one curve at edges of 5 cm, as an STL file:
    blender -b scene.blend --command tessera mesh --objects Logo --edge-length 0.05 --output logo.stl

  a folder of drawings, four at a time, a .glb for each, and what became of every curve:
    blender -b --command tessera mesh drawings --output meshes --format glb --jobs 4 --report report.json

  the same again after it was stopped, or after some drawings were mended:
    blender -b --command tessera mesh drawings --output meshes --format glb --jobs 4 --report report.json --resume

exit status: 0 all were meshed, 1 some failed or nothing was there, 2 the command was not understood, 130 Ctrl-C
"""


class UsageError(Exception):
    """What is asked for cannot be: said before anything is opened or meshed."""


@dataclass(frozen=True)
class Request:
    """jobs: what to open and what to write; objects: names, or None for all; workers: how many processes there are.

    helps: the folder of the run that this process is a worker of, or None; alone: whether to mesh each by itself.
    """

    jobs: tuple[Job, ...]
    settings: Settings
    objects: tuple[str, ...] | None
    report: Path | None
    workers: int
    resume: bool
    dry_run: bool
    helps: Path | None
    alone: bool


def parse(words: list[str]) -> Request:
    """The request that the words make. Raises UsageError, and SystemExit where argparse has said all (--help too)."""
    options = _parser().parse_args(words)
    if options.jobs < 1:
        raise UsageError("--jobs is a number of processes, 1 or more")
    try:
        jobs = jobs_of(options.inputs, options.output, options.format)
    except ValueError as error:
        raise UsageError(str(error)) from error
    report = None if options.report is None else absolute(options.report)
    if report is not None:
        _check_report(report, jobs)
    return Request(
        jobs=tuple(jobs),
        settings=settings_from(options),
        objects=tuple(dict.fromkeys(options.objects)) if options.objects else None,
        report=report,
        workers=options.jobs,
        resume=options.resume,
        dry_run=options.dry_run,
        helps=Path(options.helps) if options.helps else None,
        alone=options.alone,
    )


def _check_report(report: Path, jobs: list[Job]) -> None:
    """Raises UsageError where it could not be written, or would take another file's place."""
    if not os.path.isdir(report.parent):
        raise UsageError(f"there is no folder '{report.parent}' for the report")
    if os.path.isdir(report):
        raise UsageError(f"'{report}' is a folder: give --report a file")
    others = {identity(path) for job in jobs for path in (job.source, job.target) if path}
    if identity(report) in others:
        raise UsageError(f"'{report}' is an input or the output, and --report would write over it: give another file")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="blender -b [SCENE.blend] --command tessera", description="Planar closed curves to even triangle meshes."
    )
    verbs = parser.add_subparsers(dest="verb", required=True)
    mesh = verbs.add_parser(
        "mesh",
        usage="%(prog)s [INPUT ...] --output PATH [OPTION ...]",
        help="mesh the planar closed curves and texts of a scene or of files",
        description="Mesh the planar closed curves and texts of the open file, or of each INPUT. A line for each goes "
        "to standard output; progress, warnings and errors go to standard error.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    mesh.add_argument("inputs", nargs="*", metavar="INPUT", help=".blend or .svg files, folders or globs of them")
    mesh.add_argument(
        "--output",
        required=True,
        metavar="PATH",
        help="the file to write; for several inputs, a folder or a glob: the folder, for a file of each input's name",
    )
    mesh.add_argument("--format", choices=FORMATS, help="of the output: by the ending of PATH, or blend in a folder")
    mesh.add_argument(
        "--objects", nargs="+", metavar="NAME", help="the objects to mesh (all curves and texts that are not hidden)"
    )
    mesh.add_argument("--report", metavar="FILE.json", help="write a record of each curve")
    mesh.add_argument("--jobs", type=int, default=1, metavar="N", help="so many Blender processes (1)")
    mesh.add_argument("--resume", action="store_true", help="what an earlier run has done is not done again")
    mesh.add_argument("--dry-run", action="store_true", help="say what would be meshed; mesh and write nothing")
    mesh.add_argument("--helps", help=argparse.SUPPRESS)
    mesh.add_argument("--alone", action="store_true", help=argparse.SUPPRESS)
    add_options(mesh)
    return parser
