"""What failed in the last use, for the popup and the sidebar. Apart from failures.py, so that it loads no mesher."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

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


def still_there() -> list[Noted]:
    """Those whose objects have not been deleted since."""
    return [noted for noted in last if noted.obj in bpy.data.objects]


def note(failures: Iterable[Failure]) -> None:
    """Keep these failures in place of those of the last use."""
    last[:] = [Noted(failure.obj, str(failure), failure.spline, failure.place) for failure in failures]


@persistent
def _after_load(_path: str, _) -> None:
    """Another file may well have objects of the same names."""
    last.clear()


def register() -> None:
    """Forget what failed in a file when another is opened."""
    bpy.app.handlers.load_post.append(_after_load)


def unregister() -> None:
    """Undo `register`."""
    bpy.app.handlers.load_post.remove(_after_load)
