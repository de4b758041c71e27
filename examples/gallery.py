"""A picture of what domains can be: ``python -m examples.gallery`` writes docs/images/gallery.png.

A plate whose elements are small around its hole, a gear by the thickness of its parts, letters with holes.
"""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

import tessera

from .pictures import FOLDER, draw_mesh

matplotlib.use("Agg")
import matplotlib.pyplot as plt

LETTERS = "B&8"


def circle(radius: float, n: int = 200) -> np.ndarray:
    """(n, 2) vertices around the origin."""
    t = np.arange(n) / n * 2 * np.pi
    return radius * np.stack([np.cos(t), np.sin(t)], axis=1)


def gear(teeth: int = 14) -> np.ndarray:
    """The outline of a gear, (4 teeth, 2)."""
    t = (np.arange(4 * teeth) - 0.5) / (4 * teeth) * 2 * np.pi
    radius = np.tile([0.82, 1.0, 1.0, 0.82], teeth)
    return radius[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1)


def main() -> None:
    """Mesh and draw."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    by_radius = tessera.by_distance(0.03, circle(0.4, 60), reach=0.6)
    meshes = [
        tessera.mesh([square, circle(0.4)], 0.2, sizing=by_radius),
        tessera.mesh([gear(), circle(0.3)], 0.2, sizing=tessera.by_thickness(3)),
    ]
    font = FontProperties(family="DejaVu Serif")
    for letter in LETTERS:
        # Closed polygons end where they started.
        outline = [polygon[:-1] for polygon in TextPath((0, 0), letter, size=10, prop=font).to_polygons()]
        meshes.append(tessera.mesh(outline, 0.4))
    figure, axes = plt.subplots(1, len(meshes), figsize=(15, 3.2))
    for ax, mesh in zip(axes, meshes, strict=True):
        draw_mesh(ax, mesh.vertices, mesh.triangles)
        report = mesh.report
        title = f"{report.n_triangles} triangles, q {report.q_worst:.2f} at worst, {report.q_mean:.3f} on average"
        ax.set_title(title, fontsize=7)
    figure.tight_layout()
    figure.savefig(FOLDER / "gallery.png", dpi=90)


if __name__ == "__main__":
    main()
