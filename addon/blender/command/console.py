"""What the user reads while it runs: results on standard output, all else on standard error."""

from __future__ import annotations

import re
import sys
import time
from pathlib import Path

from .records import Record

# Seconds between two lines of progress.
INTERVAL = 5.0


def say(text: str) -> None:
    """A line on standard error."""
    print(_one_line(f"tessera: {text}"), file=sys.stderr, flush=True)


def show(record: Record) -> None:
    """The line of a curve, and its warnings."""
    if record.status == "failed":
        print(_one_line(record.line), file=sys.stderr, flush=True)
        return
    print(_one_line(record.line), flush=True)
    for warning in record.warnings:
        print(_one_line(f"{record.name}: warning: {warning}"), file=sys.stderr, flush=True)


def plan(name: str, what: str, target: Path) -> None:
    """The line of a curve that would be meshed."""
    print(_one_line(f"{name}: {what} -> {target}"), flush=True)


def _one_line(text: str) -> str:
    """What would end the line or move the cursor, such as in an object's name, is shown as it is written in Python."""
    return re.sub(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]", lambda found: ascii(found[0])[1:-1], text)


class Progress:
    """Lines such as `tessera: 120 of 400 curves, 31.2 a second, 9 s left`, one in a few seconds."""

    def __init__(self, what: str, total: int | None) -> None:
        self._what, self._total = what, total
        self._start = self._said = time.monotonic()

    def reached(self, done: int, detail: str = "") -> None:
        """So many are done."""
        now = time.monotonic()
        if now - self._said < INTERVAL:
            return
        self._said = now
        text = f"{done} {self._what}" if self._total is None else f"{done} of {self._total} {self._what}"
        if done:
            rate = done / (now - self._start)
            text += f", {rate:.3g} a second"
            if self._total is not None:
                text += f", {_duration((self._total - done) / rate)} left"
        say(f"{text}{', ' if detail else ''}{detail}")


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
