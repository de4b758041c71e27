"""Meshed outlines to one mesh in the source's space, with what each triangle brings. No `bpy` is called here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..tessera.quality import element_quality
from .outline import Outline
from .welding import border_edges, same_place, weld

if TYPE_CHECKING:
    import bpy

# The gap between flat shapes that lie side by side in the UV map, as a fraction of the wider one's size.
_GAP = 0.02


@dataclass(frozen=True)
class Piece:
    """One meshed Outline.

    vertices: (n, 2) float64 in its plane; triangles: (m, 3) int32; region: (m,) int32, the index of the outer contour
    around each triangle among the outline's loops; None where there is but one.
    """

    outline: Outline
    vertices: np.ndarray
    triangles: np.ndarray
    region: np.ndarray | None = None


@dataclass(frozen=True)
class Geometry:
    """vertices: (n, 3) float64; triangles: (m, 3) int32, counter-clockwise from the side that they face; boundary: (b,)
    int64, the vertices on an edge of one triangle; uv: (m, 3, 2) at each corner, in world units; quality: (m,);
    materials: (m,) int32, in slots; smooth: (m,) bool."""

    vertices: np.ndarray
    triangles: np.ndarray
    boundary: np.ndarray
    uv: np.ndarray
    quality: np.ndarray
    materials: np.ndarray
    smooth: np.ndarray
    slots: tuple[bpy.types.Material | None, ...]


def join(pieces: Sequence[Piece], placing: Sequence[np.ndarray | None] | None = None) -> Geometry:
    """One mesh of pieces, the vertices on their boundaries made one where they are in the same place.

    placing: for each piece a matrix (4, 4) into the mesh's space, or None where it is there.
    """
    placing = placing or [None] * len(pieces)
    parts, triangles = zip(
        *(_placed(piece, matrix) for piece, matrix in zip(pieces, placing, strict=True)), strict=True
    )
    first = np.cumsum([0] + [len(part) for part in parts])
    vertices = np.concatenate(parts)
    triangles = np.concatenate([part + start for part, start in zip(triangles, first, strict=False)])
    flat = np.concatenate(_side_by_side(pieces, placing))
    uv = flat[triangles]
    if len(pieces) > 1:
        owner = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
        kept, triangles = weld(triangles, _welded(vertices, triangles, owner))
        vertices = vertices[kept]
    outer = [np.zeros(len(p.triangles), dtype=np.int64) if p.region is None else p.region for p in pieces]
    slots, number = _common_slots([piece.outline.slots for piece in pieces])
    materials = [
        of[np.minimum(p.outline.materials[o], len(of) - 1)] for p, o, of in zip(pieces, outer, number, strict=True)
    ]
    return Geometry(
        vertices,
        triangles.astype(np.int32),
        np.unique(border_edges(triangles)),
        uv,
        np.concatenate([element_quality(piece.vertices, piece.triangles) for piece in pieces]),
        np.concatenate(materials).astype(np.int32),
        np.concatenate([piece.outline.smooth[o] for piece, o in zip(pieces, outer, strict=True)]),
        slots,
    )


def _placed(piece: Piece, matrix: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) in the mesh's space, and triangles that face the side that they did in their own."""
    vertices, triangles = piece.outline.plane.lift(piece.vertices), piece.triangles
    if matrix is None:
        return vertices, triangles
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]
    return vertices @ matrix[:3, :3].T + matrix[:3, 3], triangles


def _welded(vertices: np.ndarray, triangles: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """For each vertex (n,), the first of those that become one; only boundary vertices do, and none of one piece.

    owner: (n,) the piece of each vertex.
    """
    sides = vertices[triangles] - vertices[np.roll(triangles, -1, axis=1)]
    shortest = float(np.sqrt((sides**2).sum(axis=-1).min()))
    tolerance = min(1e-6 * float(np.ptp(vertices, axis=0).max()), 0.05 * shortest)
    label = np.arange(len(vertices))
    boundary = np.unique(border_edges(triangles))
    place = boundary[same_place(vertices[boundary], tolerance)]
    # A chain of close vertices could join two of one piece: then it stays as it is.
    _, where, count = np.unique(
        np.column_stack([place, owner[boundary]]), axis=0, return_inverse=True, return_counts=True
    )
    crowded = np.isin(place, place[count[where.ravel()] > 1])
    label[boundary] = np.where(crowded, boundary, place)
    return label


def _side_by_side(pieces: Sequence[Piece], placing: Sequence[np.ndarray | None]) -> list[np.ndarray]:
    """The flat shapes (n, 2) in world units, from (0, 0) to the right and up: as large as they are in the world.

    So a print has one scale on all meshes, whenever they are made. Pieces of one plane keep their places; those of
    another plane are laid beside them.
    """
    groups: dict[tuple, list[int]] = {}
    for i, (piece, matrix) in enumerate(zip(pieces, placing, strict=True)):
        plane = piece.outline.plane
        where = (plane.origin, plane.axes, plane.metric, np.eye(4) if matrix is None else matrix)
        groups.setdefault(tuple(array.tobytes() for array in where), []).append(i)
    laid, right = [np.zeros((0, 2))] * len(pieces), 0.0
    for group in groups.values():
        points = np.concatenate([pieces[i].vertices for i in group])
        low, size = points.min(axis=0), np.ptp(points, axis=0)
        for i in group:
            laid[i] = pieces[i].vertices - low + (right, 0.0)
        right += float(size[0] + _GAP * size.max())
    return laid


def _common_slots(
    slots: Sequence[tuple[bpy.types.Material | None, ...]],
) -> tuple[tuple[bpy.types.Material | None, ...], list[np.ndarray]]:
    """The first's slots, then what others have more; for each, the numbers there of its own slots (one at least)."""
    common = list(slots[0])
    numbers = []
    for own in slots:
        if own == tuple(common[: len(own)]):
            number = list(range(len(own)))
        else:
            for material in own:
                if material not in common:
                    common.append(material)
            number = [common.index(material) for material in own]
        numbers.append(np.array(number or [0], dtype=np.int32))
    return tuple(common), numbers
