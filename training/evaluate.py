"""Evaluate the shipped networks: ``python -m training.evaluate``. Prints and writes ``docs/results/scheme.md``.

The whole scheme against the reference mesher on held-out sector contours, from a seed that training never uses.
"""

from __future__ import annotations

import numpy as np

from tessera.quality import element_quality
from tessera.scheme import ContourMeshes, join_vertices, mesh_contours
from tessera.stopwatch import Stopwatch

from . import configuration, contours, reference


def held_out(count: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transformed sector contours, N_C 4 to 16 in turn, l_s 0.3 to 1: points (n, 16, 2), n_contour (n,), l_s (n,)."""
    rng = np.random.default_rng(seed)
    points, n_contour = np.zeros((count, 16, 2)), 4 + np.arange(count) % 13
    for row, n in enumerate(n_contour):
        points[row, :n] = contours.transformed_sector(rng, int(n))
    return points, n_contour, rng.uniform(0.3, 1, count)


def qualities(points: np.ndarray, meshes: ContourMeshes, n_contour: np.ndarray) -> np.ndarray:
    """(n, 2) worst and mean element quality of each contour's mesh."""
    vertices = join_vertices(points, n_contour, meshes.inner, meshes.n_inner)
    quality = element_quality(vertices.reshape(-1, 2), meshes.triangles + meshes.owner[:, None] * vertices.shape[1])
    worst = np.ones(len(points))
    np.minimum.at(worst, meshes.owner, quality)
    return np.stack([worst, np.bincount(meshes.owner, quality) / np.bincount(meshes.owner)], axis=1)


def reference_meshes(points: np.ndarray, n_contour: np.ndarray, l_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gmsh's (q_worst, q_mean) (n, 2) and inner vertices (n,) of each contour."""
    reference.start()
    quality, inner = np.zeros((len(points), 2)), np.zeros(len(points), dtype=int)
    for row, n in enumerate(n_contour):
        vertices, triangles = reference.mesh(points[row, :n], l_s[row])
        q = element_quality(vertices, triangles)
        quality[row], inner[row] = (q.min(), q.mean()), len(vertices) - n
    return quality, inner


def table(
    n_contour: np.ndarray, error: np.ndarray, flipped: np.ndarray, count_error: np.ndarray, fallbacks: np.ndarray
) -> str:
    """Markdown: a row for each N_C, and one for all. error, flipped: (n, 2), without and with the flip pass."""
    lines = [
        "| N_C | contours | ē_worst | ± | ē_mean | ± | flips: ē_worst | ē_mean | N_I off by | with fallbacks |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, rows in [*((str(n), n_contour == n) for n in np.unique(n_contour)), ("all", n_contour > 0)]:
        count = rows.sum()
        mean, spread = 100 * error[rows].mean(axis=0), 100 * error[rows].std(axis=0) / np.sqrt(count)
        better = 100 * flipped[rows].mean(axis=0)
        lines.append(
            f"| {name} | {count} | {mean[0]:+.1f} % | {spread[0]:.1f} | {mean[1]:+.1f} % | {spread[1]:.1f} "
            f"| {better[0]:+.1f} % | {better[1]:+.1f} % | {count_error[rows].mean():.2f} "
            f"| {(fallbacks[rows] > 0).sum()} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Print and write the table."""
    config = configuration.read()
    count, seed = config["test"]["contours"], config["data"]["seeds"]["test"]
    points, n_contour, l_s = held_out(count, seed)
    meshes = mesh_contours(points, n_contour, l_s, Stopwatch())
    ours = qualities(points, meshes, n_contour)
    watch = Stopwatch()
    flipped = qualities(points, mesh_contours(points, n_contour, l_s, watch, flips=True), n_contour)
    flips, whole = (1e6 / count * seconds for seconds in (watch.seconds["flips"], sum(watch.seconds.values())))
    theirs, inner = reference_meshes(points, n_contour, l_s)
    text = "\n".join(
        [
            "# The whole scheme against the reference mesher",
            "",
            f"{count} held-out sector contours (seed {seed}), l_s 0.3 to 1; Gmsh {reference.VERSION}, contour edges",
            "frozen, sizes as in `training/reference.py`. ē = mean of (q_reference − q) / q_reference: negative is",
            "better than the reference; ± is its standard error. The networks alone, no smoothing after them. Under",
            f"*flips*, the same with `flips=True`, which takes {flips:.0f} of a contour's {whole:.0f} µs. Made by",
            "`make evaluate`.",
            "",
            table(
                n_contour,
                (theirs - ours) / theirs,
                (theirs - flipped) / theirs,
                np.abs(meshes.wanted - inner),
                meshes.fallbacks,
            ),
            "",
            "Goals, over all: ē_worst ≤ 15 %, ē_mean ≤ 4 %. The paper's worst group: 27.3 % and 15.2 %.",
            "",
        ]
    )
    print(text)
    file = configuration.ROOT / "docs" / "results" / "scheme.md"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


if __name__ == "__main__":
    main()
