"""What became of each curve, and the report of a run. No `bpy` here."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path

from ..settings import Settings
from .files import OPEN_FILE
from .journal import write_atomically


@dataclass(frozen=True)
class Record:
    """What became of one curve, or, where `object` is None, of a whole input.

    status: "meshed", "failed", or "passed over" (an open path or the like that was not asked for by name); edge_length:
    the target, edge_lengths: shortest, mean and longest, both in world units; seconds: reading and meshing, of curves
    that are meshed together by their triangles; place: in the world; spline: from 1; outlines: the mesher's report of
    each, with the seconds of each stage; earlier: whether an earlier run has meshed it.
    """

    input: str
    object: str | None
    status: str
    output: str | None = None
    n_vertices: int = 0
    n_triangles: int = 0
    q_worst: float | None = None
    q_mean: float | None = None
    edge_length: float | None = None
    edge_lengths: tuple[float, float, float] | None = None
    seconds: float = 0.0
    warnings: tuple[str, ...] = ()
    reason: str | None = None
    error: str | None = None
    place: tuple[float, float, float] | None = None
    spline: int | None = None
    outlines: tuple[dict, ...] = ()
    earlier: bool = False

    @property
    def name(self) -> str:
        """For the user."""
        return self.input if self.object is None else name_of(self.input, self.object)

    @property
    def line(self) -> str:
        """For the user, one line."""
        name = self.name
        if self.status == "meshed":
            quality = f"q_worst {self.q_worst:.3f}, q_mean {self.q_mean:.3f}"
            time = "meshed earlier" if self.earlier else f"{self.seconds:.2f} s"
            return f"{name}: {self.n_triangles} triangles, {quality}, {time}"
        return f"{name}: {self.status} ({self.reason}): {self.error}"


def name_of(source: str, name: str) -> str:
    """A curve for the user: after its file (without folder), as curves of SVG files have the same names."""
    return name if source == OPEN_FILE else f"{Path(source).name}: {name}"


def failed(source: str, name: str | None, reason: str, error: str, **more) -> Record:
    """The record of a failure."""
    return Record(source, name, "failed", reason=reason, error=error, **more)


def exit_status(records: list[Record]) -> int:
    """0 where all were meshed, 1 where some failed or there was nothing."""
    statuses = {record.status for record in records}
    return 0 if "meshed" in statuses and "failed" not in statuses else 1


def summary(records: list[Record], seconds: float) -> str:
    """For the user, one line."""
    counts = Counter(record.status for record in records)
    said = ", ".join(f"{counts[status]} {status}" for status in ("meshed", "failed", "passed over") if counts[status])
    return f"{said or 'nothing was there'}, {seconds:.1f} s"


def write_report(
    path: Path, records: list[Record], settings: Settings, seconds: float, blender: str, stopped: str | None
) -> None:
    """All records as JSON; stopped: why the run has not done everything. Raises OSError where it cannot be written."""
    counts = Counter(record.status for record in records)
    report = {
        "blender": blender,
        "settings": asdict(settings),
        "seconds": seconds,
        "stopped": stopped,
        "counts": {status: counts[status] for status in ("meshed", "failed", "passed over")},
        "curves": [asdict(record) for record in records],
    }
    write_atomically(path, json.dumps(report, indent=1) + "\n")
