"""What a caller of `mesh` may set, checked."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .sizing import FromLoops, Limits, Sizing, checked_limits, positive
from .smoothing import checked_steps


@dataclass(frozen=True)
class Settings:
    """The keyword arguments of `mesh`."""

    sizing: Sizing | None = None
    min_edge_length: float | None = None
    gradation: float = 1.3
    boundary: str = "resample"
    corner_angle: float = 32.0
    passes: int = 3
    flips: bool = False
    smooth: int = 0

    def checked(self, edge_length: float) -> tuple[Sizing | None, Limits]:
        """The sizing, if the target is not the same everywhere, and its limits.

        Raises ContourError for what is no length, ValueError for other settings that are out of range.
        """
        if self.boundary not in ("resample", "keep"):
            raise ValueError(f'boundary is "resample" or "keep", not {self.boundary!r}')
        checked_steps(self.passes, "passes")
        checked_steps(self.smooth, "smooth")
        limits = checked_limits(edge_length, self.min_edge_length, self.gradation, self.corner_angle)
        if self.sizing is None or callable(self.sizing) or isinstance(self.sizing, FromLoops):
            return self.sizing, limits
        number = max(positive(self.sizing, "sizing"), limits.shortest or 0.0)
        return None, replace(limits, longest=min(limits.longest, number))
