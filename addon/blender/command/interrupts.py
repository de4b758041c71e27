"""Ctrl-C: the first ends the command after the curves in hand, a second one at once. No `bpy` here.

Blender by itself takes no notice of the first, and ends at the second with the status of an error of usage.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

_asked = False


class Interrupted(Exception):
    """The user has stopped the command, in words for the user."""


@contextmanager
def heeded() -> Iterator[None]:
    """While this lasts, `check` knows of a Ctrl-C."""
    global _asked
    _asked = False
    before = signal.signal(signal.SIGINT, _ask)
    try:
        yield
    finally:
        # None: it is Blender's own, which Python cannot set again; Blender ends after a command anyway.
        signal.signal(signal.SIGINT, signal.SIG_DFL if before is None else before)


def check() -> None:
    """Raises Interrupted after a Ctrl-C."""
    if _asked:
        raise Interrupted("stopped by Ctrl-C: the same command with --resume goes on from here")


def _ask(*_) -> None:
    global _asked
    _asked = True
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second one
