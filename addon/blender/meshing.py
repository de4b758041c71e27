"""Object to mesh in steps, without a change to the scene: what operators, linked meshes and the command line share.

Importing this loads the mesher and onnxruntime; it is imported when there is something to mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from .. import tessera
from ..tessera import networks
from ..tessera.counting import expected_edge_length, mesh_to_count
from ..tessera.steps import Steps, finish, within
from .errors import OutlineError
from .failures import Failure, with_world_places
from .outline import Outline
from .preferences import execution
from .progress import named
from .reading import read_outlines
from .settings import EDGES_ALONG, NEAR_SHARE, Settings
from .targets import Targets, read_targets, sizing_of, unnamed
from .writing import Piece

__all__ = ["Failure", "Meshed", "Task", "finish", "mesh_all", "mesh_object", "read_task"]


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
        if settings.result == "REPLACE":
            _check_editable(obj)
        outlines = tuple(read_outlines(obj, depsgraph))
        targets = tuple(read_targets(obj, outline, settings, depsgraph) for outline in outlines)
    except tessera.ContourError as error:
        raise Failure(obj, error) from error
    return Task(obj, outlines, targets, settings)


def _check_editable(obj: bpy.types.Object) -> None:
    """Raise OutlineError if the mesh cannot take the object's place."""
    if not obj.is_editable:
        message = "It comes from a library and cannot be replaced. Make it local, or set Result to New Objects."
        raise OutlineError("library", message)


def mesh_task(task: Task) -> Steps[Meshed]:
    """Mesh what was read, the outlines one after the other. Raises Failure."""
    networks.use(networks.Execution(*execution()))
    edge_length = automatic_edge_length(task.outlines, task.settings)
    counts = _shared_count(task)
    pieces, reports, warnings = [], [], unnamed(task.settings)
    for number, (outline, targets) in enumerate(zip(task.outlines, task.targets, strict=True)):
        first, last = number / len(task.outlines), (number + 1) / len(task.outlines)
        outline = _with_vertices(outline, task.settings, edge_length, counts[number])
        try:
            steps = _mesh_outline(outline, targets, task.settings, edge_length, counts[number])
            made = yield from within(steps, first, last)
            _check_rounding(outline, made)
        except tessera.ContourError as error:
            raise Failure(task.obj, error, outline) from error
        pieces.append(Piece(outline, made.vertices, made.triangles, made.region))
        reports.append(made.report)
        warnings += [with_world_places(warning, task.obj, outline) for warning in made.report.warnings]
    return Meshed(task, edge_length, tuple(pieces), tuple(reports), tuple(dict.fromkeys(warnings)))


def mesh_object(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, settings: Settings) -> Steps[Meshed]:
    """Read and mesh one object. Raises Failure."""
    return (yield from mesh_task(read_task(obj, depsgraph, settings)))


@dataclass(frozen=True)
class Batch:
    """What became of several objects."""

    meshed: tuple[Meshed, ...]
    failures: tuple[Failure, ...]


def mesh_all(objects: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph, settings: list[Settings]) -> Steps[Batch]:
    """Read all objects, then mesh one after the other, each by its settings; one that fails stops no other."""
    tasks, meshed, failures = [], [], []
    for obj, its in zip(objects, settings, strict=True):
        try:
            tasks.append(read_task(obj, depsgraph, its))
        except Failure as failure:
            failures.append(failure)
    for number, task in enumerate(tasks):
        try:
            steps = named(mesh_task(task), task.obj.name)
            meshed.append((yield from within(steps, number / len(tasks), (number + 1) / len(tasks))))
        except Failure as failure:
            failures.append(failure)
    return Batch(tuple(meshed), tuple(failures))


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
            lengths.append(expected_edge_length(outline.loops, wanted))
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


def _mesh_outline(
    outline: Outline, targets: Targets, settings: Settings, edge_length: float, count: int
) -> Steps[tessera.Mesh]:
    """Mesh one outline, at the edge length or with so many triangles."""
    keep = settings.boundary == "KEEP" or outline.part is not None

    def mesh_at(length: float) -> Steps[tessera.Mesh]:
        return tessera.mesh_in_steps(
            outline.loops,
            length,
            sizing=sizing_of(settings, targets, length, NEAR_SHARE * length),
            min_edge_length=min(settings.min_edge_length, length) or None,
            gradation=settings.gradation,
            boundary="keep" if keep else "resample",
            corner_angle=settings.corner_angle,
            passes=settings.passes,
            flips=settings.flips,
            smooth=settings.smooth,
        )

    if settings.size_by == "TRIANGLE_COUNT":
        return mesh_to_count(outline.loops, count, mesh_at)
    return mesh_at(edge_length)


def _check_rounding(outline: Outline, made: tessera.Mesh) -> None:
    """Raise ContourError if elements that are no slivers lose their area in Blender's single precision."""
    vertices = outline.plane.lift(made.vertices).astype(np.float32).astype(np.float64)
    fat = tessera.element_quality(made.vertices, made.triangles) > 0.01
    if (tessera.element_quality(outline.plane.flatten(vertices), made.triangles[fat]) <= 0).any():
        message = (
            "Triangles so small are lost in the single precision of Blender's meshes, so far from the object's origin. "
            "Use a larger edge length, or Object > Set Origin > Origin to Geometry."
        )
        raise tessera.ContourError("edge-length", message)
