"""Random contours, all of which must get a valid mesh: ``python -m benchmarks.validity [--contours 20000]``.

Contours of 3 to 16 edges go through the scheme, polygons of any size through `tessera.mesh_many`; the checker is the
tests' own. Exit status 0 only if every mesh is valid.
"""

from __future__ import annotations

import argparse

import numpy as np
from tqdm import tqdm

import tessera
from tessera.contour import clean_domains
from tessera.scheme import join_vertices, mesh_contours
from tessera.stopwatch import Stopwatch
from tests.validity import check_many, check_mesh

BATCH = 500


def random_contours(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Star-shaped contours, from round to needle-like, some with collinear runs: (n, 16, 2), n_contour (n,), l (n,)."""
    n_contour = rng.integers(3, 17, count)
    points = np.zeros((count, 16, 2))
    for row, n in enumerate(n_contour):
        angle = 2 * np.pi * (np.arange(n) + rng.uniform(0, 0.75, n)) / n
        radius = rng.uniform(rng.choice([0.05, 0.3, 0.8]), 1, n)
        points[row, :n] = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        if n % 2 == 0 and rng.random() < 0.3:
            points[row, 1:n:2] = (points[row, 0:n:2] + np.roll(points[row, 0:n:2], -1, axis=0)) / 2
        points[row, :n] *= [1, rng.choice([1, 0.3, 0.01])]
    return points, n_contour, rng.uniform(0.15, 2, count)


def simple(points: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(n,) which contours the library itself accepts as they are."""
    cleaned = clean_domains([[row[:n]] for row, n in zip(points, n_contour, strict=True)])
    same = [
        isinstance(loops, list) and np.array_equal(loops[0], row[:n])
        for loops, row, n in zip(cleaned, points, n_contour, strict=True)
    ]
    return np.array(same)


def main() -> None:
    """Mesh and check, with a progress bar."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--contours", type=int, default=20_000)
    parser.add_argument("--polygons", type=int, default=1_000)
    arguments = parser.parse_args()
    rng = np.random.default_rng(2024)
    done = fallbacks = 0
    with tqdm(total=arguments.contours, desc="scheme") as progress:
        while done < arguments.contours:
            points, n_contour, length = random_contours(rng, BATCH)
            keep = np.flatnonzero(simple(points, n_contour))[: arguments.contours - done]
            points, n_contour, length = points[keep], n_contour[keep], length[keep]
            meshes = mesh_contours(points, n_contour, length, Stopwatch())
            vertices = join_vertices(points, n_contour, meshes.inner, meshes.n_inner)
            check_many(vertices, n_contour, meshes.n_inner, meshes.triangles, meshes.owner)
            fallbacks += int((meshes.fallbacks > 0).sum())
            done += len(keep)
            progress.update(len(keep))
    polygons = []
    for _ in range(arguments.polygons):
        n = int(rng.integers(3, 200))
        angle = (np.arange(n) + rng.uniform(0, 0.9, n)) * 2 * np.pi / n
        radius = rng.uniform(rng.choice([0.1, 0.5, 0.9]), 1, n)
        polygons.append(radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    meshes = tessera.mesh_many([[polygon] for polygon in polygons], 0.15)
    for polygon, mesh in zip(tqdm(polygons, desc="whole way"), meshes, strict=True):
        if isinstance(mesh, tessera.ContourError):
            raise mesh
        check_mesh(mesh.vertices, mesh.triangles, [polygon], keep=False)
    print(f"{done} contours and {len(polygons)} polygons: all meshes valid; {fallbacks} contours needed a fallback")


if __name__ == "__main__":
    main()
