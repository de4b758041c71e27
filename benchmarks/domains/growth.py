"""Circles of 1 000 to 1 000 000 triangles: seconds and memory, each in a process of its own on one core.

``python -m benchmarks.domains.growth TRIANGLES ROUNDS`` measures one, and prints it as JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from dataclasses import asdict, dataclass

import numpy as np

from .. import machine, memory

MODULE = "benchmarks.domains.growth"
SIZES = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000)
LARGE = 100_000  # triangles of the circle of the goals
ASYMPTOTIC = 10_000  # from which the time of a call is no longer that of its overhead
ROUNDS, REPEATED = 3, LARGE  # rounds of circles of up to so many triangles, of which seconds are the median


@dataclass(frozen=True)
class Circle:
    """Of one circle, Tessera's and Gmsh Delaunay's triangles and median seconds; and the most bytes held for ours.

    Seconds are the processor's: on one core of a quiet machine those of the clock, and the same on a busy one.
    """

    triangles: int
    seconds: float
    peak: int
    their_triangles: int
    their_seconds: float


def measure_all(largest: int) -> list[Circle]:
    """Circles of SIZES up to so many triangles; the smaller ones several times."""
    found = []
    for size in SIZES:
        if size <= largest:
            command = [sys.executable, "-m", MODULE, str(size), str(ROUNDS if size <= REPEATED else 1)]
            output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
            found.append(Circle(**json.loads(output.splitlines()[-1])))
    return found


def exponents(circles: list[Circle]) -> tuple[float, float]:
    """p of the power n^p that our seconds grow by, and that which n log n grows by, from ASYMPTOTIC triangles on."""
    n, seconds = np.array([(c.triangles, c.seconds) for c in circles if c.triangles >= 0.9 * ASYMPTOTIC]).T
    return tuple(float(np.polyfit(np.log(n), np.log(values), 1)[0]) for values in (seconds, n * np.log(n)))


def n_log_n(circles: list[Circle]) -> float:
    """a of a n log n, fitted to the logarithms of our seconds from ASYMPTOTIC triangles on."""
    n, seconds = np.array([(c.triangles, c.seconds) for c in circles if c.triangles >= 0.9 * ASYMPTOTIC]).T
    return float(np.exp(np.mean(np.log(seconds / (n * np.log(n))))))


def _measure(triangles: int, rounds: int) -> Circle:
    """One circle, by turns by both meshers; memory is taken before Gmsh is loaded."""
    import tessera

    from . import cases

    # As many equilateral triangles as fill the circle, and a tenth more.
    case = cases.circle(float(np.sqrt(1.1 * 4 * np.pi / (np.sqrt(3) * triangles))))
    tessera.mesh(case.loops, 0.2)
    ours, theirs, peak = [], [], 0
    for _ in range(rounds):
        start = time.process_time()
        mesh = tessera.mesh(case.loops, case.edge_length)
        ours.append(time.process_time() - start)
        peak = peak or memory.peak()
        from . import meshers

        (loop,) = meshers.boundary_loops(meshers.Meshed(mesh.vertices, mesh.triangles, 0.0))
        start = time.process_time()
        _, elements = meshers.by_gmsh([loop], case.edge_length, meshers.ALGORITHMS[meshers.DELAUNAY])
        theirs.append(time.process_time() - start)
    return Circle(len(mesh.triangles), float(np.median(ours)), peak, len(elements), float(np.median(theirs)))


if __name__ == "__main__":
    machine.bind_to_one_core(MODULE)
    print(json.dumps(asdict(_measure(int(sys.argv[1]), int(sys.argv[2])))))
