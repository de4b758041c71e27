"""The contours of the speed benchmark: held-out sector contours; kept in ``build/``, as drawing them takes a minute."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from tqdm import tqdm

from training import contours, evaluate, reference

FOLDER = Path(__file__).resolve().parents[1] / "build" / "benchmarks"

# Points (n, 16, 2), numbers of edges (n,) and scaled target edge lengths l_s (n,).
Contours = tuple[np.ndarray, np.ndarray, np.ndarray]


def sixteen_edges(count: int) -> Contours:
    """Contours of 16 edges, l_s 0.3 to 0.6, in which Gmsh puts exactly 12 vertices (about one in eleven)."""
    return _kept(FOLDER / f"sixteen_edges_{count}.npz", lambda: _draw_sixteen_edges(count, seed=1612))


def mixed_sizes(count: int) -> Contours:
    """Contours of 4 to 16 edges, l_s 0.3 to 1."""
    return _kept(file_of_mixed_sizes(count), lambda: evaluate.held_out(count, seed=1416))


def file_of_mixed_sizes(count: int) -> Path:
    """Where `mixed_sizes` keeps them."""
    return FOLDER / f"mixed_sizes_{count}.npz"


def _kept(path: Path, draw: Callable[[], Contours]) -> Contours:
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        points, n_contour, l_s = draw()
        np.savez(path, points=points, n_contour=n_contour, l_s=l_s)
    with np.load(path) as file:
        return file["points"], file["n_contour"], file["l_s"]


def _draw_sixteen_edges(count: int, seed: int) -> Contours:
    rng = np.random.default_rng(seed)
    points, l_s, found = np.zeros((count, 16, 2)), np.zeros(count), 0
    reference.start()
    with tqdm(total=count, desc="contours of 16 edges and 12 inner vertices") as progress:
        while found < count:
            contour, length = contours.transformed_sector(rng, 16), rng.uniform(0.3, 0.6)
            vertices, _ = reference.mesh(contour, length)
            if len(vertices) == 28:
                points[found], l_s[found] = contour, length
                found += 1
                progress.update()
    return points, np.full(count, 16), l_s
