"""The demo's picture: wireframes on white, each face in the colour of its quality."""

from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap

# From a warm clay (poor) over sand to a clear sea green (even); light, so that the lines stay in front.
QUALITY = LinearSegmentedColormap.from_list("quality", ["#d9644a", "#f2c27f", "#f4ecc8", "#bfe0d2", "#7fc4bd"])
LINE = "#20404a"


def draw(panels: dict[str, list], path: Path) -> None:
    """All pieces of all panels where they lie in the XY plane, in one picture with a scale of the quality."""
    pieces = [piece for panel in panels.values() for piece in panel]
    everything = np.concatenate([piece.vertices for piece in pieces])
    low, high = everything.min(axis=0), everything.max(axis=0)
    width, height = high - low
    figure, axes = plt.subplots(figsize=(12, 12 * height / width + 0.7))
    for piece in pieces:
        faces = PolyCollection(
            piece.vertices[piece.triangles],
            array=piece.quality,
            cmap=QUALITY,
            clim=(0.4, 1.0),
            edgecolors=LINE,
            linewidths=0.35,
            joinstyle="round",
        )
        axes.add_collection(faces)
    margin = 0.02 * width
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.axis("off")
    bar = figure.colorbar(faces, ax=axes, orientation="horizontal", fraction=0.025, pad=0.02, aspect=60, shrink=0.3)
    bar.outline.set_visible(False)
    bar.ax.tick_params(labelsize=8, length=0, colors=LINE)
    bar.set_label("element quality", fontsize=8, color=LINE)
    figure.savefig(path, dpi=110, bbox_inches="tight", facecolor="white")
    plt.close(figure)
