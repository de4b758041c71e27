"""What a mesh remembers of its making: how good it is and, if it is kept linked, its source and its settings."""

from __future__ import annotations

import hashlib
import zlib
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from .kinds import shows_collection
from .properties import annotations, read_settings, write_settings

if TYPE_CHECKING:
    from .meshing import Meshed, Task
    from .settings import Settings
    from .writing import Piece

# Where the bars of the histogram of qualities begin and end.
BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 1.0)
_DRAFT = "draft "  # before the fingerprint of what a draft was made of


def _changed(group, _context) -> None:
    from . import following  # here, as that imports this

    following.want(group.id_data)


class TESSERA_PG_link_settings(bpy.types.PropertyGroup):
    """The settings of a linked mesh."""

    __annotations__ = annotations(pointers=True, update=_changed, without=("result",))


class TESSERA_PG_mesh(bpy.types.PropertyGroup):
    """At every object, and filled for those that Tessera has made: numbers of the last meshing, and the link."""

    source: bpy.props.PointerProperty(
        type=bpy.types.Object, name="Source", description="What this mesh is made of, while it is kept linked"
    )
    settings: bpy.props.PointerProperty(type=TESSERA_PG_link_settings)
    automatic: bpy.props.BoolProperty(
        name="Follow Changes",
        description="Mesh again at each change of the source. Switch it off for meshes that take long",
        update=_changed,
    )
    message: bpy.props.StringProperty(options={"HIDDEN"})
    n_triangles: bpy.props.IntProperty(name="Triangles")
    q_worst: bpy.props.FloatProperty(name="Worst Quality")
    q_mean: bpy.props.FloatProperty(name="Mean Quality")
    edge_lengths: bpy.props.FloatVectorProperty(name="Edge Lengths", size=3, unit="LENGTH")
    histogram: bpy.props.IntVectorProperty(name="Qualities", size=len(BINS) - 1)
    # Of the mesh that these numbers are of: `shape_of`.
    shape: bpy.props.StringProperty(options={"HIDDEN"})


def link(obj: bpy.types.Object, meshed: Meshed) -> None:
    """Note at a new mesh object what it was made of; an edge length that was chosen is noted as it came out."""
    note = obj.tessera
    note.source = meshed.task.obj
    write_settings(replace(meshed.task.settings, edge_length=meshed.edge_length), note.settings)
    mark_as_current(obj, meshed)


def unlink(obj: bpy.types.Object) -> None:
    """Make a linked mesh a plain one."""
    note = obj.tessera
    note.source = None
    note.automatic = False
    note.message = obj.data.tessera_made_of = ""


def mark_as_current(obj: bpy.types.Object, meshed: Meshed, draft: bool = False) -> None:
    """Note that a linked mesh is what is made of this now, or a draft of it."""
    obj.data.tessera_made_of = _DRAFT * draft + fingerprint(meshed.task, linked_settings(obj))


def made_of(obj: bpy.types.Object) -> str:
    """The `fingerprint` of what a linked mesh, or a draft of it, was made of last."""
    return obj.data.tessera_made_of.removeprefix(_DRAFT)


def is_draft(obj: bpy.types.Object) -> bool:
    """Whether an object is a draft of a linked mesh, to be meshed as its settings say."""
    return is_linked(obj) and obj.data.tessera_made_of.startswith(_DRAFT)


def remember_quality(obj: bpy.types.Object, made: list[Meshed]) -> None:
    """Note at a mesh object how good it is; made: what it was written of, more than one where they were joined."""
    note, reports = obj.tessera, [report for meshed in made for report in meshed.reports]
    counts = np.array([report.n_triangles for report in reports])
    lengths = np.array([report.edge_lengths for report in reports])
    note.n_triangles = counts.sum()
    note.q_worst = min(report.q_worst for report in reports)
    note.q_mean = np.average([report.q_mean for report in reports], weights=counts)
    # The mean of the edges is weighted by triangles, of which there are two for three edges.
    note.edge_lengths = lengths[:, 0].min(), np.average(lengths[:, 1], weights=counts), lengths[:, 2].max()
    quality = np.concatenate([piece_quality(piece) for meshed in made for piece in meshed.pieces])
    note.histogram = np.histogram(np.clip(quality, BINS[0], BINS[-1]), BINS)[0].tolist()
    note.message, note.shape = "", shape_of(obj.data)


def shape_of(mesh: bpy.types.Mesh) -> str:
    """A word that is the same as long as nobody edits the mesh; of its coordinates and of what its faces connect."""
    points, corners = np.empty(3 * len(mesh.vertices), dtype=np.float32), np.empty(len(mesh.loops), dtype=np.int32)
    mesh.vertices.foreach_get("co", points)
    mesh.loops.foreach_get("vertex_index", corners)
    return f"{len(mesh.polygons)} {zlib.crc32(corners, zlib.crc32(points))}"


def piece_quality(piece: Piece) -> np.ndarray:
    """(m,) the quality of each element."""
    from ..tessera.quality import element_quality

    return element_quality(piece.vertices, piece.triangles)


def fingerprint(task: Task, settings: Settings) -> str:
    """A word that is the same as long as what is read for a mesh, and its settings, are."""
    digest = hashlib.sha1(usedforsecurity=False)
    for outline, targets in zip(task.outlines, task.targets, strict=True):
        arrays = [*outline.loops, outline.plane.origin, outline.plane.axes, outline.plane.metric]
        arrays += [outline.materials, outline.smooth]
        for pair in (targets.weights, targets.near):
            arrays += pair or ()
        for array in arrays:
            digest.update(str(array.shape).encode())
            digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest() + repr(settings)


def linked_settings(obj: bpy.types.Object) -> Settings:
    """The settings of a linked mesh."""
    return read_settings(obj.tessera.settings)


def is_linked(obj: bpy.types.Object | None) -> bool:
    """Whether an object is a mesh that is kept linked to a source, and can be changed: not in another file."""
    if obj is None or obj.type != "MESH" or not obj.is_editable or not obj.data.is_editable:
        return False
    return obj.tessera.source is not None


def is_being_edited(obj: bpy.types.Object) -> bool:
    """Whether a mesh object is in another mode than Object Mode: new geometry would get in the way of that."""
    return obj.mode != "OBJECT" or obj.data.is_editmode


def problem(obj: bpy.types.Object) -> str:
    """Why a linked mesh cannot be meshed again, whatever the shape of its source; nothing where it can.

    A deleted object is in no scene: what refers to it keeps it in the file.
    """
    near = _sized_by(obj)
    if not obj.tessera.source.users_scene:
        return "Its source is in no scene. Link that into one, undo its deletion, or unlink the mesh."
    if near == obj:
        return "By Object is the mesh itself. Choose another object."
    if near is not None and not near.users_scene:
        return f"By Object is '{near.name}', which is in no scene. Choose another object, or undo its deletion."
    return ""


def read_from(obj: bpy.types.Object) -> Iterator[bpy.types.Object]:
    """What a linked mesh is made of: its source, all that this shows of collections, and the object that sizes it."""
    seen, waiting = {obj.tessera.source}, [obj.tessera.source]
    while waiting:
        part = waiting.pop()
        yield part
        if shows_collection(part):
            more = set(part.instance_collection.all_objects) - seen
            seen |= more
            waiting += more
    near = _sized_by(obj)
    if near is not None and near not in seen:
        yield near


def depends_on(obj: bpy.types.Object, other: bpy.types.Object) -> bool:
    """Whether an object is the other, or a linked mesh that is made of it, directly or by way of others."""
    seen, waiting = {obj}, [obj]
    while waiting:
        part = waiting.pop()
        if part == other:
            return True
        more = set(read_from(part)) - seen if is_linked(part) else set()
        seen |= more
        waiting += more
    return False


def _sized_by(obj: bpy.types.Object) -> bpy.types.Object | None:
    settings = obj.tessera.settings
    return settings.object_name if settings.use_object else None


def register() -> None:
    """Give every object its note, and every mesh what it was made of: as long as that is the same, nothing is to do."""
    bpy.utils.register_class(TESSERA_PG_link_settings)
    bpy.utils.register_class(TESSERA_PG_mesh)
    bpy.types.Object.tessera = bpy.props.PointerProperty(type=TESSERA_PG_mesh)
    # At the mesh, as undo may bring back an object and leave its mesh as it is.
    bpy.types.Mesh.tessera_made_of = bpy.props.StringProperty(options={"HIDDEN"})


def unregister() -> None:
    """Take it back."""
    del bpy.types.Mesh.tessera_made_of
    del bpy.types.Object.tessera
    bpy.utils.unregister_class(TESSERA_PG_mesh)
    bpy.utils.unregister_class(TESSERA_PG_link_settings)
