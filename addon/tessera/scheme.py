"""The meshing scheme (paper, section 2): transformation, NN1, NN2, NN3 and triangulation, for a batch of contours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .flips import flip_edges
from .placement import MOST_INNER
from .roles import SHIPPED, Roles
from .steps import Progress, Steps, finish
from .stopwatch import Stopwatch
from .transform import superimpose
from .triangulation import triangulate

LARGEST_CONTOUR = 16
# Contours that are on their way at a time: a few kB each, times what a stage holds beside them.
_PIECE = 1 << 14


@dataclass(frozen=True)
class ContourMeshes:
    """Meshes of B contours, in slots: a contour's own vertices first, its inner vertices from ``n_contour`` on."""

    inner: np.ndarray  # (B, M, 2) float64, in the contours' coordinates
    n_inner: np.ndarray  # (B,) int64
    wanted: np.ndarray  # (B,) int64, inner vertices that NN1 asked for
    triangles: np.ndarray  # (t, 3) int32
    owner: np.ndarray  # (t,) int32
    fallbacks: np.ndarray  # (B,) int32, elements that NN3's table had no say in, or where all were flat


def mesh_contours(
    contours: np.ndarray,
    n_contour: np.ndarray,
    edge_length: np.ndarray,
    watch: Stopwatch,
    flips: bool = False,
    roles: Roles = SHIPPED,
) -> ContourMeshes:
    """`contours_in_steps`, at once; flips: whether `flips.flip_edges` passes over the meshes in the end."""
    return finish(contours_in_steps(contours, n_contour, edge_length, watch, flips=flips, roles=roles))


def contours_in_steps(
    contours: np.ndarray,
    n_contour: np.ndarray,
    edge_length: np.ndarray,
    watch: Stopwatch,
    *,
    flips: bool = False,
    more: tuple[int, ...] = (0,),
    roles: Roles = SHIPPED,
) -> Steps[ContourMeshes]:
    """Mesh contours, each at its own target edge length.

    contours: (B, N, 2) float64, simple and counter-clockwise, n_contour (B,) vertices each, 3 to 16, then padding of
    any value; edge_length: (B,); more: each contour is meshed with so many inner vertices more, or less, than NN1 asks
    for, once for each of these numbers, one behind the other; roles: the networks that are asked. A large batch goes
    through in pieces, so that memory grows by no more than the meshes.
    """
    pieces, size = [], max(1, _PIECE // len(more))
    for first in range(0, max(1, len(contours)), size):
        rows = slice(first, first + size)
        part = contours[rows], n_contour[rows], edge_length[rows]
        pieces.append(_mesh_piece(*part, watch, flips, more, roles))
        yield Progress("networks", min(1.0, (first + size) / max(1, len(contours))))
    return pieces[0] if len(pieces) == 1 else _join(pieces)


def _mesh_piece(
    contours: np.ndarray,
    n_contour: np.ndarray,
    edge_length: np.ndarray,
    watch: Stopwatch,
    flips: bool,
    more: tuple[int, ...],
    roles: Roles,
) -> ContourMeshes:
    """`contours_in_steps` for all at a time."""
    # Padding of any value: the first vertex again.
    padding = np.arange(contours.shape[1]) >= n_contour[:, None]
    contours = np.where(padding[..., None], contours[:, :1], contours)
    with watch("transformation"):
        transformation = superimpose(contours, n_contour)
        transformed = transformation.apply(contours)
        l_s = edge_length * transformation.scale
    with watch("NN1"):
        wanted = roles.count(transformed, n_contour, l_s)
    if more != (0,):
        rows = np.repeat(np.arange(len(contours)), len(more))
        wanted = np.maximum(wanted[rows] + np.tile(more, len(contours)), 0)
        contours, n_contour, transformed, l_s = (of[rows] for of in (contours, n_contour, transformed, l_s))
        transformation = transformation.rows(rows)
    places, n_inner = roles.place(transformed, n_contour, np.minimum(wanted, MOST_INNER), l_s, watch)
    inner = transformation.invert(places)
    with watch("triangulation"):
        points = join_vertices(contours, n_contour, inner, n_inner)
        meshes = triangulate(points, n_contour, n_inner, lambda *rest: connect(*rest, watch, roles))
    triangles = meshes.triangles
    if flips:
        with watch("flips"):
            first = meshes.owner[:, None].astype(np.int64) * points.shape[1]
            triangles = (flip_edges(points.reshape(-1, 2), triangles + first) - first).astype(np.int32)
    return ContourMeshes(inner, n_inner, wanted, triangles, meshes.owner, meshes.fallbacks)


def _join(pieces: list[ContourMeshes]) -> ContourMeshes:
    """The meshes of several pieces of a batch, in their order."""
    width = max(piece.inner.shape[1] for piece in pieces)
    first = np.cumsum([0] + [len(piece.n_inner) for piece in pieces[:-1]])
    return ContourMeshes(
        np.concatenate([np.pad(p.inner, ((0, 0), (0, width - p.inner.shape[1]), (0, 0))) for p in pieces]),
        np.concatenate([piece.n_inner for piece in pieces]),
        np.concatenate([piece.wanted for piece in pieces]),
        np.concatenate([piece.triangles for piece in pieces]),
        np.concatenate([piece.owner + n for piece, n in zip(pieces, first.astype(np.int32), strict=True)]),
        np.concatenate([piece.fallbacks for piece in pieces]),
    )


def connect(
    points: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    entries: np.ndarray,
    watch: Stopwatch,
    roles: Roles = SHIPPED,
) -> np.ndarray:
    """NN3's values (P, 2) of the entries (P, 3) of (sub-)contours' connection tables.

    points: (B, V, 2), contour vertices, then inner vertices; entries: (contour, facet, vertex), sorted.
    """
    with watch("NN3"):
        return roles.rate(points, n_contour, n_inner, entries)


def join_vertices(contours: np.ndarray, n_contour: np.ndarray, inner: np.ndarray, n_inner: np.ndarray) -> np.ndarray:
    """Rows of a contour's vertices and, right after them, its inner vertices: (B, V, 2)."""
    width = int((n_contour + n_inner).max(initial=3))
    points = np.zeros((len(contours), width, 2))
    size = min(width, contours.shape[1])
    points[:, :size] = contours[:, :size]
    row, k = np.nonzero(np.arange(inner.shape[1]) < n_inner[:, None])
    points[row, n_contour[row] + k] = inner[row, k]
    return points
