"""A window's way to take the steps of long work: a slice at a time, so that it stays alive and can be cancelled."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from ..tessera import Progress

T = TypeVar("T")
# As in tessera.steps, which is not imported here, as enabling the add-on would load the mesher.
Steps = Generator["Progress", None, T]

# What a user reads for the stages of the library's steps.
WORDS = {
    "contours": "checking the outline",
    "sizing": "finding the sizes",
    "coarsening": "finding room",
    "division": "dividing",
    "networks": "placing triangles",
    "relaxation": "evening out",
    "smoothing": "smoothing",
}


@dataclass(frozen=True)
class Done:
    """What finished steps made."""

    result: object


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


def named(steps: Steps[T], name: str) -> Steps[T]:
    """The same steps, with what they work on said before the stage, in a user's words."""
    while True:
        try:
            progress = next(steps)
        except StopIteration as end:
            return end.value
        yield replace(progress, stage=f"{name}: {WORDS[progress.stage]}")
