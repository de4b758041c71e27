"""The paper's sector contours, transformed as the scheme does, and what makes a contour good enough to learn from."""

from __future__ import annotations

import numpy as np

from tessera.transform import superimpose

INNER_RADIUS = 0.3  # of the circle that sector contours stay out of
LARGEST_CONTOUR = 16
# Sorts of contours in the data: these here, and those that the running system makes (`running.py`).
KINDS = ("sector", "cell", "triangle", "cavity", "star")


def draw_sector(rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """One transformed sector contour, (N_C, 2) float64, counter-clockwise and simple, and its l_s."""
    while True:
        points, l_s = sector(rng)
        if is_good(points):
            return transformed(points)[0], l_s


def transformed_sector(rng: np.random.Generator, n: int) -> np.ndarray:
    """One transformed sector contour of n edges, (n, 2)."""
    while True:
        points, _ = sector(rng, n)
        if is_good(points):
            return transformed(points)[0]


def transformed(points: np.ndarray) -> tuple[np.ndarray, float]:
    """A contour superimposed on the regular polygon, and the scale."""
    transformation = superimpose(points[None], np.array([len(points)]))
    points = np.roll(transformation.apply(points[None])[0], -int(transformation.first[0]), axis=0)
    return points, float(transformation.scale[0])


def sector(rng: np.random.Generator, n: int | None = None) -> tuple[np.ndarray, float]:
    """A vertex at random in each of N_C equal sectors of the unit disk (section 2.2), and l_s from 0.25 to 1.1."""
    n = int(rng.integers(3, LARGEST_CONTOUR + 1)) if n is None else n
    angle = 2 * np.pi * (np.arange(n) + rng.random(n)) / n
    radius = np.sqrt(rng.uniform(INNER_RADIUS**2, 1, n))
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1), float(rng.uniform(0.25, 1.1))


def is_good(points: np.ndarray) -> bool:
    """Whether a contour is counter-clockwise, simple and not hopelessly thin at any vertex."""
    nxt = np.roll(points, -1, axis=0)
    area = 0.5 * np.sum(points[:, 0] * nxt[:, 1] - points[:, 1] * nxt[:, 0])
    lengths = np.linalg.norm(nxt - points, axis=1)
    if area < 0.02 * lengths.sum() ** 2 / 12 or lengths.min() < 0.02 * lengths.mean():
        return False
    back = np.roll(points, 1, axis=0) - points
    ahead = nxt - points
    angle = np.arctan2(ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0], (ahead * back).sum(axis=1)) % (2 * np.pi)
    if angle.min() < np.radians(3) or angle.max() > np.radians(357):
        return False
    i, j = np.triu_indices(len(points), 2)
    apart = ~((i == 0) & (j == len(points) - 1))
    return not bool(_crossing(points[i], nxt[i], points[j], nxt[j])[apart].any())


def _crossing(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    def side(p, q, r):
        return (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])

    return (side(a, b, c) * side(a, b, d) <= 0) & (side(c, d, a) * side(c, d, b) <= 0)
