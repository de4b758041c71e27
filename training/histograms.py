"""What the data holds: ``python -m training.histograms`` draws data/train.npz to docs/results/data.png.

Contours by their number of edges and kind, and examples by their number of inner vertices, the teacher's beside the
reference's (Figs. 17 and 18).
"""

from __future__ import annotations

import matplotlib
import numpy as np

from . import configuration
from .compact import unpack
from .contours import KINDS

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main() -> None:
    """Draw both histograms side by side."""
    data = unpack(configuration.ROOT / configuration.read()["data"]["folder"] / "train.npz")
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 3.6))
    edges = np.arange(2.5, data["n_contour"].max() + 1)
    kinds = [data["n_contour"][data["kind"] == k] for k in range(len(KINDS))]
    labels = [f"{name}: {len(members):,}" for name, members in zip(KINDS, kinds, strict=True)]
    left.hist(kinds, edges, stacked=True, label=labels, color=plt.cm.viridis(np.linspace(0, 1, len(KINDS))))
    left.set(xlabel="N_C, contour edges", ylabel="contours")
    counted = data["kind"] != KINDS.index("star")
    counts = [data[name][counted] for name in ("n_inner", "n_reference")]
    labels = [f"{name}: {count.mean():.2f}" for name, count in zip(("teacher", "Gmsh"), counts, strict=True)]
    right.hist(counts, np.arange(-0.5, data["n_inner"].max() + 1), label=labels, color=["#1d3557", "#a8dadc"])
    right.set(xlabel="N_I, inner vertices (stars have one)", ylabel="contours", yscale="log")
    for axes in (left, right):
        axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(configuration.ROOT / "docs" / "results" / "data.png", dpi=80)


if __name__ == "__main__":
    main()
