"""The pictures of ARCHITECTURE.md and the README: ``python -m examples.pictures`` writes them to ``docs/images``."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

import tessera
from tessera import networks
from tessera.assembly import mean_edge_lengths, mesh_cells
from tessera.boundary import resample
from tessera.bridges import bridge_holes
from tessera.cavity import is_inside
from tessera.contour import clean_loop
from tessera.division import divide
from tessera.placement import place_inner_vertices
from tessera.steps import finish
from tessera.stopwatch import Stopwatch
from tessera.transform import superimpose

from .wireframes import LINE, QUALITY

matplotlib.use("Agg")
import matplotlib.pyplot as plt

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "images"


def leaf(n: int = 160) -> np.ndarray:
    """A curve with a point, a bay and a bulge, (n, 2)."""
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    radius = 1 + 0.28 * np.cos(3 * t + 0.4) + 0.12 * np.sin(5 * t)
    return np.stack([1.25 * radius * np.cos(t), radius * np.sin(t)], axis=1)


def draw_polygons(ax: Axes, polygons: list[np.ndarray], colours: np.ndarray | None = None, **style) -> None:
    """Filled polygons with thin edges."""
    collection = PolyCollection(polygons, edgecolors=LINE, linewidths=0.5, **style)
    if colours is not None:
        collection.set_array(colours)
        collection.set_cmap(QUALITY)
        collection.set_clim(0.4, 1)
    ax.add_collection(collection)
    ax.autoscale()
    ax.set_aspect("equal")
    ax.axis("off")


def draw_mesh(ax: Axes, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Triangles coloured by element quality."""
    draw_polygons(ax, list(vertices[triangles]), tessera.element_quality(vertices, triangles))


def draw_scores(ax: Axes, contour: np.ndarray) -> None:
    """NN2's scores over one cell, and the inner vertices that are placed by them."""
    n_contour = np.array([len(contour)])
    transformation = superimpose(contour[None], n_contour)
    transformed = transformation.apply(contour[None])
    length = np.linalg.norm(contour - np.roll(contour, 1, axis=0), axis=1).mean()
    l_s = length * transformation.scale
    count = networks.count_inner_vertices(transformed, n_contour, l_s)
    places, _ = place_inner_vertices(transformed, n_contour, count, Stopwatch())
    low, high = transformed[0].min(axis=0), transformed[0].max(axis=0)
    x, y = np.meshgrid(np.linspace(low[0], high[0], 120), np.linspace(low[1], high[1], 120))
    grid = np.stack([x.ravel(), y.ravel()])[None]
    parts = [
        networks.score_grid(transformed, n_contour, count, part, np.array([part.shape[2]]))
        for part in np.array_split(grid, 10, axis=2)
    ]
    scores = np.concatenate(parts, axis=1)
    inside = is_inside(np.swapaxes(grid, 1, 2), transformed, n_contour)
    ax.contourf(x, y, np.where(inside, scores, np.nan).reshape(x.shape), levels=18, cmap="YlGnBu_r")
    ax.plot(*np.vstack([transformed[0], transformed[0, :1]]).T, "-o", color=LINE, ms=3, lw=1)
    ax.plot(*places[0].T, "o", color="#e63946", ms=5)
    ax.set_aspect("equal")
    ax.axis("off")


def way_of_the_data() -> None:
    """One curve at each stage: ``architecture.png``."""
    curve, edge_length = clean_loop(leaf()), 0.17
    boundary = resample(curve, edge_length)
    division = divide(*bridge_holes([boundary], np.zeros(1, int), np.zeros(1, bool), edge_length), edge_length)
    target = mean_edge_lengths(division.points, division.cells)
    vertices, triangles, _, _ = finish(mesh_cells(division.points, division.cells, target, Stopwatch()))
    mesh = tessera.mesh([curve], edge_length)
    cells = [division.points[cell[cell >= 0]] for cell in division.cells]
    figure, axes = plt.subplots(2, 3, figsize=(12, 7.2))
    titles = [
        "curve",
        "boundary at the target edge length",
        "division into cells",
        "NN1, NN2: inner vertices of a cell",
    ]
    titles += ["NN3, triangulation: cells meshed", "NN2 again: the mesh, no seams"]
    for ax, title in zip(axes.flat, titles, strict=True):
        ax.set_title(title, fontsize=11, color=LINE)
    draw_polygons(axes[0, 0], [curve], facecolors="#f1faee")
    draw_polygons(axes[0, 1], [boundary], facecolors="#f1faee")
    axes[0, 1].plot(*boundary.T, "o", color="#e63946", ms=2.5)
    draw_polygons(axes[0, 2], cells, facecolors=plt.cm.Pastel1(np.arange(len(cells)) % 9))
    draw_scores(axes[1, 0], max(cells, key=lambda cell: (len(cell), cell[0, 0])))
    draw_mesh(axes[1, 1], vertices, triangles)
    draw_mesh(axes[1, 2], mesh.vertices, mesh.triangles)
    figure.tight_layout()
    figure.savefig(FOLDER / "architecture.png", dpi=80)


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    way_of_the_data()
