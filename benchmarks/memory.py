"""The memory that one batch takes, in a process that does nothing else: ``python -m benchmarks.memory FILE``."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch


def of_a_batch(path: Path) -> float:
    """Most bytes in memory of a fresh process that meshes the contours of a file as one batch."""
    command = [sys.executable, "-m", "benchmarks.memory", str(path)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def peak() -> int:
    """Most bytes that this process has had in memory. (Its ru_maxrss would count the process that started it.)"""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.split("VmHWM:")[1].split()[0])


if __name__ == "__main__":
    with np.load(sys.argv[1]) as file:
        mesh_contours(file["points"], file["n_contour"], file["l_s"], Stopwatch())
    print(peak())
