"""The selected flat parts of a mesh in Edit Mode, and selected closed edge loops that no selected face fills."""

import math
from collections import defaultdict
from dataclasses import replace

import bmesh
import bpy
import numpy as np

from .chains import polylines
from .errors import OutlineError
from .outline import Outline, Part, Polyline, make_outline

# Faces that meet at less than this angle are of one flat part; whether the part is flat enough is tested as for curves.
_FLAT = math.radians(1.0)

_NO_SELECTION = "No face and no closed edge loop is selected. Select the flat part that is to be meshed again."


def read_parts(obj: bpy.types.Object) -> list[Outline]:
    """One outline for each flat part of the selection, its `part` set; edges that are seams, sharp or beside another
    material are kept, as borders between parts (one that ends inside a part is none, and goes).

    Raises OutlineError: "too-few-points" where nothing is selected, "open", "not-planar", "zero-area", "overlap" for a
    loop whose inside has faces.
    """
    bm = bmesh.from_edit_mesh(obj.data)
    to_world = np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
    bm.verts.index_update()
    bm.edges.index_update()
    bm.faces.index_update()
    slots = tuple(slot.material for slot in obj.material_slots)
    outlines = [_part_of_faces(faces, to_world, slots) for faces in _flat_parts(bm)]
    wires = [edge for edge in bm.edges if edge.select and not any(face.select for face in edge.link_faces)]
    if outlines:  # vertex mode selects also edges between the faces that are meant
        wires = _closed([edge for edge in wires if len(edge.link_faces) < 2])
    if wires:
        outlines.append(_part_of_edges(wires, to_world, slots))
        _check_free(wires, outlines[-1])
    if not outlines:
        raise OutlineError("too-few-points", _NO_SELECTION)
    return outlines


def _flat_parts(bm: bmesh.types.BMesh) -> list[list[bmesh.types.BMFace]]:
    """The selected faces, in groups that hang together across edges that need not be kept."""
    seen, parts = set(), []
    for seed in bm.faces:
        if not seed.select or seed in seen:
            continue
        part, front = [], [seed]
        seen.add(seed)
        while front:
            face = front.pop()
            part.append(face)
            for edge in face.edges:
                across = [other for other in edge.link_faces if other is not face]
                if len(across) == 1 and across[0] not in seen and across[0].select and _is_inside(edge):
                    seen.add(across[0])
                    front.append(across[0])
        parts.append(part)
    return parts


def _is_inside(edge: bmesh.types.BMEdge) -> bool:
    """Whether an edge between two selected faces may go."""
    one, other = edge.link_faces
    return (
        not edge.seam
        and edge.smooth
        and one.material_index == other.material_index
        and edge.calc_face_angle(4.0) < _FLAT
    )


def _part_of_faces(faces: list[bmesh.types.BMFace], to_world: np.ndarray, slots: tuple) -> Outline:
    inside = set(faces)
    edges = {edge for face in faces for edge in face.edges if sum(other in inside for other in edge.link_faces) == 1}
    normal = sum((np.array(face.normal) * face.calc_area() for face in faces), np.zeros(3))
    up = normal if np.linalg.norm(normal) > 0.0 else (0.0, 0.0, 1.0)
    traits = faces[0].material_index, all(face.smooth for face in faces)
    indices = np.array([face.index for face in faces], dtype=np.int32)
    return _outline(edges, indices, to_world, slots, up, traits)


def _part_of_edges(wires: list[bmesh.types.BMEdge], to_world: np.ndarray, slots: tuple) -> Outline:
    beside = next((edge.link_faces[0] for edge in wires if edge.link_faces), None)
    traits = (0, True) if beside is None else (beside.material_index, beside.smooth)
    return _outline(set(wires), np.zeros(0, dtype=np.int32), to_world, slots, (0.0, 0.0, 1.0), traits)


def _closed(edges: list[bmesh.types.BMEdge]) -> list[bmesh.types.BMEdge]:
    """The edges without those that lead to an open end."""
    at = defaultdict(set)
    for edge in edges:
        for vert in edge.verts:
            at[vert].add(edge)
    ends = [vert for vert, there in at.items() if len(there) == 1]
    while ends:
        vert = ends.pop()
        if len(at[vert]) == 1:
            edge = at[vert].pop()
            other = edge.other_vert(vert)
            at[other].remove(edge)
            ends.append(other)
    return [edge for edge in edges if edge in at[edge.verts[0]]]


def _check_free(wires: list[bmesh.types.BMEdge], outline: Outline) -> None:
    """No faces are where the loops would be filled: on both sides of an edge, in the plane of the outline."""
    normal = np.cross(*outline.plane.axes)
    for edge in wires:
        if len(edge.link_faces) > 1 and all(abs(np.dot(f.normal, normal)) > math.cos(_FLAT) for f in edge.link_faces):
            message = "A selected edge has faces on both sides. Select the faces themselves, to have them meshed again."
            raise OutlineError("overlap", message, np.array(edge.verts[0].co, dtype=np.float64))


def _outline(
    edges: set[bmesh.types.BMEdge],
    faces: np.ndarray,
    to_world: np.ndarray,
    slots: tuple,
    up: np.ndarray | tuple[float, ...],
    traits: tuple[int, bool],
) -> Outline:
    """The outline that edges bound; traits: the material and shading of what fills it."""
    ordered = sorted(edges, key=lambda edge: edge.index)
    number: dict[bmesh.types.BMVert, int] = defaultdict(lambda: len(number))
    pairs = np.array([[number[vert] for vert in edge.verts] for edge in ordered], dtype=np.int32).reshape(-1, 2)
    verts = list(number)
    points = np.array([vert.co for vert in verts], dtype=np.float64).reshape(-1, 3)
    index = np.array([vert.index for vert in verts], dtype=np.int32)
    chains = polylines(len(verts), pairs)
    made = [Polyline(points[chain], closed, 0, *traits) for chain, closed in chains]
    outline = make_outline(made, to_world, slots, up)
    vertices = tuple(index[chain[: len(loop)]] for (chain, _), loop in zip(chains, outline.loops, strict=True))
    return replace(outline, part=Part(faces, vertices))
