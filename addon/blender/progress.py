"""Work in steps: generators that yield their progress now and then, and return what they make.

A script runs one to its end; a window runs it a slice at a time, so that it stays alive and can be cancelled.
"""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from ..tessera import Progress

T = TypeVar("T")
Steps = Generator["Progress", None, T]


@dataclass(frozen=True)
class Done:
    """What finished steps made."""

    result: object


def finish(steps: Steps[T]) -> T:
    """Run to the end."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def advance(steps: Steps[T], seconds: float) -> Progress | Done:
    """Run for about so many seconds: how far it came, or what it made."""
    until = time.perf_counter() + seconds
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            return Done(end.value)
        if time.perf_counter() >= until:
            return progress


def within(steps: Steps[T], first: float, last: float, what: str = "") -> Steps[T]:
    """The same steps as a part of more work, of which their shares are those from `first` to `last`.

    what: said before the stage's name.
    """
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            return end.value
        stage = f"{what}: {progress.stage}" if what else progress.stage
        yield replace(progress, stage=stage, share=first + (last - first) * progress.share)
