"""The machine that numbers are from, and one core of it for all."""

from __future__ import annotations

import os
import platform
import sys
from importlib.metadata import version
from pathlib import Path


def bind_to_one_core(module: str) -> None:
    """Start ``python -m module``, with its arguments, again on one core, unless this process has only one.

    Libraries choose their number of threads when they are imported, so that it is too late to bind them afterwards.
    """
    cores = os.sched_getaffinity(0)
    if len(cores) > 1:
        os.sched_setaffinity(0, {min(cores)})
        os.execv(sys.executable, [sys.executable, "-m", module, *sys.argv[1:]])


def describe() -> str:
    """A Markdown list of processor, system and versions."""
    processor = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    names = ("tessera", "numpy", "onnxruntime", "gmsh")
    versions = ", ".join(f"{name} {version(name)}" for name in names)
    return (
        f"- {processor[0].split(':')[1].strip() if processor else platform.machine()}, "
        f"{len(os.sched_getaffinity(0))} core of {os.cpu_count()} in use\n"
        f"- {platform.freedesktop_os_release()['PRETTY_NAME']}, {platform.machine()}\n"
        f"- Python {platform.python_version()}, {versions}"
    )
