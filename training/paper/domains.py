"""Table 2, Figs. 28 to 30: ``python -m training.paper.domains``. A circle, an airfoil and a plate with a hole.

By the shipped networks alone: domains are divided into sub-contours of 3 to 16 edges, and the paper's networks know
even numbers of random contours only. The paper does not give its contours; these are like its figures.
"""

from __future__ import annotations

import numpy as np

import tessera

from ..domains import naca
from . import settings
from .comparing import write


def main() -> None:
    """Mesh, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    mesh_all(config)


def mesh_all(config: dict) -> None:
    """Qualities of the three meshes, and the meshes themselves for the picture."""
    found, arrays = [], {}
    for name, mesh in meshes().items():
        report = mesh.report
        row = {"name": name, "q_worst": report.q_worst, "q_mean": report.q_mean, "vertices": report.n_vertices}
        found.append(row | {"triangles": report.n_triangles})
        arrays |= {f"{name} vertices": mesh.vertices, f"{name} triangles": mesh.triangles}
        print(f"{name}: ({report.q_worst:.2f}, {report.q_mean:.2f}), {report.n_triangles} triangles", flush=True)
    write(config, "domains", found)
    np.savez(config["folders"]["runs"] / "results" / "domains.npz", **arrays)


def meshes() -> dict[str, tessera.Mesh]:
    """A circle of 150 edges at a uniform length; an airfoil, finer where it is curved; a hole, finer around it."""
    circle, hole = circle_of(150), 0.35 * circle_of(80)
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return {
        "Circle": tessera.mesh([circle], 0.15),
        "Airfoil": tessera.mesh([naca("0018")], 0.05, sizing=tessera.by_curvature(), min_edge_length=0.008),
        "Contour with hole": tessera.mesh([square, hole], 0.2, sizing=tessera.by_distance(0.07, hole)),
    }


def circle_of(count: int) -> np.ndarray:
    """A regular polygon (count, 2) in the unit circle."""
    angle = 2 * np.pi * np.arange(count) / count
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


if __name__ == "__main__":
    main()
