"""Object to mesh in steps, without a change to the scene: what operators, linked meshes and the command line share.

Importing this loads the mesher and onnxruntime; it is imported when there is something to mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import bpy
import numpy as np

from .. import tessera
from ..tessera import networks
from ..tessera.counting import expected_edge_length
from ..tessera.steps import Steps, finish, within
from .errors import OutlineError
from .failures import Failure, with_world_places
from .outline import Outline
from .preferences import execution
from .progress import named
from .reading import read_outlines
from .settings import EDGES_ALONG, Settings, table
from .targets import Targets, read_targets, unnamed
from .wanted import Wanted, mesh_wanted
from .writing import Piece

__all__ = [
    "Failure",
    "Meshed",
    "Task",
    "expected_triangles",
    "finish",
    "handfuls",
    "mesh_all",
    "mesh_task",
    "mesh_tasks",
    "read_task",
]

T = TypeVar("T")
# Triangles that are meshed together: about a second's work, in which there is little left to gain by more of them.
_TOGETHER = 4000


@dataclass(frozen=True)
class Task:
    """Everything that meshing an object needs, read from the scene: outlines, and what their sizing is made of."""

    obj: bpy.types.Object
    outlines: tuple[Outline, ...]
    targets: tuple[Targets, ...]
    settings: Settings


@dataclass(frozen=True)
class Meshed:
    """edge_length: the target that the settings came to; pieces: what is written; reports: of each piece.

    warnings: of the settings, and of all pieces, each once, with places in the world.
    """

    task: Task
    edge_length: float
    pieces: tuple[Piece, ...]
    reports: tuple[tessera.Report, ...]
    warnings: tuple[str, ...]

    @property
    def n_triangles(self) -> int:
        """Of all pieces."""
        return sum(report.n_triangles for report in self.reports)

    @property
    def q_worst(self) -> float:
        """Of all pieces."""
        return min(report.q_worst for report in self.reports)

    @property
    def q_mean(self) -> float:
        """Of the triangles of all pieces."""
        return sum(report.q_mean * report.n_triangles for report in self.reports) / self.n_triangles


def read_task(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, settings: Settings) -> Task:
    """Read what is to be meshed. Raises Failure."""
    try:
        _check_numbers(settings)
        if settings.result == "REPLACE":
            _check_editable(obj)
        outlines = tuple(read_outlines(obj, depsgraph))
        targets = tuple(read_targets(obj, outline, settings, depsgraph) for outline in outlines)
    except tessera.ContourError as error:
        raise Failure(obj, error) from error
    return Task(obj, outlines, targets, settings)


def _check_numbers(settings: Settings) -> None:
    """Raise ContourError for what bounds do not keep a script from; the library itself says so of lengths."""
    for name in ("gradation", "corner_angle"):
        if np.isnan(getattr(settings, name)):
            how = table()[name]
            message = f"The {how.label} is nan; it must be a number between {how.low:g} and {how.high:g}. Give one."
            raise tessera.ContourError("sizing", message)


def _check_editable(obj: bpy.types.Object) -> None:
    """Raise OutlineError if the mesh cannot take the object's place."""
    if not obj.is_editable:
        message = "It comes from a library and cannot be replaced. Make it local, or set Result to New Objects."
        raise OutlineError("library", message)


def mesh_tasks(tasks: Sequence[Task]) -> Steps[list[Meshed | Failure]]:
    """Mesh what was read of several objects, all together; one that fails stops no other."""
    networks.use(networks.Execution(*execution()))
    asked = [_asked(task) for task in tasks]
    whole = [one for one in asked if not isinstance(one, Failure)]
    made = iter((yield from mesh_wanted([wanted for one in whole for wanted in one])))
    return [
        one if isinstance(one, Failure) else _outcome(task, one, [next(made) for _ in one])
        for task, one in zip(tasks, asked, strict=True)
    ]


def mesh_task(task: Task) -> Steps[Meshed]:
    """`mesh_tasks` for one. Raises Failure."""
    (outcome,) = yield from mesh_tasks([task])
    if isinstance(outcome, Failure):
        raise outcome
    return outcome


def _asked(task: Task) -> list[Wanted] | Failure:
    """What each outline of a task wants."""
    edge_length = automatic_edge_length(task.outlines, task.settings)
    try:
        counts = _shared_count(task)
    except Failure as failure:
        return failure
    asked = []
    for outline, targets, count in zip(task.outlines, task.targets, counts, strict=True):
        try:
            outline = _with_vertices(outline, task.settings, edge_length, count)
        except tessera.ContourError as error:
            return Failure(task.obj, error, outline)
        asked.append(Wanted(outline, targets, task.settings, edge_length, count))
    return asked


def _outcome(task: Task, asked: list[Wanted], made: list[tessera.Mesh | tessera.ContourError]) -> Meshed | Failure:
    """What a task comes to by the outcomes of its outlines."""
    warnings = unnamed(task.settings)
    for wanted, mesh in zip(asked, made, strict=True):
        error = mesh if isinstance(mesh, tessera.ContourError) else _lost_in_rounding(wanted.outline, mesh)
        if error is not None:
            return Failure(task.obj, error, wanted.outline)
        warnings += [with_world_places(warning, task.obj, wanted.outline) for warning in mesh.report.warnings]
    pieces = tuple(
        Piece(outline, mesh.vertices, mesh.triangles, outline.loops_of(mesh.region))
        for outline, mesh in zip((wanted.outline for wanted in asked), made, strict=True)
    )
    reports = tuple(mesh.report for mesh in made)
    return Meshed(task, asked[0].edge_length, pieces, reports, tuple(dict.fromkeys(warnings)))


def handfuls(items: Iterable[T], size: Callable[[T], float]) -> Iterator[list[T]]:
    """Items in their order, as many together as have about `_TOGETHER` triangles by their size."""
    some, total = [], 0.0
    for item in items:
        own = size(item)
        if some and total + own > _TOGETHER:
            yield some
            some, total = [], 0.0
        some.append(item)
        total += own
    if some:
        yield some


def expected_triangles(task: Task) -> float:
    """About how many triangles a task comes to, or some more; a sizing may ask for many more."""
    if task.settings.size_by == "TRIANGLE_COUNT":
        return task.settings.triangle_count
    area = sum(float(np.prod(np.ptp(np.concatenate(outline.loops), axis=0))) for outline in task.outlines)
    return 4 / 3**0.5 * area / automatic_edge_length(task.outlines, task.settings) ** 2


@dataclass(frozen=True)
class Batch:
    """What became of several objects, in their order."""

    outcomes: tuple[Meshed | Failure, ...]

    @property
    def meshed(self) -> tuple[Meshed, ...]:
        """Of those that could be meshed."""
        return tuple(outcome for outcome in self.outcomes if isinstance(outcome, Meshed))

    @property
    def failures(self) -> tuple[Failure, ...]:
        """Of the others."""
        return tuple(outcome for outcome in self.outcomes if isinstance(outcome, Failure))


def mesh_all(objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph, settings: list[Settings]) -> Steps[Batch]:
    """Read all objects, then mesh a handful at a time, each by its settings; one that fails stops no other."""
    tasks: list[tuple[int, Task]] = []
    outcomes: dict[int, Meshed | Failure] = {}
    for number, (obj, its) in enumerate(zip(objects, settings, strict=True)):
        try:
            tasks.append((number, read_task(obj, depsgraph, its)))
        except Failure as failure:
            outcomes[number] = failure
    done = 0
    for some in handfuls(tasks, lambda numbered: expected_triangles(numbered[1])):
        numbers, own = zip(*some, strict=True)
        name = own[0].obj.name if len(own) == 1 else f"{own[0].obj.name} and {len(own) - 1} more"
        steps = within(named(mesh_tasks(own), name), done / len(tasks), (done + len(own)) / len(tasks))
        outcomes |= zip(numbers, (yield from steps), strict=True)
        done += len(own)
    return Batch(tuple(outcomes[number] for number in range(len(objects))))


def automatic_edge_length(outlines: tuple[Outline, ...], settings: Settings) -> float:
    """The edge length of the settings; where it is 0, one by the object's size, to two digits, in world units."""
    if settings.edge_length:
        return settings.edge_length
    return float(f"{max(outline.size for outline in outlines) / EDGES_ALONG:.2g}")


def _shared_count(task: Task) -> list[int]:
    """How many of the wanted triangles each outline has, by its area; none matters where the size is a length."""
    wanted = task.settings.triangle_count
    if task.settings.size_by != "TRIANGLE_COUNT" or len(task.outlines) == 1:
        return [wanted] * len(task.outlines)
    lengths = []
    for outline in task.outlines:
        try:
            lengths.append(expected_edge_length(outline.domain, wanted))
        except tessera.ContourError as error:
            raise Failure(task.obj, error, outline) from error
    areas = np.square(lengths)  # nearly: so many triangles as long as that
    return np.maximum(1, np.rint(wanted * areas / areas.sum())).astype(int).tolist()


def _with_vertices(outline: Outline, settings: Settings, edge_length: float, count: int) -> Outline:
    """A part of a mesh with the vertices on its edges that "resample" asks for; what is no part stays as it is."""
    if outline.part is None or settings.boundary == "KEEP":
        return outline
    by_count = settings.size_by == "TRIANGLE_COUNT"
    return outline.subdivided(expected_edge_length(outline.loops, count) if by_count else edge_length)


def _lost_in_rounding(outline: Outline, made: tessera.Mesh) -> tessera.ContourError | None:
    """The error of elements that are no slivers and lose their area in Blender's single precision."""
    vertices = outline.plane.lift(made.vertices).astype(np.float32).astype(np.float64)
    fat = tessera.element_quality(made.vertices, made.triangles) > 0.01
    if (tessera.element_quality(outline.plane.flatten(vertices), made.triangles[fat]) > 0).all():
        return None
    message = (
        "Triangles so small are lost in the single precision of Blender's meshes, so far from the object's origin. "
        "Use a larger edge length, or Object > Set Origin > Origin to Geometry."
    )
    return tessera.ContourError("edge-length", message)
