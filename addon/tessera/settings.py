"""What a caller of `mesh` may set, checked: for each domain of a batch, and for all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import radians

from numpy.typing import ArrayLike

from .constraints import Domain
from .sizing import FromLoops, Limits, Sizing, checked_limits, positive
from .smoothing import checked_steps


@dataclass(frozen=True)
class Settings:
    """The keyword arguments of `mesh` that hold for a whole batch."""

    gradation: float = 1.3
    boundary: str = "resample"
    corner_angle: float = 32.0
    passes: int = 3
    flips: bool = False
    smooth: int = 0

    def check(self) -> None:
        """Raise ValueError for what is out of range."""
        if self.boundary not in ("resample", "keep"):
            raise ValueError(f'boundary is "resample" or "keep", not {self.boundary!r}')
        checked_steps(self.passes, "passes")
        checked_steps(self.smooth, "smooth")
        if not 1 < self.gradation < float("inf"):
            message = "gradation is the ratio of edge lengths beside each other, more than 1, not "
            raise ValueError(f"{message}{self.gradation!r}")
        if not 0 < self.corner_angle < 180:
            raise ValueError(f"corner_angle is between 0 and 180 degrees, not {self.corner_angle!r}")


@dataclass(frozen=True)
class Request:
    """One domain of a batch, and the edge lengths that are wanted in it, as `mesh` takes them."""

    domain: Sequence[ArrayLike] | Domain
    edge_length: float
    sizing: Sizing | None = None
    min_edge_length: float | None = None

    def checked(self, settings: Settings) -> tuple[Sizing | None, Limits]:
        """The sizing, if the target is not the same everywhere, and its limits, by checked settings.

        Raises ContourError "edge-length" or "sizing" for what is no length.
        """
        angle = radians(settings.corner_angle)
        limits = checked_limits(self.edge_length, self.min_edge_length, settings.gradation, angle)
        if self.sizing is None or callable(self.sizing) or isinstance(self.sizing, FromLoops):
            return self.sizing, limits
        number = max(positive(self.sizing, "sizing"), limits.shortest or 0.0)
        return None, replace(limits, longest=min(limits.longest, number))
