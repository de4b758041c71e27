"""Which process does what: processes that share work claim it with files, so that no two do the same. No `bpy` here.

The process that leads keeps the folder of claims, and shows with the file `alive` that it still runs; helpers stop soon
after it has ended, and at once when it or a later run has removed that.
"""

from __future__ import annotations

import os
import shutil
import time
from dataclasses import dataclass
from pathlib import Path

# Seconds without a sign of the leading process after which helpers stop.
PATIENCE = 15.0


class RunIsOver(Exception):
    """The leading process has ended, or a later run has begun, in words for the user."""

    def __init__(self) -> None:
        super().__init__("stopped, as a later run makes the same files")


@dataclass(frozen=True)
class Claims:
    """run: the name of this run; folder: where claims are, or None where one process does everything."""

    run: str
    folder: Path | None = None

    def once_more(self) -> Claims:
        """Claims of the same run in which nothing is claimed yet."""
        return Claims(self.run, self.folder.with_name(f"{self.folder.name}-again"))

    def claim(self, job: int, curve: int | None = None) -> bool:
        """Whether this process is the first to take a job, or a curve of it. Raises RunIsOver."""
        self.check()
        try:
            os.close(os.open(self._path(job, curve), os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return False
        except FileNotFoundError:
            raise RunIsOver from None
        return True

    def is_claimed(self, job: int, curve: int | None = None) -> bool:
        """Whether any process has taken it."""
        return self.folder is not None and self._path(job, curve).exists()

    def count(self) -> int:
        """How much has been claimed."""
        return sum(entry.name != "alive" for entry in os.scandir(self.folder))

    def check(self) -> None:
        """Raises RunIsOver where no process leads any longer."""
        try:
            led = time.time() - os.stat(self.folder / "alive").st_mtime < PATIENCE
        except FileNotFoundError:
            led = False
        if not led:
            raise RunIsOver

    def lead(self) -> None:
        """Show that the leading process still runs. Raises RunIsOver where a later run has begun."""
        try:
            (self.folder / "alive").touch()
        except FileNotFoundError:
            raise RunIsOver from None

    def end(self) -> None:
        """Lead no longer."""
        (self.folder / "alive").unlink(missing_ok=True)

    def remove(self) -> None:
        """Nothing is claimed any longer, nor once more."""
        for folder in (self.folder, self.once_more().folder):
            shutil.rmtree(folder, ignore_errors=True)  # what stays, a later run removes

    def _path(self, job: int, curve: int | None) -> Path:
        return self.folder / (f"{job}" if curve is None else f"{job}-{curve}")
