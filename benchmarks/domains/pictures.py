"""The domains' pictures: our meshes beside Gmsh's, coloured by element quality, and how the time grows."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from PIL import Image

import tessera
from examples.wireframes import LINE, QUALITY

from .growth import Circle, n_log_n
from .meshers import MESHERS, Meshed

matplotlib.use("Agg")
import matplotlib.pyplot as plt

_DPI = 100
_THICKEST = 0.5  # points, of edges; they are thinner where triangles are small on paper

Meshes = dict[str, Meshed]  # by mesher
Window = tuple[float, float, float, float]  # left, right, bottom, top


def draw_side_by_side(path: Path, domains: Sequence[Meshes], width: float = 12.0) -> None:
    """A row for each domain, a column for each mesher."""
    heights = [_aspect(meshes) for meshes in domains]
    size = width, width / len(MESHERS) * sum(heights) + 0.3
    figure, axes = plt.subplots(
        len(domains), len(MESHERS), figsize=size, squeeze=False, gridspec_kw={"height_ratios": heights}
    )
    for row, meshes in zip(axes, domains, strict=True):
        for ax, name in zip(row, MESHERS, strict=True):
            _draw(ax, meshes[name])
    _name(axes[0])
    _save(figure, path)


def draw_below(path: Path, domains: Sequence[Meshes], columns: int, width: float = 12.0) -> None:
    """Blocks of so many columns, a domain each, with a row for each mesher."""
    blocks = [domains[first : first + columns] for first in range(0, len(domains), columns)]
    height = [max(_aspect(meshes) for meshes in block) for block in blocks for _ in MESHERS]
    size = width, width / columns * sum(height) + 0.3
    figure, axes = plt.subplots(
        len(height), columns, figsize=size, squeeze=False, gridspec_kw={"height_ratios": height}
    )
    for number, ax in enumerate(axes.flat):
        row, column = divmod(number, columns)
        block, mesher = divmod(row, len(MESHERS))
        if column < len(blocks[block]):
            _draw(ax, blocks[block][column][MESHERS[mesher]])
        else:
            ax.axis("off")
        if column == 0:
            ax.text(-0.04, 0.5, MESHERS[mesher], transform=ax.transAxes, rotation=90, color=LINE, **_LABEL)
    _save(figure, path)


def draw_details(path: Path, details: Sequence[tuple[Meshes, Window]]) -> None:
    """A column for each domain with a square part of it, a row for each mesher."""
    size = 14.0, 14 / len(details) * len(MESHERS) + 0.3
    figure, axes = plt.subplots(len(MESHERS), len(details), figsize=size, squeeze=False)
    for column, (meshes, window) in zip(axes.T, details, strict=True):
        for ax, mesher in zip(column, MESHERS, strict=True):
            _draw(ax, meshes[mesher], window)
    for ax, mesher in zip(axes[:, 0], MESHERS, strict=True):
        ax.text(-0.04, 0.5, mesher, transform=ax.transAxes, rotation=90, color=LINE, **_LABEL)
    _save(figure, path)


def draw_airfoil(path: Path, meshes: Meshes, windows: Sequence[Window]) -> None:
    """The whole by each mesher, one below the other, then a row for each part of it, with a column for each mesher."""
    parts = [(top - bottom) / (right - left) / len(MESHERS) for left, right, bottom, top in windows]
    heights = [1.25 * _aspect(meshes)] * len(MESHERS) + parts
    figure = plt.figure(figsize=(12, 12 * sum(heights) + 0.6))
    grid = figure.add_gridspec(len(heights), len(MESHERS), height_ratios=heights)
    for number, name in enumerate(MESHERS):
        whole = figure.add_subplot(grid[number, :])
        _draw(whole, meshes[name])
        _name([whole], [name])
        for row, window in enumerate(windows):
            ax = figure.add_subplot(grid[len(MESHERS) + row, number])
            _draw(ax, meshes[name], window)
            ax.set_title(name, fontsize=9, color=LINE)
    _save(figure, path)


def draw_growth(path: Path, circles: Sequence[Circle]) -> None:
    """Seconds over triangles, the fitted n log n, and memory."""
    figure, (time, memory) = plt.subplots(1, 2, figsize=(10, 3.8))
    n = np.array([circle.triangles for circle in circles])
    time.loglog(n, [circle.seconds for circle in circles], "o", color="#1d3557", label="Tessera")
    factor = n_log_n(circles)
    label = f"{1e6 * factor:.2f} µs · n log n"
    time.loglog(n, factor * n * np.log(n), "-", color="#1d3557", lw=1, alpha=0.6, label=label)
    theirs = [circle.their_triangles for circle in circles], [circle.their_seconds for circle in circles]
    time.loglog(*theirs, "s", color="#e63946", ms=4, label="Gmsh Delaunay")
    time.set(xlabel="triangles of a circle", ylabel="seconds of one core")
    time.legend(fontsize=8)
    memory.loglog(n, [circle.peak / 1e9 for circle in circles], "o-", color="#1d3557")
    memory.axhline(2, color="#e63946", lw=1)
    memory.set(xlabel="triangles of a circle", ylabel="most memory of the process (GB)")
    for ax in (time, memory):
        ax.grid(alpha=0.3)
    figure.tight_layout()
    _save(figure, path, packed=False)


_LABEL = {"fontsize": 9, "ha": "center", "va": "center"}


def _aspect(meshes: Meshes) -> float:
    """Height by width, with room for a title."""
    width, height = np.ptp(next(iter(meshes.values())).vertices, axis=0)
    return height / width


def _name(axes: Sequence[Axes], names: Sequence[str] = MESHERS) -> None:
    for ax, name in zip(axes, names, strict=True):
        ax.set_title(f"{name}: {ax.get_title()}", fontsize=9, color=LINE)


def _draw(ax: Axes, mesh: Meshed, window: Window | None = None) -> None:
    """Triangles coloured by element quality."""
    quality = tessera.element_quality(mesh.vertices, mesh.triangles)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    if window is not None:
        low, high = np.array(window).reshape(2, 2).T
    inches = ax.get_position().width * ax.figure.get_size_inches()[0]
    shown = np.all((mesh.vertices[mesh.triangles] > low) & (mesh.vertices[mesh.triangles] < high), axis=2).any(axis=1)
    edge = np.sqrt((high - low).prod() / max(np.count_nonzero(shown), 1)) / (high - low)[0] * 72 * inches
    faces = PolyCollection(
        mesh.vertices[mesh.triangles],
        array=quality,
        cmap=QUALITY,
        clim=(0.4, 1.0),
        edgecolors=LINE,
        linewidths=min(_THICKEST, 0.06 * edge),
        joinstyle="round",
    )
    ax.add_collection(faces)
    margin = 0.01 * (high - low).max() * (window is None)
    ax.set_xlim(low[0] - margin, high[0] + margin)
    ax.set_ylim(low[1] - margin, high[1] + margin)
    ax.set_aspect("equal")
    ax.axis("off")
    if window is None:
        ax.set_title(f"q {quality.min():.2f} / {quality.mean():.3f}", fontsize=7, color=LINE, pad=2)


def _save(figure: plt.Figure, path: Path, packed: bool = True) -> None:
    """With few colours, which makes a file a quarter as large."""
    if packed:
        figure.subplots_adjust(left=0.02, right=0.995, bottom=0.005, top=1 - 0.45 / figure.get_size_inches()[1])
        figure.subplots_adjust(wspace=0.03, hspace=0.12)
    with BytesIO() as file:
        figure.savefig(file, dpi=_DPI, facecolor="white")
        Image.open(file).convert("RGB").quantize(128).save(path, optimize=True)
    plt.close(figure)
