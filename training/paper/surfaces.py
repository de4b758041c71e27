"""Adaptive sampling of inner vertices (section 2.5.3, Figs. 15 and 16): quality surfaces and their curvature.

``python -m training.paper.surfaces`` keeps the meshes that the report draws surfaces of.
"""

from __future__ import annotations

import numpy as np

from tessera.cavity import signed_distances
from tessera.paper_placement import grid_points

from .. import tables
from . import settings
from .comparing import write
from .data import load
from .sampling import APART, GRID

EACH = 45  # vertices of a surface (section 3.2.4)
APART_OF_SEVERAL = 0.3  # of l_s
_SIGMA = 1.5  # of the smoothing, in grid spacings
_FLOOR = 0.05  # of the largest weight, so that flat parts are seen too


def main() -> None:
    """Keep the examples."""
    config, _ = settings.from_command_line(__doc__)
    keep_examples(config)


def keep_examples(config: dict) -> None:
    """The first meshes with one and with two inner vertices (Fig. 15, Fig. 16): contour, inner vertices and l_s."""
    population, found = load(config, "train", config["nn3_star"]["n_contour"]), []
    for m in (1, 2):
        group = population.group(m)
        if len(group):
            example = {"contour": group.contour[0].tolist(), "inner": group.inner[0].tolist()}
            found.append(example | {"l_s": float(group.l_s[0])})
    write(config, "surfaces", found)


def inside(contour: np.ndarray, l_s: float) -> np.ndarray:
    """(R²,) bool: the grid points inside a contour and not too close to it."""
    points, n = grid_points(GRID)[None], np.array([len(contour)])
    return (signed_distances(points, contour[None], n) >= APART * l_s)[0]


def quality_surfaces(contour: np.ndarray, others: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """(N_C, R, R) worst quality of the mesh where each edge is connected to a vertex at a grid point; 0 elsewhere.

    others: (N_I - 1, 2) further vertices of the mesh; chosen: (R²,) the grid points that are looked at.
    """
    places, n = grid_points(GRID)[chosen], len(contour)
    own = np.broadcast_to(np.concatenate([contour, others]), (len(places), n + len(others), 2))
    points = np.insert(own, n, places, axis=1)
    found = tables.connection_tables(points, np.full(len(points), n), np.full(len(points), 1 + len(others)))
    surfaces = np.zeros((n, GRID * GRID))
    surfaces[:, chosen] = found[:, :, n, 0].T
    return surfaces.reshape(n, GRID, GRID)


def smoothed(surfaces: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Surfaces (N_C, R, R) after a Gaussian mean over the chosen points, each scaled to keep its maximum."""
    mask = chosen.reshape(GRID, GRID)
    weight = np.maximum(_gaussian(mask[None].astype(float)), 1e-9)
    mean = np.where(mask, _gaussian(surfaces) / weight, 0)
    highest = np.maximum(mean.max(axis=(1, 2), keepdims=True), 1e-9)
    return mean * surfaces.max(axis=(1, 2), keepdims=True) / highest


def _gaussian(surfaces: np.ndarray) -> np.ndarray:
    """Along both axes, (k, R, R)."""
    steps = np.arange(GRID)
    kernel = np.exp(-0.5 * ((steps[:, None] - steps) / _SIGMA) ** 2)
    return kernel @ surfaces @ kernel.T


def curvature(surfaces: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """(N_C, R²) size of the second derivatives of surfaces (N_C, R, R), 0 where not chosen."""
    gy, gx = np.gradient(surfaces, axis=(1, 2))
    gyy, gyx = np.gradient(gy, axis=(1, 2))
    gxx = np.gradient(gx, axis=2)
    size = np.sqrt(gxx**2 + 2 * gyx**2 + gyy**2).reshape(len(surfaces), -1)
    return np.where(chosen, size, 0)


def sampled(rng: np.random.Generator, surfaces: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """(N_C, 45) numbers of grid points, drawn the more often the more the smoothed surface is curved there.

    By the root of the curvature: linear interpolation between samples a distance h apart is wrong by h² times it, over
    an area of h², so that with this density every sample stands for as much of the error ("curvature loss").
    """
    weight = np.sqrt(curvature(smoothed(surfaces, chosen), chosen))
    weight = np.where(chosen, weight + _FLOOR * weight.max(axis=1, keepdims=True) + 1e-12, 0)
    # Drawn without replacement: the largest of the logarithms with Gumbel noise.
    with np.errstate(divide="ignore"):
        key = np.log(weight) + rng.gumbel(size=weight.shape)
    return np.argsort(-key, axis=1)[:, : min(EACH, int(chosen.sum()))]


if __name__ == "__main__":
    main()
