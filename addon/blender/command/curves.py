"""One curve: read, meshed into the journal, and put together again from there."""

from __future__ import annotations

import hashlib
import time
import traceback
from dataclasses import asdict, dataclass, replace

import bpy
import numpy as np

from ... import tessera
from .. import meshing
from ..results import write_results
from ..writing import Piece
from .arguments import Request
from .files import Job
from .journal import Entry, Journal, load
from .records import Record, failed

# What a file may well hold besides outlines, such as a camera's path: passed over, unless it was asked for by name.
_NOT_OUTLINES = frozenset({"open", "not-planar"})


@dataclass(frozen=True)
class Curve:
    """What is known of an object: what was read, or the record of what could not be; once meshed, all three.

    seconds: of reading.
    """

    task: meshing.Task | None = None
    record: Record | None = None
    entry: Entry | None = None
    seconds: float = 0.0

    @property
    def expected_triangles(self) -> float:
        """About how many triangles are still to be made."""
        return meshing.expected_triangles(self.task) if self.record is None else 0.0


def read_curve(job: Job, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, request: Request) -> Curve:
    """Read one object: a task, or the record of its failure."""
    name, start = obj.name, time.perf_counter()
    try:
        task = meshing.read_task(obj, depsgraph, request.settings)
    except meshing.Failure as failure:
        return Curve(record=_failure(job, name, failure, request.objects is not None))
    except Exception as error:
        return Curve(record=internal(job, name, error))
    return Curve(task, seconds=time.perf_counter() - start)


def known(job: Job, curve: Curve, journal: Journal, lost: bool = False) -> Curve:
    """The same with its record, if the journal has it.

    lost: whether another process has had it in hand; if the journal does not have it, that process ended over it.
    """
    if curve.record is not None:
        return curve
    entry = journal.entries.get(_key(curve.task))
    if entry is not None:
        return Curve(curve.task, replace(Record(**entry.record), earlier=entry.earlier), entry)
    if lost:
        message = "the process that had it in hand ended before it was meshed: try it by itself, with --objects"
        return Curve(record=failed(job.name, curve.task.obj.name, "process", message))
    return curve


def mesh_curves(job: Job, curves: list[Curve], journal: Journal) -> list[Curve]:
    """Mesh those that have no record yet, together, into the journal."""
    fresh = [curve for curve in curves if curve.record is None]
    meshed = iter(_mesh(job, fresh, journal) if fresh else ())
    return [next(meshed) if curve.record is None else curve for curve in curves]


def write(curves: list[Curve]) -> list[bpy.types.Object]:
    """Make the objects of curves that were meshed, as their settings say; one curve's arrays are loaded at a time."""
    if curves[0].task.settings.result == "JOIN":
        return write_results([_restored(curve) for curve in curves])
    return [obj for curve in curves for obj in write_results([_restored(curve)])]


def _restored(curve: Curve) -> meshing.Meshed:
    """What was meshed, with its arrays from the journal."""
    arrays, outlines = load(curve.entry), curve.task.outlines
    thirds = zip(outlines, arrays[0::3], arrays[1::3], arrays[2::3], strict=True)
    pieces = tuple(Piece(outline, v, t, region if len(region) else None) for outline, v, t, region in thirds)
    reports = tuple(tessera.Report(**report) for report in curve.record.outlines)
    return meshing.Meshed(curve.task, curve.record.edge_length, pieces, reports, curve.record.warnings)


def _mesh(job: Job, curves: list[Curve], journal: Journal) -> list[Curve]:
    """Mesh curves together, and add each to the journal: its record, and three arrays for each of its outlines."""
    start = time.perf_counter()
    try:
        outcomes = meshing.finish(meshing.mesh_tasks([curve.task for curve in curves]))
    except tessera.RuntimeProblem:
        raise  # nothing can be meshed
    except Exception as error:
        if len(curves) > 1:  # which of them it is
            return [one for curve in curves for one in _mesh(job, [curve], journal)]
        outcomes = [error]
    seconds = time.perf_counter() - start
    total = sum(outcome.n_triangles for outcome in outcomes if isinstance(outcome, meshing.Meshed))
    meshed = []
    for curve, outcome in zip(curves, outcomes, strict=True):
        name, arrays = curve.task.obj.name, []
        if isinstance(outcome, meshing.Meshed):
            share = seconds * outcome.n_triangles / total
            record, arrays = _success(job, name, outcome, curve.seconds + share), _arrays(outcome)
        elif isinstance(outcome, meshing.Failure):
            record = _failure(job, name, outcome, named=True)
        else:
            record = internal(job, name, outcome)
        meshed.append(Curve(curve.task, record, journal.add(_key(curve.task), asdict(record), arrays)))
    return meshed


def _arrays(meshed: meshing.Meshed) -> list[np.ndarray]:
    none = np.zeros(0, dtype=np.int32)
    regions = [none if piece.region is None else piece.region for piece in meshed.pieces]
    own = zip(meshed.pieces, regions, strict=True)
    return [array for piece, region in own for array in (piece.vertices, piece.triangles, region)]


def _success(job: Job, name: str, meshed: meshing.Meshed, seconds: float) -> Record:
    reports = meshed.reports
    shortest, mean, longest = zip(*(report.edge_lengths for report in reports), strict=True)
    weights = [report.n_triangles for report in reports]
    return Record(
        input=job.name,
        object=name,
        status="meshed",
        n_vertices=sum(report.n_vertices for report in reports),
        n_triangles=meshed.n_triangles,
        q_worst=meshed.q_worst,
        q_mean=meshed.q_mean,
        edge_length=meshed.edge_length,
        edge_lengths=(min(shortest), float(np.average(mean, weights=weights)), max(longest)),
        seconds=seconds,
        warnings=tuple(meshed.warnings),
        outlines=tuple(asdict(report) for report in reports),
    )


def _failure(job: Job, name: str, failure: meshing.Failure, named: bool) -> Record:
    """named: whether the object was asked for, or may be one of those that are no outlines."""
    over = failure.reason in _NOT_OUTLINES and not named
    return Record(
        input=job.name,
        object=name,
        status="passed over" if over else "failed",
        reason=failure.reason,
        error=str(failure),
        place=failure.place,
        spline=failure.spline or None,
    )


def internal(job: Job, name: str | None, error: Exception) -> Record:
    """An error of the add-on's own, with an object or (None) a whole file: shown in full, and the others go on."""
    traceback.print_exception(error)
    return failed(job.name, name, "internal", f"{type(error).__name__}: {error}")


def _key(task: meshing.Task) -> str:
    """The same for the same outlines, sizing and settings under the same name."""
    digest = hashlib.sha256(repr(task.settings).encode())
    for outline, targets in zip(task.outlines, task.targets, strict=True):
        plane, near, weights = outline.plane, targets.near or (), targets.weights or ()
        arrays = (*outline.loops, plane.origin, plane.axes, plane.metric, *near, *weights)
        for array in (*arrays, outline.splines, outline.materials, outline.smooth):
            digest.update(f"{array.shape} {array.dtype}".encode())
            digest.update(np.ascontiguousarray(array).tobytes())
    return f"{task.obj.name} {digest.hexdigest()}"
