"""Fig. 19: ``python -m training.paper.counts``. NN1's mean absolute error by number of edges and target edge length."""

from __future__ import annotations

import numpy as np

from . import settings
from .comparing import as_contours, compared, write
from .data import load


def main() -> None:
    """Compare, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    compare_counts(config)


def compare_counts(config: dict) -> None:
    """Of all test contours at every target edge length, against the reference's count."""
    roles, found = compared(config), []
    for n in config["data"]["test"]:
        population = load(config, "test", n)
        for number, l_s in enumerate(config["data"]["targets"]):
            contours = as_contours(population.contour, np.full(len(population.contour), l_s))
            wanted = population.n_inner[:, number]
            for name, role in roles.items():
                apart = np.abs(role.count(contours.points, contours.n_contour, contours.l_s) - wanted)
                row = {"n": n, "l_s": l_s, "networks": name, "contours": len(apart)}
                found.append({**row, "error": float(apart.mean()), "deviation": float(wanted.std())})
        print(f"N_C {n}: " + ", ".join(f"{row['error']:.2f}" for row in found if row["n"] == n), flush=True)
    write(config, "counts", found)


if __name__ == "__main__":
    main()
