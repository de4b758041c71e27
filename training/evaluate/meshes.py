"""Meshes of a batch of contours: what is measured of them, and whether they are valid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tessera.quality import element_quality

from .. import measures
from .sets import Contours

MEASURES = ("q_worst", "q_mean", "smallest angle", "deviation")
_AREA_TOLERANCE = 1e-9  # of the contour's area


@dataclass(frozen=True)
class Meshes:
    """Meshes of B contours, in the slots of padded rows of vertices."""

    points: np.ndarray  # (B, V, 2) float64: the contour's vertices, then the inner ones, then padding
    n_contour: np.ndarray  # (B,) int64
    n_inner: np.ndarray  # (B,) int64
    triangles: np.ndarray  # (t, 3) int64, counter-clockwise
    owner: np.ndarray  # (t,) int64, ascending

    @property
    def corners(self) -> np.ndarray:
        """(t, 3, 2) the elements' corners."""
        return self.points[self.owner[:, None], self.triangles]

    @property
    def flat(self) -> np.ndarray:
        """(t, 3) the elements' vertices in ``points`` as one array (B V, 2)."""
        return self.triangles + self.owner[:, None] * self.points.shape[1]


def gather(contours: Contours, meshes: Sequence[tuple[np.ndarray, np.ndarray] | None]) -> Meshes:
    """A batch of single meshes, (vertices (n, 2), triangles (m, 3)) each, contours first; None where there is none."""
    n_inner = np.array(
        [0 if mesh is None else len(mesh[0]) - n for mesh, n in zip(meshes, contours.n_contour, strict=True)]
    )
    points = np.zeros((len(contours), int((contours.n_contour + n_inner).max(initial=3)), 2))
    size = min(points.shape[1], contours.points.shape[1])
    points[:, :size] = contours.points[:, :size]
    triangles, owner = [np.zeros((0, 3), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for row, mesh in enumerate(meshes):
        if mesh is not None:
            points[row, : len(mesh[0])] = mesh[0]
            triangles.append(mesh[1])
            owner.append(np.full(len(mesh[1]), row))
    return Meshes(points, contours.n_contour, n_inner, np.concatenate(triangles), np.concatenate(owner))


def only_valid(meshes: Meshes, contours: Contours) -> Meshes:
    """The same without meshes that are not valid, and without their inner vertices."""
    valid = are_valid(meshes, contours)
    kept = valid[meshes.owner]
    n_inner = np.where(valid, meshes.n_inner, 0)
    return Meshes(meshes.points, meshes.n_contour, n_inner, meshes.triangles[kept], meshes.owner[kept])


def measure(meshes: Meshes, l_s: np.ndarray) -> np.ndarray:
    """(B, 4) of each mesh: worst and mean quality, smallest angle in degrees, mean deviation of inner edges from l_s.

    NaN where there is no mesh.
    """
    n_rows, owner = len(meshes.n_contour), meshes.owner
    count = np.bincount(owner, minlength=n_rows)
    quality = element_quality(meshes.points.reshape(-1, 2), meshes.flat)
    found = np.full((n_rows, len(MEASURES)), np.inf)
    np.minimum.at(found[:, 0], owner, quality)
    found[:, 1] = np.bincount(owner, quality, minlength=n_rows) / np.maximum(count, 1)
    np.minimum.at(found[:, 2], owner, _smallest_angles(meshes.corners))
    ends = np.cumsum(count)
    for row, (start, end) in enumerate(zip(ends - count, ends, strict=True)):
        found[row, 3] = measures.deviation(
            meshes.points[row], meshes.triangles[start:end], meshes.n_contour[row], l_s[row]
        )
    found[count == 0] = np.nan
    return found


def _smallest_angles(corners: np.ndarray) -> np.ndarray:
    """(t,) smallest angle of triangles (t, 3, 2), in degrees; 0 or less where inverted."""
    ahead = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, (ahead * back).sum(axis=-1))).min(axis=1)


def are_valid(meshes: Meshes, contours: Contours) -> np.ndarray:
    """(B,) whether each mesh covers its contour exactly once, by code that shares nothing with the mesher.

    All elements have a positive area, as much as the contour's together; there are N_C + 2 N_I - 2 of them; they use
    every vertex; none runs along an edge in the direction of another; and those edges that only one has are the
    contour's own.
    """
    n_rows, width = meshes.points.shape[:2]
    n_contour, n_used = contours.n_contour, contours.n_contour + meshes.n_inner
    owner, triangles = meshes.owner, meshes.triangles
    valid = np.bincount(owner, minlength=n_rows) == n_contour + 2 * meshes.n_inner - 2
    index = np.arange(contours.points.shape[1])
    own = index < n_contour[:, None]
    same = meshes.points[:, : own.shape[1]] == contours.points[:, :width]
    valid &= (same | ~own[:, :width, None]).all(axis=(1, 2))
    valid[owner[((triangles < 0) | (triangles >= n_used[owner][:, None])).any(axis=1)]] = False

    a, b, c = np.moveaxis(meshes.corners, 1, 0)
    double_area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    valid[owner[~(double_area > 0)]] = False
    x, y = np.moveaxis(contours.points, -1, 0)
    after = np.where(index + 1 < n_contour[:, None], index + 1, 0)
    cross = x * np.take_along_axis(y, after, axis=1) - y * np.take_along_axis(x, after, axis=1)
    wanted = (cross * own).sum(axis=1)
    covered = np.bincount(owner, double_area, minlength=n_rows)
    valid &= np.abs(covered - wanted) <= _AREA_TOLERANCE * wanted

    used = np.bincount(np.unique(meshes.flat) // width, minlength=n_rows)
    valid &= used == n_used
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    row = np.repeat(owner, 3)
    key, times = np.unique((row * width + start) * width + end, return_counts=True)
    valid[key[times > 1] // width**2] = False
    once = ~np.isin((row * width + start) * width + end, (row * width + end) * width + start)
    valid &= np.bincount(row[once], minlength=n_rows) == n_contour
    valid[row[once & (end != (start + 1) % n_contour[row])]] = False
    return valid
