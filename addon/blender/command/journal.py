"""What a run has done so far, so that a run that was killed can be taken up again. No `bpy` here.

Beside each file that is written there is the folder `.tessera/NAME/` while it is in work. Every process appends to
files of its own there: the arrays of a curve to `RUN-PID.bin`, then its line to `RUN-PID.jsonl`. A curve counts once
its line is whole, so that a kill loses what is in hand alone. `done.json` is written when the file itself is. What
another version of the add-on has done does not count, so that no run mixes the meshes of two; nor does what a power cut
or a full disk has damaged. `run` names the run whose the file is: an earlier one, whose processes may still end, leaves
it alone from then on.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

FOLDER = ".tessera"


@dataclass(frozen=True)
class Entry:
    """A curve that was meshed or failed: its record, where its arrays are, and whether an earlier run has added it."""

    record: dict
    file: Path
    offset: int
    count: int
    earlier: bool = False


def folder_of(target: Path) -> Path:
    """Where the journal of a file to write is kept."""
    return target.parent / FOLDER / target.name


@cache
def version() -> str:
    """A word for the code and the networks that meshes are made by."""
    root, digest = Path(__file__).parents[3], hashlib.sha256()
    for path in sorted((*root.glob("addon/**/*.py"), *root.glob("onnx_models/*.onnx"))):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


class Journal:
    """What is known of one file to write, and a place to add to it; `run` names the run that adds."""

    def __init__(self, target: Path, run: str) -> None:
        self.folder, self._run = folder_of(target), run
        self._arrays = self._lines = None
        self._paths = sorted(self.folder.glob("*.jsonl"))
        self.entries = self._read()

    def add(self, key: str, record: dict, arrays: list[np.ndarray]) -> Entry:
        """A curve is done. The arrays may be of any shape and dtype. Raises OSError with the path of a file."""
        raw = io.BytesIO()
        for array in arrays:
            np.save(raw, array, allow_pickle=False)
        raw = raw.getvalue()
        stem = self.folder / f"{self._run}-{os.getpid()}"
        try:
            if self._lines is None:
                self._arrays = open(f"{stem}.bin", "ab")
                self._lines = open(f"{stem}.jsonl", "a", encoding="utf-8")
                self._paths.append(Path(self._lines.name))
            offset = self._arrays.tell()
            self._arrays.write(raw)
            self._arrays.flush()
            line = {"version": version(), "key": key, "offset": offset, "length": len(raw), "count": len(arrays)}
            line |= {"record": record, "check": _check(key, record, raw)}
            self._lines.write(json.dumps(line) + "\n")
            self._lines.flush()
        except OSError as error:  # that of a full disk names no file
            raise OSError(error.errno, error.strerror, f"{stem}.bin") from error
        self.entries[key] = Entry(record, Path(self._arrays.name), offset, len(arrays))
        return self.entries[key]

    def close(self) -> None:
        """Close the files; nothing can be added afterwards."""
        for file in (self._arrays, self._lines):
            if file is not None:
                with suppress(OSError):  # of what `add` could not write, and has said
                    file.close()

    def drop(self) -> None:
        """The file is written, and everything in it was meshed: what was read and added here is needed no longer."""
        for path in self._paths:
            path.with_suffix(".bin").unlink(missing_ok=True)
            path.unlink(missing_ok=True)

    def _read(self) -> dict[str, Entry]:
        """Whole entries of all processes. Failures count in their own run only: a later one tries them again."""
        entries = {}
        for path in self._paths:
            earlier = not path.name.startswith(f"{self._run}-")
            for line in _whole_lines(path):
                if line["count"] or not earlier:
                    where = path.with_suffix(".bin"), line["offset"], line["count"]
                    entries[line["key"]] = Entry(line["record"], *where, earlier)
        return entries


def load(entry: Entry) -> list[np.ndarray]:
    """The arrays of a curve that is done."""
    with open(entry.file, "rb") as file:
        file.seek(entry.offset)
        return [np.load(file, allow_pickle=False) for _ in range(entry.count)]


def write_done(target: Path, key: str, run: str, records: list[dict]) -> None:
    """The file is written, or cannot be: what became of it, for a later run with the same key or for the same run."""
    done = {"version": version(), "key": key, "run": run, "records": records}
    write_atomically(folder_of(target) / "done.json", json.dumps(done))


def read_done(target: Path, key: str, run: str) -> list[dict] | None:
    """The records of a file that is done: in this run, or in an earlier one without a failure, and they say so. Else
    None."""
    try:
        done = json.loads((folder_of(target) / "done.json").read_bytes())
    except (FileNotFoundError, ValueError):  # not there, or damaged
        return None
    if not isinstance(done, dict) or done.get("version") != version():
        return None
    if done["run"] == run:
        return done["records"]
    failed = any(record["status"] == "failed" for record in done["records"])
    if failed or done["key"] != key or not target.exists():
        return None
    return [record | {"earlier": True} for record in done["records"]]


def take(target: Path, run: str) -> None:
    """From now on the file is this run's."""
    folder_of(target).mkdir(parents=True, exist_ok=True)
    write_atomically(folder_of(target) / "run", run)


def is_taken(target: Path, run: str) -> bool:
    """Whether the file is still this run's."""
    try:
        return (folder_of(target) / "run").read_bytes() == run.encode()
    except FileNotFoundError:
        return False


def forget(target: Path) -> None:
    """Remove the journal of a file, and the folder of all journals where it was the last."""
    shutil.rmtree(folder_of(target), ignore_errors=True)
    with suppress(OSError):  # not there, or not empty, as another file is in work
        (target.parent / FOLDER).rmdir()


def write_atomically(path: Path, text: str) -> None:
    """The file is there with all of the text, or as it was before. Raises OSError with its path."""
    new = path.with_name(f"{path.name}.{os.getpid()}.new")
    try:
        new.write_text(text, encoding="utf-8")
        os.replace(new, path)
    except OSError as error:
        if os.path.exists(new):
            os.remove(new)
        raise OSError(error.errno, error.strerror, str(path)) from error


def _whole_lines(path: Path) -> Iterator[dict]:
    """The lines of a file that are whole, as their arrays are; any may have been cut off or damaged."""
    arrays = path.with_suffix(".bin")
    if not arrays.exists():
        return
    with open(arrays, "rb") as file:
        for text in path.read_bytes().split(b"\n"):
            try:
                line = json.loads(text)
            except ValueError:
                continue
            if not isinstance(line, dict) or line.get("version") != version():
                continue
            file.seek(line["offset"])
            if line["check"] == _check(line["key"], line["record"], file.read(line["length"])):
                yield line


def _check(key: str, record: dict, raw: bytes) -> int:
    """A number that another key, record or arrays would hardly have."""
    return zlib.crc32(json.dumps([key, record]).encode(), zlib.crc32(raw))
