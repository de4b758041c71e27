"""The plane of a curve: 3-D points of an object to 2-D points at true (world) proportion, and back. No `bpy` here."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .errors import OutlineError

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
        # Back substitution; a solver would start threads for it.
        second = points[:, 1] / self.metric[1, 1]
        first = (points[:, 0] - self.metric[0, 1] * second) / self.metric[0, 0]
        return self.origin + np.column_stack([first, second]) @ self.axes


def inverse(matrix: np.ndarray) -> np.ndarray:
    """The inverse of an object's world matrix (4, 4). Raises OutlineError "zero-area" where its scale is zero."""
    if np.linalg.det(matrix[:3, :3]) == 0.0:
        raise OutlineError("zero-area", "Its scale is zero along an axis. Give it a scale.")
    return np.linalg.inv(matrix)


def fit_plane(points: np.ndarray, to_world: np.ndarray, up: Sequence[float] = (0.0, 0.0, 1.0)) -> Plane:
    """The plane of a curve's points, seen from its upper side.

    points: (n, 3) float64 in the object's space; to_world: (3, 3), the linear part of the object's world matrix; up:
    the direction that the upper side faces. Raises OutlineError: "not-finite", "not-planar", "zero-area" (all points
    on a line or in one place, or a scale of zero).
    """
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise OutlineError("not-finite", f"A coordinate of point {bad + 1} is not a finite number. Correct it.")
    if not np.isfinite(to_world).all():
        raise OutlineError("not-finite", "Its transform has a number that is not finite. Correct it.")
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float(np.linalg.norm(high - low))
    if extent == 0.0:
        raise OutlineError("zero-area", "All points are in one place. Give the outline an area.", points[0])
    if high[2] - low[2] <= 1e-6 * extent and up[2] > 0.0:
        # The usual case keeps the object's own X and Y, and its coordinates to the last bit.
        origin, axes = np.array([0.0, 0.0, points[0, 2]]), np.eye(2, 3)
    else:
        origin = points.mean(axis=0)
        axes = _principal_axes(points, origin, extent, np.asarray(up, dtype=np.float64))
    return Plane(origin, axes, _metric(to_world @ axes.T))


def _principal_axes(points: np.ndarray, origin: np.ndarray, extent: float, up: np.ndarray) -> np.ndarray:
    centred = points - origin
    _, singular, rows = np.linalg.svd(centred, full_matrices=False)
    if len(singular) < 3 or singular[1] <= 1e-6 * singular[0]:
        raise OutlineError("zero-area", "All points lie on one line. Give the outline an area.", points[0])
    height = np.abs(centred @ rows[2])
    off, farthest = float(height.max()), points[height.argmax()]
    if off > TOLERANCE * extent:
        raise OutlineError(
            "not-planar",
            f"It is not planar: a point lies {off:.3g} off the best plane, and {TOLERANCE * extent:.3g} is allowed. "
            "Flatten it, for example by scaling its points to 0 along one axis in Edit Mode.",
            farthest,
        )
    normal = rows[2]
    # Towards `up`; a curve that stands upright faces -Y, then +X, as Blender's Front and Right views do.
    for toward in (up / np.linalg.norm(up), [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]):
        side = float(normal @ toward)
        if abs(side) > 1e-6:
            normal = normal * np.sign(side)
            break
    return np.stack(_across(normal))


def _across(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The object's X as it lies in the plane, or Y where X stands on it, and the direction to the left of that."""
    first = np.eye(3)[0 if abs(normal[0]) < 0.9 else 1]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def _metric(world_axes: np.ndarray) -> np.ndarray:
    """QR of the axes as the world sees them (3, 2): the triangular factor measures lengths, and keeps orientation."""
    _, metric = np.linalg.qr(world_axes)
    metric = metric * np.sign(np.diagonal(metric))[:, None]
    if abs(metric[1, 1]) <= 1e-12 * np.abs(metric).max() or abs(metric[0, 0]) <= 1e-12 * np.abs(metric).max():
        message = "Its scale is zero, or nothing beside the other, along an axis of its plane. Give it one."
        raise OutlineError("zero-area", message)
    return metric
