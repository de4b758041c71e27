"""The report's pictures."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import matplotlib
import matplotlib.ticker
import numpy as np
from PIL import Image

from .claims import COUNT_ERRORS
from .comparing import OURS, PAPER
from .stage_claims import NAMED
from .texts import PAPER_POPULATIONS

matplotlib.use("Agg")
import matplotlib.pyplot as plt

_DPI = 80
_COLOURS = {PAPER: "#e76f51", OURS: "#1d3557"}


def draw_populations(path: Path, found: dict) -> None:
    """Figs. 17 and 18: contours by N_C, and each population's meshes by N_I."""
    rows = found["by edges"]
    figure, axes = plt.subplots(2, -(-(len(rows) + 1) // 2), figsize=(13, 5))
    axes = axes.ravel()
    axes[0].bar([str(row["n"]) for row in rows], [row["contours"] for row in rows], color="#457b9d")
    for number, row in enumerate(rows):
        if row["n"] in PAPER_POPULATIONS:
            axes[0].plot(number, PAPER_POPULATIONS[row["n"]], "*", ms=10, color="#e76f51", mec="black", mew=0.5)
    axes[0].set(title="Fig. 17 (stars: in the paper's text)", xlabel="N_C", ylabel="contours")
    for ax, row in zip(axes[1:], rows, strict=False):
        ax.bar(range(len(row["groups"])), row["groups"], color="#457b9d")
        ax.set(title=f"Fig. 18: N_C {row['n']}", xlabel="N_I", ylabel="meshes", xlim=(-1, 40))
    _hide(axes, len(rows) + 1)
    _save(figure, path)


def draw_counts(path: Path, rows: list[dict]) -> None:
    """Fig. 19: a line for each N_C, the paper's networks and the shipped ones side by side."""
    figure, axes = plt.subplots(1, 2, figsize=(11, 3.6), sharey=True)
    numbers = sorted({row["n"] for row in rows})
    for ax, name in zip(axes, (PAPER, OURS), strict=True):
        for n, colour in zip(numbers, plt.cm.viridis(np.linspace(0, 0.9, len(numbers))), strict=True):
            line = [(row["l_s"], row["error"]) for row in rows if (row["n"], row["networks"]) == (n, name)]
            ax.plot(*zip(*line, strict=True), "o-", ms=3, color=colour, label=f"N_C {n}")
        ax.set(title=name, xlabel="l_s", ylabel="mean absolute error of N_I", yscale="log")
        ax.grid(alpha=0.3)
    for (n, l_s), error in COUNT_ERRORS.items():
        if n in numbers:
            colour = plt.cm.viridis(0.9 * numbers.index(n) / max(1, len(numbers) - 1))
            axes[0].plot(
                l_s, error, "*", ms=11, color=colour, mec="black", mew=0.5, label=f"N_C {n} in the paper's text"
            )
    entries = dict(zip(*reversed(axes[0].get_legend_handles_labels()), strict=True))
    axes[0].legend(entries.values(), entries.keys(), fontsize=7, ncols=2)
    _save(figure, path)


def draw_resolution(path: Path, rows: list[dict]) -> None:
    """Fig. 21: the mean squared distance over the grid's resolution."""
    figure, ax = plt.subplots(figsize=(5, 3.4))
    for n in sorted({row["n"] for row in rows}):
        line = [(row["grid"], row["error"], row["spread"]) for row in rows if row["n"] == n]
        ax.errorbar(*np.transpose(line), fmt="o-", ms=4, capsize=2, label=f"N_C {n}")
    ax.set(xlabel="grid points along a side", ylabel="mean squared distance")
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)
    _save(figure, path)


def draw_stage(path: Path, rows: list[dict], figure_number: int) -> None:
    """Figs. 22, 24, 25 or 27: a panel for each N_C, ē_worst full and ē_mean dashed, over N_I; the paper's as stars."""
    rows = [row for row in rows if row["figure"] == figure_number and row["m"] is not None and row["contours"]]
    numbers = sorted({row["n"] for row in rows})
    lines = -(-(len(numbers) + 1) // 4)
    figure, axes = plt.subplots(lines, 4, figsize=(13, 2.9 * lines))
    axes, entries = np.ravel(axes), {}
    for ax, n in zip(axes, numbers, strict=False):
        for name in (PAPER, OURS):
            line = [row for row in rows if (row["n"], row["networks"]) == (n, name)]
            if line:
                _draw_errors(ax, line, "calculated tables" if figure_number == 24 else name, _COLOURS[name])
        rest = [(row["m"], row["rest by CDT"]) for row in rows if row["n"] == n and "rest by CDT" in row]
        if rest:
            ax.plot(
                *np.transpose(sorted(rest)), ":", color=_COLOURS[PAPER], label=f"{PAPER}, sub-contours by CDT: ē_worst"
            )
        named = [(m, value) for (of, m), value in NAMED[figure_number].items() if of == n]
        if named:
            ax.plot(*zip(*named, strict=True), "*", ms=11, color="#2a9d8f", label="ē_worst in the paper's text")
        ax.set(title=f"N_C {n}", xlabel="N_I", ylabel="%")
        ax.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
        ax.axhline(0, color="grey", lw=0.6)
        ax.grid(alpha=0.3)
        entries |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    _hide(axes, len(numbers))
    axes[len(numbers)].legend(entries.values(), entries.keys(), fontsize=9, loc="center")
    _save(figure, path)


def _draw_errors(ax: plt.Axes, rows: list[dict], label: str, colour: str) -> None:
    """One line of ē_worst, with standard errors, and one of ē_mean."""
    m, worst, spread, mean = np.transpose(sorted((r["m"], r["worst"], r["worst_spread"], r["mean"]) for r in rows))
    ax.errorbar(m, worst, spread, fmt="o-", ms=3, capsize=2, color=colour, label=f"{label}: ē_worst")
    ax.plot(m, mean, "--", lw=1, color=colour, label=f"{label}: ē_mean")


def draw_adaptive(path: Path, rows: list[dict]) -> None:
    """Fig. 26: ē_worst over the sample size, a panel for each number of inner vertices."""
    numbers = sorted({row["m"] for row in rows})
    figure, axes = plt.subplots(1, max(1, len(numbers)), figsize=(4 * max(1, len(numbers)), 3.2), squeeze=False)
    for ax, m in zip(axes[0], numbers, strict=True):
        for sampling, colour in (("random", "#e63946"), ("adaptive", "#457b9d")):
            line = [
                (row["size"], row["worst"], row["worst_spread"])
                for row in rows
                if (row["m"], row["sampling"]) == (m, sampling) and row["worst"] is not None
            ]
            if line:
                ax.errorbar(*np.transpose(line), fmt="o-", ms=4, capsize=2, color=colour, label=sampling)
                ax.legend(fontsize=8)
        ax.set(title=f"N_I {m}", xlabel="samples a contour", ylabel="ē_worst, %")
        ax.grid(alpha=0.3)
    _save(figure, path)


def draw_surfaces(
    path: Path, contour: np.ndarray, surfaces: Sequence[np.ndarray], points: np.ndarray, others: np.ndarray
) -> None:
    """Figs. 15 and 16: an edge's quality surface, smoothed, and the vertices sampled from it (k, 2)."""
    figure, axes = plt.subplots(1, 3, figsize=(11.5, 3.6), layout="constrained")
    closed = np.concatenate([contour, contour[:1]])
    highest = max(float(np.nanmax(surface)) for surface in surfaces)
    titles = "worst quality by the vertex's place", "smoothed", "sampled by curvature"
    for ax, surface, title in zip(axes, (*surfaces, surfaces[-1]), titles, strict=True):
        shown = np.where(surface > 0, surface, np.nan)
        image = ax.imshow(shown, origin="lower", extent=(-1.2, 1.2, -1.2, 1.2), cmap="viridis", vmin=0, vmax=highest)
        ax.plot(*closed.T, "-", color="black", lw=1)
        ax.plot(*closed[:2].T, "-", color="#e63946", lw=3)
        ax.plot(*others.T, "s", color="#e63946", ms=5)
        ax.set(title=title, xticks=[], yticks=[], xlim=(-1.6, 1.6), ylim=(-1.6, 1.6))
    axes[2].plot(*points.T, ".", color="white", ms=5)
    figure.colorbar(image, ax=axes, label="q_worst")
    _save(figure, path)


def draw_learning(path: Path, rows: list[dict]) -> None:
    """The loss on test contours over the population learnt from."""
    figure, axes = plt.subplots(1, len(rows), figsize=(4 * len(rows), 3.2))
    for ax, row in zip(axes, rows, strict=True):
        ax.plot(row["size"], row["loss"], "o-", color=_COLOURS[PAPER])
        group = f"N_C {row['n']}" + (f", N_I {row['m']}" if "m" in row else "")
        ax.set(title=f"{row['role']}, {group}", xlabel=row["of"], xscale="log", ylim=(0, 1.1 * max(row["loss"])))
        ax.set_ylabel(textwrap.fill(row["what"], 24), fontsize=9)
        ax.set_xticks(row["size"], [f"{size:,}" for size in row["size"]], fontsize=8)
        ax.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
        ax.grid(alpha=0.3)
    _save(figure, path)


def draw_meshes(path: Path, meshes: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """Figs. 28 to 30: meshes (vertices, triangles) by name."""
    figure, axes = plt.subplots(1, len(meshes), figsize=(4.2 * len(meshes), 3.8))
    for ax, (name, (vertices, triangles)) in zip(axes, meshes.items(), strict=True):
        ax.triplot(*vertices.T, triangles, lw=0.5, color=_COLOURS[OURS])
        ax.set(title=name, aspect="equal")
        ax.axis("off")
    _save(figure, path)


def _hide(axes: np.ndarray, used: int) -> None:
    for ax in axes[used:]:
        ax.axis("off")


def _save(figure: plt.Figure, path: Path) -> None:
    """With few colours, which makes a file a quarter as large."""
    if figure.get_layout_engine() is None:
        figure.tight_layout()
    with BytesIO() as file:
        figure.savefig(file, dpi=_DPI)
        Image.open(file).convert("RGB").quantize(64).save(path, optimize=True)
    plt.close(figure)
