"""What the library works on while it meshes: every contour that it gives to the networks, as arrays of examples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields

import numpy as np

from tessera import levels, refinement, relaxation, remeshing, triangulation
from tessera.cavity import next_vertices
from tessera.domains import mesh_domains
from tessera.settings import Request, Settings
from tessera.transform import superimpose

from . import contours
from .contours import LARGEST_CONTOUR
from .domains import Domain

KINDS = contours.KINDS[1:]
LARGEST_SUB_CONTOUR = 32  # edges, and as many inner vertices; none larger was seen
_CLEAR = 0.02  # least length of an edge and distance of a vertex from other edges, in mean edge lengths


@dataclass(frozen=True)
class Pool:
    """Transformed contours, padded with 0: they are simple, counter-clockwise and begin at their farthest vertex.

    contour: (n, 16, 2) float64; n_contour: (n,) int64; l_s: (n,) float64, the transformed target edge length, for a
    star the mean edge length; kind: (n,) int8, indices into KINDS.
    """

    contour: np.ndarray
    n_contour: np.ndarray
    l_s: np.ndarray
    kind: np.ndarray

    def __len__(self) -> int:
        return len(self.n_contour)


@dataclass(frozen=True)
class SubContours:
    """Transformed sub-contours, simple and counter-clockwise, with inner vertices, as `tables` and NN3 see them.

    points: (n, V, 2) float64, contour vertices and right after them inner vertices, padded with 0; n_contour, n_inner:
    (n,) int64, both at most 32.
    """

    points: np.ndarray
    n_contour: np.ndarray
    n_inner: np.ndarray

    def __len__(self) -> int:
        return len(self.n_contour)


@dataclass(frozen=True)
class Record:
    """What the library was seen to work on: batches of padded contours as they were, in the domains' coordinates."""

    contours: list[Pool] = field(default_factory=list)
    sub_contours: list[SubContours] = field(default_factory=list)


def record(domains: Sequence[Domain]) -> Record:
    """Mesh domains and keep what the library works on; those that it refuses leave nothing."""
    with recording() as found:
        for keep in (False, True):
            loops = _apart([domain.loop for domain in domains if domain.keep == keep])
            mesh_domains([Request(own, 1.0) for own in loops], Settings(boundary="keep" if keep else "resample"))
    return found


def _apart(loops: list[np.ndarray]) -> list[list[np.ndarray]]:
    """Domains of a loop each, far from each other: beside a long edge the mesh is coarser, whoever's edge it is."""
    width = np.array([np.ptp(loop, axis=0).max() for loop in loops])
    place = 8 * (np.cumsum(width) - width / 2)
    return [[loop - loop.mean(axis=0) + [x, 0]] for loop, x in zip(loops, place, strict=True)]


@contextmanager
def recording() -> Iterator[Record]:
    """While it lasts, the library calls through wrappers that keep what goes through; then all is as it was."""
    found = Record()
    wrappers = [
        (levels, "mesh_cells", lambda call: _recorded_cells(call, "cell", found)),
        (refinement, "mesh_cells", lambda call: _recorded_cells(call, "triangle", found)),
        (remeshing, "mesh_cells", lambda call: _recorded_cells(call, "cavity", found)),
        (relaxation, "_better_places", lambda call: _recorded_stars(call, found)),
        (triangulation, "_triangulate", lambda call: _recorded_levels(call, found)),
    ]
    originals = [getattr(module, name) for module, name, _ in wrappers]
    try:
        for (module, name, wrapper), original in zip(wrappers, originals, strict=True):
            setattr(module, name, wrapper(original))
        yield found
    finally:
        for (module, name, _), original in zip(wrappers, originals, strict=True):
            setattr(module, name, original)


def _recorded_cells(call: Callable, kind: str, found: Record) -> Callable:
    def mesh_cells(points, cells, edge_length, watch, more=(0,), **options):
        contour, n = _padded(points[cells]), (cells >= 0).sum(axis=1)
        found.contours.append(Pool(contour, n, edge_length, np.full(len(n), KINDS.index(kind), dtype=np.int8)))
        return call(points, cells, edge_length, watch, more, **options)

    return mesh_cells


def _recorded_stars(call: Callable, found: Record) -> Callable:
    def better_places(vertices, stars, size):
        ring = vertices[stars.ring.T]
        real = np.arange(ring.shape[1]) < stars.n_ring[:, None]
        lengths = np.linalg.norm(next_vertices(ring, stars.n_ring) - ring, axis=-1)
        mean = np.where(real, lengths, 0).sum(axis=1) / stars.n_ring
        kind = np.full(len(mean), KINDS.index("star"), dtype=np.int8)
        found.contours.append(Pool(_padded(ring), stars.n_ring, mean, kind))
        return call(vertices, stars, size)

    return better_places


def _recorded_levels(call: Callable, found: Record) -> Callable:
    def triangulate(points, n_contour, n_inner, number, connect):
        levels = []

        def recorded_connect(*level):
            levels.append(SubContours(*level[:3]))
            return connect(*level)

        result = call(points, n_contour, n_inner, number, recorded_connect)
        found.sub_contours.extend(levels[1:])  # level 0 is the contours themselves
        return result

    return triangulate


def contours_of(found: Record) -> Pool:
    """The contours of a record that are fit for examples, transformed, in the order in which they were meshed."""
    raw = join(found.contours)
    contour, scale = _transformed(raw.contour, raw.n_contour, raw.n_contour)
    return rows_of(Pool(contour, raw.n_contour, raw.l_s * scale, raw.kind), is_fit(contour, raw.n_contour))


def sub_contours_of(found: Record) -> SubContours:
    """The sub-contours of a record that are fit for examples, transformed."""
    parts = []
    for raw in found.sub_contours:
        raw = rows_of(raw, (raw.n_contour <= LARGEST_SUB_CONTOUR) & (raw.n_inner <= LARGEST_SUB_CONTOUR))
        points, _ = _transformed(raw.points, raw.n_contour, raw.n_contour + raw.n_inner)
        contour = points[:, : raw.n_contour.max(initial=3)]
        parts.append(rows_of(SubContours(points, raw.n_contour, raw.n_inner), is_fit(contour, raw.n_contour)))
    return join(parts)


def _transformed(points: np.ndarray, n_contour: np.ndarray, n_points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (B, V, 2) superimposed by their first n_contour, which are turned to begin at `first`; and the scales."""
    transformation = superimpose(points, n_contour)
    index = np.broadcast_to(np.arange(points.shape[1]), points.shape[:2])
    turned = (index + transformation.first[:, None]) % n_contour[:, None]
    turned = np.where(index < n_contour[:, None], turned, index)
    points = np.take_along_axis(transformation.apply(points), turned[..., None], axis=1)
    return np.where((index < n_points[:, None])[..., None], points, 0), transformation.scale


def is_fit(contour: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(B,) whether padded contours are simple, counter-clockwise and not hopelessly thin; straight angles are fine."""
    fit = np.zeros(len(n_contour), dtype=bool)
    for n in np.unique(n_contour):
        rows = np.flatnonzero(n_contour == n)
        for part in np.array_split(rows, 1 + len(rows) * int(n) ** 2 // (1 << 20)):
            fit[part] = _is_fit(contour[part, :n])
    return fit


def _is_fit(contour: np.ndarray) -> np.ndarray:
    """`is_fit` for contours (B, N, 2) without padding."""
    n = contour.shape[1]
    ahead = np.roll(contour, -1, axis=1)
    edge = ahead - contour
    length = np.linalg.norm(edge, axis=-1)
    mean = length.mean(axis=1)
    # Of the start of edge j from edge i, in units of edge i and across it.
    offset = contour[:, None] - contour[:, :, None]
    along = (offset * edge[:, :, None]).sum(-1) / (length**2)[..., None]
    side = edge[:, :, None, 0] * offset[..., 1] - edge[:, :, None, 1] * offset[..., 0]
    away = np.linalg.norm(offset - np.clip(along, 0, 1)[..., None] * edge[:, :, None], axis=-1)
    away[:, np.arange(n), np.arange(n)] = np.inf
    away[:, np.arange(n), (np.arange(n) + 1) % n] = np.inf
    # Straight angles have sides that are 0 but for rounding; what touches is too near.
    sign = np.sign(np.where(np.abs(side) < 1e-9, 0, side))
    passes = sign * np.roll(sign, -1, axis=2) < 0
    area = 0.5 * (contour[..., 0] * ahead[..., 1] - contour[..., 1] * ahead[..., 0]).sum(axis=1)
    return (
        (area > 0.02 * length.sum(axis=1) ** 2 / 12)
        & (np.minimum(length, away.min(axis=2)).min(axis=1) > _CLEAR * mean)
        & ~(passes & passes.transpose(0, 2, 1)).any(axis=(1, 2))
    )


def _padded(points: np.ndarray) -> np.ndarray:
    """(B, N, 2) as (B, 16, 2)."""
    return np.pad(points[:, :LARGEST_CONTOUR], ((0, 0), (0, max(0, LARGEST_CONTOUR - points.shape[1])), (0, 0)))


def rows_of(arrays: Pool | SubContours, rows: np.ndarray) -> Pool | SubContours:
    """The chosen rows of every array."""
    return type(arrays)(*(getattr(arrays, f.name)[rows] for f in fields(arrays)))


def join(parts: Sequence[Pool | SubContours]) -> Pool | SubContours:
    """One of several, padded to the widest."""
    columns = [[getattr(part, f.name) for part in parts] for f in fields(parts[0])]
    width = max(points.shape[1] for points in columns[0])
    columns[0] = [np.pad(points, ((0, 0), (0, width - points.shape[1]), (0, 0))) for points in columns[0]]
    return type(parts[0])(*map(np.concatenate, columns))
