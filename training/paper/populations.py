"""Figs. 17 and 18: ``python -m training.paper.populations``. The populations, and their groups by inner vertices."""

from __future__ import annotations

import numpy as np

from . import settings
from .comparing import populations, test_group, write
from .data import Population


def main() -> None:
    """Count, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    count_all(config)


def count_all(config: dict) -> None:
    """Contours of each N_C, meshes of each group, the spread of N_I at each target edge length; and the test groups."""
    found = []
    for n in config["data"]["train"]:
        population, tested = populations(config, n)
        groups = np.bincount(population.n_inner.ravel())
        covered = [m for m in config["nn2"]["groups"][n] if m < len(groups)]
        found.append(
            {
                "n": n,
                "contours": len(population.contour),
                "groups": groups.tolist(),
                "covered": float(groups[covered].sum() / groups.sum()),
                "deviation": population.n_inner.std(axis=0).tolist(),
                "mean": population.n_inner.mean(axis=0).tolist(),
                "tested": [row for m in covered if (row := of_test(config, population, tested, m))["meshes"]],
            }
        )
        print(f"N_C {n}: {found[-1]['contours']} contours, N_I 0 to {len(groups) - 1}", flush=True)
    write(config, "populations", {"targets": config["data"]["targets"], "by edges": found})


def of_test(config: dict, trained: Population, tested: Population, m: int) -> dict:
    """Meshes of a test group, and of how many contours they are, as a contour has one at each target edge length.

    alike: how many times as large standard errors would be if all meshes of a contour had the same error.
    """
    group = test_group(config, trained, tested, m)
    flat = group.contour.reshape(len(group), 2 * group.contour.shape[1])
    times = np.unique(flat, axis=0, return_counts=True)[1]
    alike = float(np.sqrt((times**2).sum() / max(1, len(group))))
    return {"m": m, "meshes": len(group), "contours": len(times), "alike": alike}


if __name__ == "__main__":
    main()
