"""Speed of the scheme beside the reference mesher's: ``python -m benchmarks.speed``.

The same 1 000 contours; medians of rounds in turn. Gmsh uses one thread and onnxruntime one for each core, whatever
OMP_NUM_THREADS says: `taskset -c 0 python -m benchmarks.speed` gives both one core.
"""

from __future__ import annotations

import os
import platform
import time

import numpy as np
import onnxruntime

from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch
from training import evaluate, reference

ROUNDS = 5
CONTOURS = 1000


def main() -> None:
    """Print the table."""
    points, n_contour, l_s = evaluate.held_out(CONTOURS, seed=77)
    reference.start()
    mesh_contours(points, n_contour, l_s, Stopwatch())
    ours, theirs, stages = [], [], []
    for _ in range(ROUNDS):
        watch, start = Stopwatch(), time.perf_counter()
        mesh_contours(points, n_contour, l_s, watch)
        ours.append(time.perf_counter() - start)
        stages.append(watch.seconds)
        start = time.perf_counter()
        for row, n in enumerate(n_contour):
            reference.mesh(points[row, :n], l_s[row])
        theirs.append(time.perf_counter() - start)
    each = 1e3 / CONTOURS
    print(f"{CONTOURS} sector contours, N_C 4 to 16, l_s 0.3 to 1; medians of {ROUNDS} rounds; {platform.machine()},")
    print(f"{len(os.sched_getaffinity(0))} cores, onnxruntime {onnxruntime.__version__}, Gmsh {reference.VERSION}\n")
    print("| stage | ms a contour |\n| --- | --- |")
    for stage in stages[0]:
        print(f"| {stage} | {each * np.median([s[stage] for s in stages]):.3f} |")
    print(f"| **Tessera** | **{each * np.median(ours):.3f}** |\n| Gmsh | {each * np.median(theirs):.3f} |")


if __name__ == "__main__":
    main()
