"""Control points to polylines, at the parameters where Blender evaluates them. Arrays in, arrays out: no `bpy` here.

Asking Blender for them would need an object in the file for every curve that is read, and what that costs grows with
the file; so its formulas stand here, and the tests compare with what Blender gives.
"""

import numpy as np


def bezier(
    points: np.ndarray, left: np.ndarray, right: np.ndarray, straight: np.ndarray, cyclic: bool, resolution: int
) -> np.ndarray:
    """Cubic Bézier segments: `resolution` points each, straight ones (a vector handle at either end) their first only.

    points, left, right: (n, 3) control points and their handles; straight: (n,) bool, of the segment from each control
    point to the next. Returns (k, 3).
    """
    following = np.roll(np.arange(len(points)), -1)
    segments = len(points) if cyclic else len(points) - 1
    t = np.arange(resolution)[:, None, None] / resolution
    s = 1.0 - t
    # (resolution, n, 3), the segments one behind the other
    curve = s**3 * points + 3 * s**2 * t * right + 3 * s * t**2 * left[following] + t**3 * points[following]
    wanted = (np.arange(resolution)[:, None] == 0) | ~straight
    wanted[:, segments:] = False
    along = curve.swapaxes(0, 1)[wanted.T]
    return along if cyclic else np.concatenate([along, points[-1:]])


def catmull_rom(points: np.ndarray, cyclic: bool, resolution: int) -> np.ndarray:
    """Uniform Catmull-Rom segments through points (n, 3), as Bézier: handles a sixth from neighbour to neighbour."""
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    if not cyclic:
        before[0], after[-1] = points[0], points[-1]
    handle = (after - before) / 6
    none = np.zeros(len(points), dtype=bool)
    return bezier(points, points - handle, points + handle, none, cyclic, resolution)


def nurbs(
    points: np.ndarray,
    weights: np.ndarray,
    order: int,
    cyclic: bool,
    endpoint: bool,
    bezier_knots: bool,
    resolution: int,
) -> np.ndarray:
    """A rational B-spline with Blender's knots, at `resolution` even parameters between each knot and the next.

    points: (n, 3); weights: (n,); endpoint, bezier_knots: the two bits of its knot mode. A spline with too few control
    points for its order gives these. Returns (k, 3). (Blender before 5.0 spaces the parameters over all knots instead.)
    """
    n, degree = len(points), order - 1
    if n < order or (bezier_knots and ((n <= order and not endpoint) or (cyclic and n % degree))):
        return points
    knots = _knots(n, order, cyclic, endpoint, bezier_knots)
    wrapped = np.arange(n + degree if cyclic else n)
    spans = np.unique(knots[degree : len(wrapped) + 1])
    parameters = spans[:-1, None] + np.diff(spans)[:, None] * np.arange(resolution) / resolution
    parameters = parameters.ravel() if cyclic else np.append(parameters, spans[-1])
    basis = _basis(knots, parameters, degree, len(wrapped)) * weights[wrapped % n]
    with np.errstate(divide="ignore", invalid="ignore"):  # weights may add up to nothing
        return basis @ points[wrapped % n] / basis.sum(axis=1)[:, None]


def _knots(n: int, order: int, cyclic: bool, endpoint: bool, bezier_knots: bool) -> np.ndarray:
    """n + order knots, and order - 1 more where cyclic; as many equal ones at the start and inside as the mode says."""
    inside = order - 1 if bezier_knots else 1
    head = order - cyclic if endpoint else min(2, inside) if bezier_knots else 1
    alone = [0] if endpoint and cyclic else []
    size = n + order if not cyclic else n + 2 * order - 1
    tail = 2 * order - 1 if cyclic else order if endpoint else 0
    step = np.arange(size - len(alone) - tail + 1)
    rising = len(alone) + np.where(step < head, 0, 1 + (step - head) // inside)
    knots = alone + rising.tolist()
    last = knots.pop()
    for i in range(tail):  # widths as at the start, which may reach into the tail itself
        knots.append(last + knots[i] - knots[0])
    return np.array(knots, dtype=np.float64)


def _basis(knots: np.ndarray, parameters: np.ndarray, degree: int, n: int) -> np.ndarray:
    """The n B-splines of a degree at each parameter, (k, n), by Cox and de Boor's recursion."""
    inside = (knots[:-1] <= parameters[:, None]) & (parameters[:, None] < knots[1:])
    at_end = parameters >= knots[n]
    inside[at_end] = np.arange(len(knots) - 1) == np.flatnonzero(knots[:n] < knots[n])[-1]
    basis = inside.astype(np.float64)
    for k in range(1, degree + 1):
        width = knots[k:] - knots[:-k]
        with np.errstate(divide="ignore", invalid="ignore"):
            rising = np.nan_to_num((parameters[:, None] - knots[:-k]) / width, posinf=0.0, neginf=0.0)
        basis = rising[:, :-1] * basis[:, :-1] + (1 - rising[:, 1:]) * basis[:, 1:] * (width[1:] > 0)
    return basis[:, :n]
