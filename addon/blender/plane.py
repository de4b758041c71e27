"""The plane of a curve: 3-D points of an object to 2-D points at true (world) proportion, and back. No `bpy` here."""

from dataclasses import dataclass

import numpy as np

from ..tessera.errors import ContourError

# How far a point may lie from the plane, as a fraction of the curve's extent. Blender stores single precision, and
# a curve drawn by hand on a surface that looks flat is a good deal farther off than this.
TOLERANCE = 1e-4


@dataclass(frozen=True)
class Plane:
    """origin: (3,); axes: (2, 3), orthonormal; both in the object's space. metric: (2, 2) upper triangular.

    The 2-D point of a 3-D point p is metric @ axes @ (p - origin): distances in 2-D are distances in the world, so that
    a target edge length holds on an object whose scale is not uniform, while the mesh goes back to the object's space.
    """

    origin: np.ndarray
    axes: np.ndarray
    metric: np.ndarray

    def flatten(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) in the object's space to (n, 2) float64 in the plane, in world units."""
        return (points - self.origin) @ self.axes.T @ self.metric.T

    def lift(self, points: np.ndarray) -> np.ndarray:
        """(n, 2) in the plane to (n, 3) float64 in the object's space."""
        return self.origin + np.linalg.solve(self.metric, points.T).T @ self.axes


def fit_plane(points: np.ndarray, to_world: np.ndarray) -> Plane:
    """The plane of a curve's points, seen from the curve's own +Z side.

    points: (n, 3) float64 in the object's space; to_world: (3, 3), the linear part of the object's world matrix.
    Raises ContourError: "not-finite", "not-planar", "zero-area" (all points on a line, or a scale of zero).
    """
    if not np.isfinite(points).all() or not np.isfinite(to_world).all():
        raise ContourError("not-finite", "A coordinate or the transform is not a finite number. Correct it.")
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float(np.linalg.norm(high - low))
    if high[2] - low[2] <= 1e-6 * extent:
        # The usual case keeps the object's own X and Y, and its coordinates to the last bit.
        origin, axes = np.array([0.0, 0.0, points[0, 2]]), np.eye(2, 3)
    else:
        origin = points.mean(axis=0)
        axes = _principal_axes(points - origin, extent)
    return Plane(origin, axes, _metric(to_world @ axes.T))


def _principal_axes(centred: np.ndarray, extent: float) -> np.ndarray:
    _, singular, rows = np.linalg.svd(centred, full_matrices=False)
    if len(singular) < 3 or singular[1] <= 1e-6 * singular[0]:
        raise ContourError("zero-area", "All points lie on one line. Give the outline an area.")
    off = float(np.abs(centred @ rows[2]).max())
    if off > TOLERANCE * extent:
        raise ContourError(
            "not-planar",
            f"It is not planar: a point lies {off:.3g} off the best plane, and {TOLERANCE * extent:.3g} is allowed. "
            "Flatten it, for example by scaling its points to 0 along one axis in Edit Mode.",
        )
    normal = rows[2]
    # Towards the curve's +Z; a curve that stands upright faces -Y, then +X, as Blender's Front and Right views do.
    for toward in ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]):
        side = float(normal @ toward)
        if abs(side) > 1e-6:
            normal = normal * np.sign(side)
            break
    return np.stack([rows[0], np.cross(normal, rows[0])])


def _metric(world_axes: np.ndarray) -> np.ndarray:
    """QR of the axes as the world sees them (3, 2): the triangular factor measures lengths, and keeps orientation."""
    _, metric = np.linalg.qr(world_axes)
    metric = metric * np.sign(np.diagonal(metric))[:, None]
    if abs(metric[1, 1]) <= 1e-12 * np.abs(metric).max() or abs(metric[0, 0]) <= 1e-12 * np.abs(metric).max():
        raise ContourError("zero-area", "Its scale is zero in its own plane. Give it a scale.")
    return metric
