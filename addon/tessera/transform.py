"""Feature transformation: Procrustes superimposition of contours onto the regular polygon (paper, section 2.2).

A contour and the regular polygon of as many vertices in the unit circle are centred and normalised; the rotation and
the scale that bring the contour closest to the polygon are applied. In the plane, with vertices as complex numbers,
the SVD of the paper reduces to one inner product ``c = <polygon, contour>``: the optimal rotation is ``conj(c) /
|c|`` and the trace of the singular values (reflections excluded) is ``|c|``.

A cyclic shift of the polygon is a rotation of it, so every choice of "which contour vertex meets the polygon's first
one" has the same residual. So that the transformation does not depend on where the user's curve starts, the contour
is first shifted to begin at the vertex farthest from its centre.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

# A contour that hardly resembles the polygon (a spiral, a horseshoe) has a small |c|; scaled by it, it would shrink
# to a speck that no network has seen.
SMALLEST_RESEMBLANCE = 0.5


@dataclass(frozen=True)
class Transformation:
    """Similarity transformations of B contours: ``scale * rotation * (p - centre)`` in complex numbers.

    centre: (B,) complex128; factor: (B,) complex128, scale times rotation; first: (B,) int64, the contour vertex that
    becomes the first one.
    """

    centre: np.ndarray
    factor: np.ndarray
    first: np.ndarray

    @property
    def scale(self) -> np.ndarray:
        """(B,) float64, transformed length over original length (the paper's S)."""
        return np.abs(self.factor)

    def rows(self, rows: np.ndarray) -> Transformation:
        """Those of the chosen contours."""
        return Transformation(self.centre[rows], self.factor[rows], self.first[rows])

    def apply(self, points: np.ndarray) -> np.ndarray:
        """Take (B, n, 2) points of each contour's plane to the transformed one."""
        return _as_points((_as_complex(points) - self.centre[:, None]) * self.factor[:, None])

    def invert(self, points: np.ndarray) -> np.ndarray:
        """Take (B, n, 2) transformed points back."""
        return _as_points(_as_complex(points) / self.factor[:, None] + self.centre[:, None])


def superimpose(contours: np.ndarray, n_contour: np.ndarray) -> Transformation:
    """Find the transformation of each contour onto the regular polygon.

    contours: (B, N, 2) float64, counter-clockwise, the first n_contour (B,) vertices of each count and are not all
    alike.
    """
    centre = np.zeros(len(contours), dtype=np.complex128)
    factor = np.ones(len(contours), dtype=np.complex128)
    first = np.zeros(len(contours), dtype=np.int64)
    for n in sorted(set(n_contour.tolist())):
        rows = n_contour == n
        centre[rows], factor[rows], first[rows] = _superimpose(_as_complex(contours[rows, :n]))
    return Transformation(centre, factor, first)


def _superimpose(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centre, factor and first vertex of contours of the same number of vertices, (B, N_C) complex."""
    n = z.shape[1]
    centre = z.sum(axis=1) / n
    z = z - centre[:, None]
    radius = np.abs(z)
    # Rounded, so that equal radii that differ in the last bits still choose the same vertex.
    first = np.argmax(np.round(radius / radius.max(axis=1, keepdims=True), 9), axis=1)
    size = np.sqrt((radius * radius).sum(axis=1))
    polygon = _regular_polygon(n)
    # Starting with another vertex is turning the polygon.
    c = (z * polygon.conj()).sum(axis=1) * polygon[first] * (np.sqrt(n) / size)
    resemblance = np.abs(c)
    turn = np.where(resemblance > 1e-12, np.conj(c) / np.maximum(resemblance, 1e-12), 1.0)
    scale = np.sqrt(n) * np.maximum(resemblance, SMALLEST_RESEMBLANCE) / size
    return centre, scale * turn, first


@cache
def _regular_polygon(n: int) -> np.ndarray:
    """(n,) complex128 vertices, normalised."""
    return np.exp(2j * np.pi * np.arange(n) / n) / np.sqrt(n)


def _as_complex(points: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(points, dtype=np.float64).view(np.complex128)[..., 0]


def _as_points(z: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(z).view(np.float64).reshape(*z.shape, 2)
