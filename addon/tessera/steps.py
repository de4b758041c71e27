"""Long work in steps: generators that yield how far they are and return what they make.

Whoever drives one may stop between two steps, and nothing is half done: what is made comes at the end.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import TypeVar

Result = TypeVar("Result")


@dataclass(frozen=True)
class Progress:
    """stage: what was worked on, a key of ``Report.seconds``; share: of the whole work that is done, 0 to 1."""

    stage: str
    share: float


Steps = Generator[Progress, None, Result]


def finish(steps: Steps[Result]) -> Result:
    """Take all steps at once: what they make."""
    while True:
        try:
            next(steps)
        except StopIteration as stop:
            return stop.value


def within(steps: Steps[Result], start: float, end: float) -> Steps[Result]:
    """Steps whose shares are a part, from start to end, of more work."""
    while True:
        try:
            progress = next(steps)
        except StopIteration as stop:
            return stop.value
        yield Progress(progress.stage, start + (end - start) * progress.share)
