"""Random contours: the paper's sector contours, and those that division, refinement and relaxation really make."""

from __future__ import annotations

import numpy as np

from tessera.transform import superimpose

INNER_RADIUS = 0.3  # of the circle that sector contours stay out of
LARGEST_CONTOUR = 16

KINDS = ("sector", "cell", "star")


def draw(rng: np.random.Generator, kind: str) -> tuple[np.ndarray, float]:
    """One transformed contour of a kind, (N_C, 2) float64, counter-clockwise and simple, and its l_s."""
    while True:
        points, edge_length = {"sector": sector, "cell": cell, "star": star}[kind](rng)
        if is_good(points):
            points, scale = transformed(points)
            return points, edge_length if kind == "sector" else edge_length * scale


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


def cell(rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """A polygon of few corners whose sides are divided evenly, straight or bent: a division's cell, a refined element.

    Its target is the mean edge length, give or take a quarter.
    """
    while True:
        corners, _ = sector(rng, int(rng.integers(3, 9)))
        stretch = rng.uniform(0.4, 1)
        corners = corners * [1, stretch]
        sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
        spacing = sides.sum() / rng.uniform(len(corners), LARGEST_CONTOUR)
        counts = np.maximum(1, np.round(sides / spacing * rng.uniform(0.85, 1.15, len(sides)))).astype(int)
        if counts.sum() <= LARGEST_CONTOUR:
            break
    parts = []
    for start, end, count in zip(corners, np.roll(corners, -1, axis=0), counts, strict=True):
        t = np.arange(count) / count
        normal = np.array([start[1] - end[1], end[0] - start[0]])
        bend = rng.normal(0, 0.08) * (rng.random() < 0.4)
        parts.append(start + t[:, None] * (end - start) + (4 * bend * t * (1 - t))[:, None] * normal)
    points = np.concatenate(parts)
    edges = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    return points, float(edges.mean() * rng.uniform(0.75, 1.25))


def star(rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """The ring of neighbours of one vertex of a mesh; its target is the mean edge length."""
    n = int(rng.integers(4, 10))
    angle = 2 * np.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
    radius = np.exp(rng.normal(0, 0.18, n))
    points = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1) * [1, rng.uniform(0.6, 1)]
    edges = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    return points, float(max(edges.mean(), 0.8))


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
