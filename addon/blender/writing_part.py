"""Flat parts of a mesh in Edit Mode, meshed again: the rest stays, and stays connected."""

from collections.abc import Sequence

import bmesh
import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .geometry import Piece
from .outline import Outline

_Faces = list[bmesh.types.BMFace]


def write_part(obj: bpy.types.Object, pieces: Sequence[Piece]) -> None:
    """Replace the faces of every piece's part by its triangles, which are selected then.

    The part's boundary vertices are the mesh's own, and where a boundary edge is divided, so is the face beyond it. A
    new face has the material and shading of the old one in its place, and its corners and vertices have the UVs,
    colours, weights and shape keys that there were.
    """
    bm = bmesh.from_edit_mesh(obj.data)
    bm.verts.ensure_lookup_table()
    bm.faces.ensure_lookup_table()
    old = [[bm.faces[i] for i in piece.outline.part.faces] for piece in pieces]
    corners = [[bm.verts[i] if i >= 0 else None for i in _flattened(piece.outline)] for piece in pieces]
    surfaces = [BVHTree.FromPolygons(*_polygons(faces)) if faces else None for faces in old]
    for face in bm.faces:
        face.select = False
    divided: dict[frozenset[bmesh.types.BMVert], list[bmesh.types.BMVert]] = {}
    made: _Faces = []
    for piece, faces, own, surface in zip(pieces, old, corners, surfaces, strict=True):
        _divide_edges(piece.outline, own, divided)
        made += _fill(bm, piece, own, faces, surface)
    kept = set(made)
    gone = [face for faces in old for face in faces if face not in kept]
    bmesh.ops.delete(bm, geom=gone, context="FACES")
    for face in made:
        face.select = True
    bm.select_flush_mode()
    bm.normal_update()
    bmesh.update_edit_mesh(obj.data)


def _flattened(outline: Outline) -> list[int]:
    return np.concatenate(outline.part.vertices).tolist()


def _polygons(faces: _Faces) -> tuple[list[Vector], list[tuple[int, ...]]]:
    """The faces as the tree takes them; their vertices need not be numbered together."""
    points, polygons = [], []
    for face in faces:
        polygons.append(tuple(range(len(points), len(points) + len(face.verts))))
        points += [vert.co.copy() for vert in face.verts]
    return points, polygons


def _divide_edges(outline: Outline, own: list, divided: dict) -> None:
    """Make the boundary's new vertices, those that are None in `own`, by splitting the mesh's edges; each edge once."""
    start = 0
    for loop in outline.loops:
        rows = range(start, start + len(loop))
        start += len(loop)
        given = [row for row in rows if own[row] is not None]
        for one, other in zip(given, given[1:] + [given[0] + len(loop)], strict=True):
            between = [rows[(row - rows[0]) % len(rows)] for row in range(one + 1, other)]
            if not between:
                continue
            first, last = own[one], own[rows[(other - rows[0]) % len(rows)]]
            key = frozenset((first, last))
            if key not in divided:
                divided[key] = _split(first, last, len(between))
            verts = divided[key]
            # Another part may have divided the edge in the other direction.
            forward = (verts[0].co - first.co).length <= (verts[0].co - last.co).length
            for row, vert in zip(between, verts if forward else verts[::-1], strict=True):
                own[row] = vert


def _split(first: bmesh.types.BMVert, last: bmesh.types.BMVert, count: int) -> list[bmesh.types.BMVert]:
    """`count` vertices evenly on the edge between two, in order."""
    edge = next(edge for edge in first.link_edges if edge.other_vert(first) is last)
    here, verts = first, []
    for left in range(count + 1, 1, -1):
        new_edge, vert = bmesh.utils.edge_split(edge, here, 1.0 / left)
        edge = next(e for e in (edge, new_edge) if last in e.verts)
        verts.append(vert)
        here = vert
    return verts


def _fill(bm: bmesh.types.BMesh, piece: Piece, own: list, old: _Faces, surface: BVHTree | None) -> _Faces:
    """The new faces of one part."""
    points = [Vector(point) for point in piece.outline.plane.lift(piece.vertices)]
    verts = _matched(piece, own)
    for row, vert in enumerate(verts):
        if vert is None:
            verts[row] = bm.verts.new(points[row])
            if surface is not None:
                verts[row].copy_from_face_interp(old[surface.find_nearest(points[row])[2]])
                verts[row].co = points[row]
    triangles = piece.triangles if old or not _faces_back(verts, piece.triangles) else piece.triangles[:, ::-1]
    return [_new_face(bm, [verts[i] for i in triangle], piece, old, surface) for triangle in triangles.tolist()]


def _matched(piece: Piece, own: list) -> list:
    """For each vertex of the piece, the mesh's vertex that it is, or None for a new one."""
    loops = np.concatenate(piece.outline.loops)
    row = {tuple(point): i for i, point in enumerate(loops.tolist())}
    return [own[row[point]] if (point := tuple(place)) in row else None for place in piece.vertices.tolist()]


def _faces_back(verts: list, triangles: np.ndarray) -> bool:
    """Whether most faces beside the new ones go along their common edge in the same direction, which is wrong."""
    score = 0
    for triangle in triangles.tolist():
        for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            beside = [edge for edge in verts[a].link_edges if edge.other_vert(verts[a]) is verts[b]]
            loops = [loop for edge in beside for loop in edge.link_loops]
            score += sum(1 if loop.vert is verts[a] else -1 for loop in loops)
    return score > 0


def _new_face(
    bm: bmesh.types.BMesh, verts: list, piece: Piece, old: _Faces, surface: BVHTree | None
) -> bmesh.types.BMFace:
    """A triangle, with what the old face in its place has; that itself, where it has the same corners."""
    there = bm.faces.get(verts)
    if there is not None:
        return there
    if surface is None:
        face = bm.faces.new(verts)
        face.material_index = int(piece.outline.materials[0])
        face.smooth = bool(piece.outline.smooth[0])
        return face
    centre = sum((vert.co for vert in verts), Vector()) / 3
    example = old[surface.find_nearest(centre)[2]]
    face = bm.faces.new(verts, example)
    for loop in face.loops:
        _copy_from_face(loop, example)
    return face


def _copy_from_face(loop: bmesh.types.BMLoop, example: bmesh.types.BMFace) -> None:
    """What a face's corners have, at the place of a corner, but nothing of its vertex."""
    try:
        loop.copy_from_face_interp(example, False)
    except TypeError:  # Blender 4.2 takes both as one argument
        loop.copy_from_face_interp((example, False))
