"""The report's pictures."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

from .goals import ENOUGH
from .groups import Groups
from .meshes import MEASURES
from .stages import FRONTAL, GMSH, OURS, SMOOTHED, TEACHER, Results

matplotlib.use("Agg")
import matplotlib.pyplot as plt

_DPI = 90
_COLOURS = {OURS: "#1d3557", SMOOTHED: "#457b9d", GMSH: "#e63946", FRONTAL: "#f4a261", TEACHER: "#2a9d8f"}


def draw_groups(
    path: Path, titles: Sequence[str], parts: Sequence[Groups], column: str, limit: float, signed: bool
) -> None:
    """Heat maps one below the other: mean, standard error and number of contours in every cell, bold if of enough.

    column: name of the columns' key, the rows' is N_C; colours go from 0 to limit, or from -limit if signed.
    """
    width = 2 + 0.62 * max(len(part.columns) for part in parts)
    height = sum(1.3 + 0.42 * len(part.rows) for part in parts)
    figure, panels = plt.subplots(len(parts), 1, figsize=(width, height), squeeze=False)
    for ax, title, part in zip(panels[:, 0], titles, parts, strict=True):
        lowest, colours, digits = (-limit, "RdBu_r", 1) if signed else (0, "Reds", 2)
        means = np.round(part.mean, digits) + 0.0  # no negative zeros
        ax.imshow(part.mean, cmap=colours, vmin=lowest, vmax=limit, aspect="auto", origin="lower", alpha=0.9)
        ax.set(title=title, ylabel="N_C", xlabel=column)
        ax.set_yticks(range(len(part.rows)), [f"{row:g}" for row in part.rows])
        ax.set_xticks(range(len(part.columns)), [f"{column:g}" for column in part.columns])
        for i, j in np.argwhere(part.count > 0):
            style = {
                "ha": "center",
                "color": "white" if abs(part.mean[i, j]) > 0.7 * limit else "black",
                "weight": "bold" if part.count[i, j] >= ENOUGH else "normal",
            }
            ax.text(j, i, f"{means[i, j]:{'+' * signed}.{digits}f}", fontsize=9, **style)
            spread = f"±{part.spread[i, j]:.{digits}f} · " if part.count[i, j] > 1 else ""
            ax.text(j, i - 0.33, f"{spread}{part.count[i, j]}", fontsize=6, **style)
    _save(figure, path)


def draw_distributions(path: Path, sets: dict[str, Results]) -> None:
    """Cumulative shares of contours by worst quality and by smallest angle: a row of panels for each set."""
    figure, panels = plt.subplots(len(sets), 2, figsize=(11, 3.6 * len(sets)), squeeze=False)
    for row, (name, results) in zip(panels, sets.items(), strict=True):
        for ax, measure, unit in zip(row, (0, 2), ("", " (degrees)"), strict=True):
            for mesher, colour in _COLOURS.items():
                values = results.measures[mesher][results.is_comparable, measure]
                share = 100 * np.arange(1, len(values) + 1) / max(len(values), 1)
                ax.plot(np.sort(values), share, color=colour, label=mesher, lw=1.4)
            ax.set(title=name, xlabel=MEASURES[measure] + unit, ylabel="% of contours below", ylim=(0, 100))
            ax.grid(alpha=0.3)
    panels[0, 0].legend(fontsize=8)
    _save(figure, path)


def _save(figure: plt.Figure, path: Path) -> None:
    """With few colours, which makes a file a quarter as large."""
    figure.tight_layout()
    with BytesIO() as file:
        figure.savefig(file, dpi=_DPI)
        Image.open(file).convert("RGB").quantize(96).save(path, optimize=True)
    plt.close(figure)
