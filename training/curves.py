"""Learning curves: ``python -m training.curves`` draws runs/*.csv to docs/results/learning_curves.png."""

from __future__ import annotations

import matplotlib
import numpy as np

from . import configuration
from .networks import ROLES

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main() -> None:
    """Draw a panel for each role: training and held-out loss over steps, schedules one after the other."""
    figure, axes = plt.subplots(1, len(ROLES), figsize=(4 * len(ROLES), 3.2))
    for ax, role in zip(axes, ROLES, strict=True):
        step, loss, held_out = np.loadtxt(configuration.ROOT / "runs" / f"{role}.csv", delimiter=",", ndmin=2).T
        # A warm start counts from 0 again: put it behind what came before.
        counted, starts = step.copy(), np.flatnonzero(np.diff(step, prepend=0) < 0)
        for start in starts:
            step[start:] += counted[start - 1]
        ax.plot(step, loss, label="training", color="#a8dadc")
        ax.plot(step, held_out, label="held out", color="#1d3557")
        for start in starts:
            ax.axvline(step[start - 1], color="#e63946", lw=0.8, ls=":")
        ax.set(title=role, xlabel="steps", yscale="log")
        ax.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(configuration.ROOT / "docs" / "results" / "learning_curves.png", dpi=80)


if __name__ == "__main__":
    main()
