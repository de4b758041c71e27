"""Pictures of what each setting does, by the library: every panel is one mesh, and its title says how it was made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

import tessera
from tessera.counting import mesh_to_counts
from tessera.domains import domains_in_steps
from tessera.settings import Request, Settings
from tessera.steps import finish

from ..pictures import draw_mesh

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from PIL import Image

_COLOURS = 96
_SIDE = 2.7  # inches of a panel


@dataclass(frozen=True)
class Panel:
    """title: the setting and its value; mesh: made with it; marks: (k, 2) places to be shown, if any."""

    title: str
    mesh: tessera.Mesh
    marks: np.ndarray | None = None


def circle(radius: float, at: tuple[float, float] = (0.0, 0.0), n: int = 96) -> np.ndarray:
    """(n, 2) vertices."""
    t = np.arange(n) / n * 2 * np.pi
    return np.array(at) + radius * np.stack([np.cos(t), np.sin(t)], axis=1)


def drop(n: int = 160) -> np.ndarray:
    """A round shape with a point, a narrow and a wide end, (n, 2)."""
    t = np.arange(n) / n * 2 * np.pi
    return np.stack([np.cos(t), 0.62 * np.sin(t) * np.sin(t / 2) ** 1.5], axis=1)


def star(n: int = 200) -> np.ndarray:
    """Five rounded arms, (n, 2)."""
    t = np.arange(n) / n * 2 * np.pi
    return (1 + 0.3 * np.cos(5 * t))[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)


SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
PLATE = [SQUARE, circle(0.45, (0.2, 0.15))]
LEVER = [
    np.array([[-1, -0.8], [-0.2, -0.8], [-0.2, -0.08], [1, -0.08], [1, 0.08], [-0.2, 0.08], [-0.2, 0.8], [-1, 0.8]])
]
ROUND = [np.concatenate([circle(1.0, n=9)[:4], circle(1.0)[38:]])]


def edge_length() -> list[Panel]:
    """Edge Length."""
    return [Panel(f"Edge Length {h:g}", tessera.mesh(PLATE, h)) for h in (0.4, 0.2, 0.1)]


def triangle_count() -> list[Panel]:
    """Size by Triangle Count."""
    panels = []
    counts = (100, 400, 1600)

    def mesh_at(_: list[int], lengths: list[float]):
        return domains_in_steps([Request(PLATE, h) for h in lengths], Settings())

    steps = mesh_to_counts([PLATE] * len(counts), counts, mesh_at)
    for count, mesh in zip(counts, finish(steps), strict=True):
        panels.append(Panel(f"Triangles {count}: {mesh.report.n_triangles}", mesh))
    return panels


def curvature() -> list[Panel]:
    """By Curvature."""
    panels = [Panel("off", tessera.mesh([drop()], 0.2))]
    for ratio in (0.5, 0.2):
        mesh = tessera.mesh([drop()], 0.2, sizing=tessera.by_curvature(ratio))
        panels.append(Panel(f"By Curvature, Edge / Radius {ratio:g}", mesh))
    return panels


def distance() -> list[Panel]:
    """By Boundary."""
    panels = [Panel("off", tessera.mesh(PLATE, 0.3))]
    for near, reach in ((0.06, None), (0.06, 2.0)):
        mesh = tessera.mesh(PLATE, 0.3, sizing=tessera.by_distance(near, reach=reach))
        panels.append(Panel(f"At Boundary {near:g}, Reach {reach or 0:g}", mesh))
    return panels


def thickness() -> list[Panel]:
    """By Thickness."""
    panels = [Panel("off", tessera.mesh(LEVER, 0.25))]
    for across in (2, 4):
        mesh = tessera.mesh(LEVER, 0.25, sizing=tessera.by_thickness(across))
        panels.append(Panel(f"By Thickness, Across {across}", mesh))
    return panels


def weight() -> list[Panel]:
    """By Weight: painted 1 at the marks, 0 at the other points of a grid."""
    x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 9))
    grid = np.column_stack([x.ravel(), y.ravel()])
    painted = np.hypot(*(grid - [-0.5, -0.5]).T) < 0.4
    panels = [Panel("off", tessera.mesh([SQUARE], 0.25))]
    for length in (0.125, 0.05):
        sizing = tessera.from_values(grid, np.where(painted, length, 0.25))
        mesh = tessera.mesh([SQUARE], 0.25, sizing=sizing)
        panels.append(Panel(f"By Weight, At Weight 1 {length:g}", mesh, grid[painted]))
    return panels


def near_object() -> list[Panel]:
    """By Object: an empty at the mark."""
    empty = np.array([[-0.3, 0.4]])
    panels = [Panel("off", tessera.mesh([SQUARE], 0.25), empty)]
    for reach in (None, 1.5):
        mesh = tessera.mesh([SQUARE], 0.25, sizing=tessera.by_distance(0.04, empty, reach=reach))
        panels.append(Panel(f"At Object 0.04, Reach {reach or 0:g}", mesh, empty))
    return panels


def shortest() -> list[Panel]:
    """Shortest Edge, with By Curvature."""
    panels = []
    for least in (None, 0.05, 0.1):
        mesh = tessera.mesh([drop()], 0.2, sizing=tessera.by_curvature(0.2), min_edge_length=least)
        panels.append(Panel(f"Shortest Edge {least or 0:g}", mesh))
    return panels


def gradation() -> list[Panel]:
    """Gradation, with By Object."""
    empty = np.array([[0.0, 0.0]])
    panels = []
    for factor in (1.1, 1.3, 2.0):
        mesh = tessera.mesh([SQUARE], 0.3, sizing=tessera.by_distance(0.03, empty), gradation=factor)
        panels.append(Panel(f"Gradation {factor:g}", mesh, empty))
    return panels


def boundary() -> list[Panel]:
    """Boundary: the marks are the outline's own vertices."""
    outline = drop(28)
    return [
        Panel("Boundary Resample", tessera.mesh([outline], 0.2), outline),
        Panel("Boundary Keep", tessera.mesh([outline], 0.2, boundary="keep"), outline),
    ]


def corners() -> list[Panel]:
    """Corner Angle, on an outline that turns by 22 to 40 degrees at the marks."""
    panels = []
    for angle in (20, 60):
        panels.append(Panel(f"Corner Angle {angle}°", tessera.mesh(ROUND, 0.33, corner_angle=angle), ROUND[0][:4]))
    return panels


def finish_settings() -> list[Panel]:
    """Relaxation Passes, Flip Edges, Smoothing Steps."""
    panels = []
    for title, more in (
        ("Relaxation Passes 0", {"passes": 0}),
        ("3 (default)", {}),
        ("Flip Edges", {"flips": True}),
        ("Smoothing Steps 3", {"smooth": 3}),
    ):
        mesh = tessera.mesh([star()], 0.14, **more)
        panels.append(Panel(f"{title}: worst {mesh.report.q_worst:.3f}, mean {mesh.report.q_mean:.3f}", mesh))
    return panels


PICTURES: dict[str, Callable[[], list[Panel]]] = {
    "edge_length": edge_length,
    "triangle_count": triangle_count,
    "use_curvature": curvature,
    "use_distance": distance,
    "use_thickness": thickness,
    "use_weight": weight,
    "use_object": near_object,
    "min_edge_length": shortest,
    "gradation": gradation,
    "boundary": boundary,
    "corner_angle": corners,
    "finish": finish_settings,
}


def draw_all(folder: Path) -> None:
    """A picture for each, named as the setting."""
    for name, panels in PICTURES.items():
        draw(panels(), folder / f"setting_{name}.png")


def draw(panels: list[Panel], path: Path) -> None:
    """The panels beside each other, as a PNG of few colours."""
    figure, axes = plt.subplots(1, len(panels), figsize=(_SIDE * len(panels), _SIDE))
    for ax, panel in zip(axes, panels, strict=True):
        draw_mesh(ax, panel.mesh.vertices, panel.mesh.triangles)
        if panel.marks is not None:
            ax.plot(*panel.marks.T, "o", color="#e63946", ms=3.5, zorder=3)
        ax.set_title(panel.title, fontsize=7)
    figure.tight_layout()
    figure.savefig(path, dpi=110, bbox_inches="tight")
    plt.close(figure)
    with Image.open(path) as drawn:
        few = drawn.convert("RGB").quantize(_COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
