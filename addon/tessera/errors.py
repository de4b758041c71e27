"""The one error that the library raises for input it cannot mesh."""


class ContourError(ValueError):
    """Input that cannot be meshed; the message says the cause, the place and the remedy.

    `reason` is a short machine-readable word: "not-finite", "out-of-range" (sizes whose squares overflow or vanish,
    or that are lost in the rounding of coordinates far from the origin),
    "too-few-points", "zero-area" (a contour that encloses nothing, or is lost in the tolerance within which contours
    are joined), "self-intersection", "crossing" (two loops cross, or run along each other; a line crosses something),
    "overlap" (of two regions), "outside" (a point or line that is not in the domain), "on-contour" (one that lies on
    its boundary), "open", "not-planar", "edge-length", "sizing" (a sizing that gives what is no length),
    "too-many-triangles", "too-many-edges", "untrained-group" (the paper's own networks are asked for a contour that
    none was trained for).
    `place` is where it is, in the input's coordinates, or None where the cause has no single place.
    """

    def __init__(self, reason: str, message: str, place: tuple[float, float] | None = None) -> None:
        super().__init__(message)
        self.reason = reason
        self.place = place

    def __reduce__(self):
        # ValueError alone would restore from the message only, so the error could not travel between processes.
        return type(self), (self.reason, str(self), self.place)
