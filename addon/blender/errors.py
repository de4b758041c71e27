"""What reading an object cannot turn into an outline."""

import numpy as np

from ..tessera.errors import ContourError


class OutlineError(ContourError):
    """A ContourError that is found before there is a plane: `place` is None, and it knows the place in 3-D instead.

    point: (3,) float64 in the object's space, or None; spline: its number as the user counts it, from 1, or 0 where the
    cause is not in one spline.
    """

    def __init__(self, reason: str, message: str, point: np.ndarray | None = None, spline: int = 0) -> None:
        super().__init__(reason, message)
        self.point = point
        self.spline = spline

    def __reduce__(self):
        return type(self), (self.reason, str(self), self.point, self.spline)
