"""``python -m benchmarks.domains [--quick] [--random 2000]``: measure, print and write docs/results/domains.md."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import numpy as np

import tessera

from . import pictures, report
from .cases import all_cases
from .comparison import Found, mesh_cases, mesh_circles
from .goals import growth_goals, quality_goals, validity_goal
from .growth import LARGE, SIZES, Circle, measure_all
from .invalid import Outcomes, count_invalid
from .meshers import OURS, Meshed, boundary_edges
from .pictures import Window

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "results"
_NOSE, _TAIL = (-0.005, 0.12, -0.05, 0.05), (0.88, 1.005, -0.02, 0.02)
_WINDOW, _NEAR = 20, 200  # edge lengths across, of a detail; elements that these are of


def main() -> None:
    """Measure everything, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help=f"circles of up to {LARGE:,} triangles only")
    parser.add_argument("--random", type=int, default=2_000, help="random domains (default: %(default)s)")
    arguments = parser.parse_args()
    processes = os.cpu_count() or 1
    # First, while nothing else runs.
    circles = measure_all(LARGE if arguments.quick else SIZES[-1])
    found = mesh_cases(range(len(all_cases())), processes)
    print(write(FOLDER, found, circles, count_invalid(arguments.random, processes), mesh_circles()))


def write(folder: Path, found: Found, circles: list[Circle], outcomes: Outcomes, around: list[tessera.Report]) -> str:
    """Write the page and its pictures; returns the page's text."""
    folder.mkdir(parents=True, exist_ok=True)
    results = [(case, measures) for case, _, measures in found]
    goals = [*quality_goals(results), *growth_goals(circles), validity_goal(outcomes)]
    text = report.page(goals, results, circles, outcomes, around)
    draw(folder, found)
    pictures.draw_growth(folder / report.file_of("growth"), circles)
    (folder / "domains.md").write_text(text + "\n")
    return text


def draw(folder: Path, found: Found) -> None:
    """The pictures of all meshes."""
    of = {kind: [meshes for case, meshes, _ in found if case.kind == kind] for kind in ("circle", "airfoil", "plate")}
    pictures.draw_side_by_side(folder / report.file_of("circle"), of["circle"] + of["plate"])
    pictures.draw_airfoil(folder / report.file_of("airfoil"), of["airfoil"][0], [_NOSE, _TAIL])
    glyphs, outlines = ([one for one in found if one[0].kind == kind] for kind in ("glyph", "outline"))
    pictures.draw_below(folder / report.file_of("glyphs"), [meshes for _, meshes, _ in glyphs], 6)
    pictures.draw_below(folder / report.file_of("outlines"), [meshes for _, meshes, _ in outlines], 6)
    details = [(meshes, _around_worst(meshes[OURS])) for _, meshes, _ in outlines]
    pictures.draw_details(folder / report.file_of("details"), details)


def _around_worst(mesh: Meshed) -> Window:
    """A square around the worst element that has an inner vertex, so many lengths of the edges there wide."""
    on_boundary = np.isin(mesh.triangles, np.unique(boundary_edges(mesh.triangles))).all(axis=1)
    quality = tessera.element_quality(mesh.vertices, mesh.triangles)
    corners = mesh.vertices[mesh.triangles]
    middles = corners.mean(axis=1)
    x, y = middles[np.argmin(np.where(on_boundary, np.inf, quality))]
    near = np.argsort(np.linalg.norm(middles - (x, y), axis=1))[:_NEAR]
    half = 0.5 * _WINDOW * float(np.median(np.linalg.norm(corners[near] - np.roll(corners[near], 1, axis=1), axis=2)))
    return x - half, x + half, y - half, y + half


if __name__ == "__main__":
    main()
