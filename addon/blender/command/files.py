"""Which files are read, and which are written. No `bpy` here."""

from __future__ import annotations

import glob
import os
from dataclasses import dataclass
from pathlib import Path

FORMATS = ("blend", "obj", "stl", "ply", "glb")
OPEN_FILE = "the open file"
_READABLE = (".blend", ".svg")


@dataclass(frozen=True)
class Job:
    """One file to write, and what it is made of: a file to open, or None for what is open already."""

    source: Path | None
    target: Path

    @property
    def name(self) -> str:
        """What the user sees."""
        return str(self.source) if self.source else OPEN_FILE


def jobs_of(inputs: list[str], output: str, format: str | None) -> list[Job]:
    """The jobs of the inputs (files, folders, globs; none: the open file). Raises ValueError.

    With one file, or none, the output is a file, else a folder: which is made later, in a folder that is there.
    """
    if "" in inputs:
        raise ValueError("an INPUT is empty: give a file, a folder ('.' is the one you are in), or a glob")
    if not output:
        raise ValueError("--output is empty, so nothing can be written: give a file or a folder")
    target = absolute(output)
    if len(inputs) > 1 or not all(os.path.isfile(absolute(each)) for each in inputs):
        sources = sorted({path for each in inputs for path in _expand(each)})
        _check_folder(target)
        jobs = [Job(source, target / f"{source.stem}.{format or 'blend'}") for source in sources]
    else:
        jobs = [Job(absolute(inputs[0]) if inputs else None, _checked_file(target, format))]
    _check_sources([job.source for job in jobs if job.source])
    _check_targets(jobs)
    return jobs


def absolute(path: str) -> Path:
    """The path from the root on, with ~ as the user's own folder."""
    return Path(os.path.abspath(os.path.expanduser(path)))


def identity(path: str | Path) -> tuple[int, int] | str:
    """Equal for paths that name one file, by links or not, and whether it is there yet or not."""
    try:
        about = os.stat(path)
    except OSError:
        return os.path.realpath(path)
    return about.st_dev, about.st_ino


def _check_folder(target: Path) -> None:
    there = os.path.isdir(target)
    if (os.path.exists(target) and not there) or not os.path.isdir(target.parent):
        raise ValueError(f"'{target}' cannot be written: for several inputs, give a folder, in a folder that exists")
    ending = target.suffix.lower().removeprefix(".")
    if ending in FORMATS and not there:
        remedy = f"give a folder, and the format with --format {ending}"
        raise ValueError(f"'{target.name}' would be a folder, as each input gives one file: {remedy}")


def _checked_file(target: Path, format: str | None) -> Path:
    if os.path.isdir(target) or not os.path.isdir(target.parent):
        raise ValueError(f"'{target}' cannot be written: give a file in a folder that exists")
    ending = target.suffix.lower().removeprefix(".")
    if ending not in FORMATS or format not in (None, ending):
        wanted = f".{format}" if format else ", ".join(f".{each}" for each in FORMATS)
        raise ValueError(f"'{target.name}' has another ending than the formats that can be written: {wanted}")
    return target


def _expand(word: str) -> list[Path]:
    """The files that a word of the command line means; of a folder or glob, those that can be read."""
    path = absolute(word)  # of any length: what os.path and glob ask, they ask without an error
    if os.path.isfile(path):
        return [path]
    try:
        found = path.iterdir() if os.path.isdir(path) else map(Path, glob.glob(str(path), recursive=True))
        readable = [each for each in found if each.suffix.lower() in _READABLE and os.path.isfile(each)]
    except OSError as error:
        raise ValueError(f"the folder '{word}' cannot be read: {error.strerror}") from error
    if not readable:
        raise ValueError(f"'{word}' is no file, and no folder or glob of .blend or .svg files")
    return readable


def _check_sources(sources: list[Path]) -> None:
    for source in sources:
        if source.suffix.lower() not in _READABLE:
            raise ValueError(f"'{source}' is neither a .blend nor an .svg file")


def _check_targets(jobs: list[Job]) -> None:
    """No two inputs give one file, and no input is written over."""
    seen: dict[Path, Path] = {}
    sources = {identity(job.source) for job in jobs if job.source}
    for job in jobs:
        if job.target in seen:
            both = f"'{seen[job.target]}' and '{job.source}'"
            raise ValueError(f"{both} would both be written to '{job.target}': give them one by one")
        if identity(job.target) in sources:
            raise ValueError(f"'{job.target}' is an input, and would be written over: give another --output")
        seen[job.target] = job.source
