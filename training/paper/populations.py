"""Figs. 17 and 18: ``python -m training.paper.populations``. The populations, and their groups by inner vertices."""

from __future__ import annotations

import numpy as np

from . import settings
from .comparing import write
from .data import load


def main() -> None:
    """Count, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    count_all(config)


def count_all(config: dict) -> None:
    """Contours of each N_C, meshes of each group, and the spread of N_I at each target edge length."""
    found = []
    for n in config["data"]["train"]:
        population = load(config, "train", n)
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
            }
        )
        print(f"N_C {n}: {found[-1]['contours']} contours, N_I 0 to {len(groups) - 1}", flush=True)
    write(config, "populations", {"targets": config["data"]["targets"], "by edges": found})


if __name__ == "__main__":
    main()
