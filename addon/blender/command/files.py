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
    target = _absolute(output)
    several = len(inputs) > 1 or any(_absolute(each).is_dir() or not _absolute(each).exists() for each in inputs)
    if not several:
        source = _absolute(inputs[0]) if inputs else None
        _check_sources([source] if source else [])
        return [Job(source, _checked_file(target, format))]
    sources = sorted({path for each in inputs for path in _expand(each)})
    _check_sources(sources)
    if (os.path.exists(target) and not os.path.isdir(target)) or not os.path.isdir(target.parent):
        raise ValueError(f"'{target}' cannot be written: for several inputs, give a folder, in a folder that exists")
    jobs = [Job(source, target / f"{source.stem}.{format or 'blend'}") for source in sources]
    _check_targets(jobs)
    return jobs


def _absolute(path: str) -> Path:
    return Path(os.path.abspath(os.path.expanduser(path)))


def _checked_file(target: Path, format: str | None) -> Path:
    if os.path.isdir(target) or not os.path.isdir(target.parent):  # which take any length of name
        raise ValueError(f"'{target}' cannot be written: give a file in a folder that exists")
    ending = target.suffix.lower().removeprefix(".")
    if ending not in FORMATS or format not in (None, ending):
        wanted = f".{format}" if format else ", ".join(f".{each}" for each in FORMATS)
        raise ValueError(f"'{target.name}' has another ending than the formats that can be written: {wanted}")
    return target


def _expand(word: str) -> list[Path]:
    """The files that a word of the command line means; of a folder or glob, those that can be read."""
    path = _absolute(word)
    if path.is_file():
        return [path]
    found = path.iterdir() if path.is_dir() else map(Path, glob.glob(str(path), recursive=True))
    readable = [each for each in found if each.suffix.lower() in _READABLE and each.is_file()]
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
    sources = {job.source for job in jobs}
    for job in jobs:
        if job.target in seen:
            both = f"'{seen[job.target]}' and '{job.source}'"
            raise ValueError(f"{both} would both be written to '{job.target}': give them one by one")
        if job.target in sources:
            raise ValueError(f"'{job.target}' is an input, and would be written over: give another folder")
        seen[job.target] = job.source
