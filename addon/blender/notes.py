"""What failed in the last use, for the popup and the sidebar. Apart from failures.py, so that it loads no mesher."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .failures import Failure


@dataclass(frozen=True)
class Noted:
    """A failure: the object's name, what is wrong, and where: the number of the spline, and the place in the world."""

    obj: str
    sentence: str
    spline: int
    place: tuple[float, float, float] | None


# Of the last use in this session; no part of the file, so that a failure leaves that as it was.
last: list[Noted] = []


def note(failures: Iterable[Failure]) -> None:
    """Keep these failures in place of those of the last use."""
    last[:] = [Noted(failure.obj, str(failure), failure.spline, failure.place) for failure in failures]
