"""What a run has done so far, so that a run that was killed can be taken up again. No `bpy` here.

Beside each file that is written there is the folder `.tessera/NAME/` while it is in work. Every process appends to
files of its own there: the arrays of a curve to `RUN-PID.bin`, then its line to `RUN-PID.jsonl`. A curve counts once
its line is whole, so that a kill loses what is in hand alone. `done.json` is written when the file itself is. What
another version of the add-on has done does not count, so that no run mixes the meshes of two.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
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
        self.entries = self._read()

    def add(self, key: str, record: dict, arrays: list[np.ndarray]) -> Entry:
        """A curve is done. The arrays may be of any shape and dtype."""
        if self._lines is None:
            stem = self.folder / f"{self._run}-{os.getpid()}"
            self._arrays = open(f"{stem}.bin", "ab")
            self._lines = open(f"{stem}.jsonl", "a", encoding="utf-8")
        offset = self._arrays.tell()
        for array in arrays:
            np.save(self._arrays, array, allow_pickle=False)
        self._arrays.flush()
        line = {"version": version(), "key": key, "offset": offset, "count": len(arrays), "record": record}
        self._lines.write(json.dumps(line) + "\n")
        self._lines.flush()
        self.entries[key] = Entry(record, Path(self._arrays.name), offset, len(arrays))
        return self.entries[key]

    def close(self) -> None:
        """Close the files; nothing can be added afterwards."""
        for file in (self._arrays, self._lines):
            if file is not None:
                file.close()

    def _read(self) -> dict[str, Entry]:
        """Whole lines of all processes. Failures count in their own run only: a later one tries them again."""
        entries = {}
        for path in sorted(self.folder.glob("*.jsonl")):
            for line in _whole_lines(path):
                earlier = not path.name.startswith(f"{self._run}-")
                if line.get("version") == version() and (line["count"] or not earlier):
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
    path = folder_of(target) / "done.json"
    if not path.exists():
        return None
    done = json.loads(path.read_text(encoding="utf-8"))
    if done["run"] == run:
        return done["records"]
    failed = any(record["status"] == "failed" for record in done["records"])
    if failed or (done.get("version"), done["key"]) != (version(), key) or not target.exists():
        return None
    return [record | {"earlier": True} for record in done["records"]]


def drop_arrays(target: Path) -> None:
    """The file is written, and everything in it was meshed: what was kept of each curve is needed no longer."""
    for path in (*folder_of(target).glob("*.bin"), *folder_of(target).glob("*.jsonl")):
        path.unlink()


def forget(target: Path) -> None:
    """Remove the journal of a file, and the folder of all journals where it was the last."""
    shutil.rmtree(folder_of(target), ignore_errors=True)
    parent = target.parent / FOLDER
    if parent.is_dir() and not any(parent.iterdir()):
        parent.rmdir()


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


def _whole_lines(path: Path) -> list[dict]:
    """The lines of a file whose last one may have been cut off."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").split("\n")[:-1]]
