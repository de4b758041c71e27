"""Section 5: ``python -m training.paper.speed``. The whole scheme's time beside the reference's, in the same rounds."""

from __future__ import annotations

import time

import numpy as np

from tessera import paper
from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch

from .. import reference
from . import settings
from .comparing import PAPER, as_contours, compared, write
from .data import load

CONTOURS, ALONE, ROUNDS = 200, 20, 3  # of each N_C in a batch, and one by one


def main() -> None:
    """Measure, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    measure_speed(config)


def measure_speed(config: dict) -> None:
    """Milliseconds a contour: Gmsh, and both networks in a batch and one by one; the fastest of the rounds."""
    roles, found = compared(config), []
    reference.start()
    for n, numbers in paper.groups("paper", config["folders"]["models"]).items():
        population = load(config, "test", n)
        contours = as_contours(population.contour, np.full(len(population.contour), config["data"]["targets"][-1]))
        wanted = roles[PAPER].count(contours.points, contours.n_contour, contours.l_s)
        part = contours.rows(np.flatnonzero(np.isin(wanted, numbers))[:CONTOURS])
        jobs = {"Gmsh": lambda part=part, n=n: [reference.mesh(p[:n], size) for p, size in zip(part.points, part.l_s)]}
        jobs |= {f"{name}, batch": lambda part=part, role=role: _mesh(part, role) for name, role in roles.items()}
        few = [part.rows(slice(row, row + 1)) for row in range(min(ALONE, len(part)))]
        jobs |= {
            f"{name}, alone": lambda few=few, role=role: [_mesh(one, role) for one in few]
            for name, role in roles.items()
        }
        counts = {name: len(few) if name.endswith("alone") else len(part) for name in jobs}
        best = dict.fromkeys(jobs, np.inf)
        for _ in range(ROUNDS if len(part) else 0):
            for name, job in jobs.items():
                start = time.perf_counter()
                job()
                best[name] = min(best[name], 1e3 * (time.perf_counter() - start) / counts[name])
        if len(part):
            found.append({"n": n, "contours": len(part), **best})
            print(f"N_C {n}: " + ", ".join(f"{name} {value:.2f} ms" for name, value in best.items()), flush=True)
    write(config, "speed", found)


def _mesh(part, role) -> None:
    mesh_contours(part.points, part.n_contour, part.l_s, Stopwatch(), roles=role)


if __name__ == "__main__":
    main()
