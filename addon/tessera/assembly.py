"""From meshed cells to one mesh: cells share the vertices along their common edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .cavity import next_vertices
from .roles import THOROUGH, Roles
from .scheme import contours_in_steps
from .stars import total_in_turn
from .steps import Steps
from .stopwatch import Stopwatch


def mesh_cells(
    points: np.ndarray,
    cells: np.ndarray,
    edge_length: np.ndarray,
    watch: Stopwatch,
    more: tuple[int, ...] = (0,),
    roles: Roles = THOROUGH,
) -> Steps[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Put every cell through the scheme.

    points: (p, 2); cells: (c, N) int, counter-clockwise vertex numbers, padded with -1, 3 to 16 each; edge_length:
    (c,); more, roles: as `contours_in_steps` takes them, the c meshes of which are several times as many then. Returns
    vertices (n, 2), the points first and then the inner vertices; triangles (m, 3) int64; the number of each triangle's
    mesh (m,); fallbacks of each mesh (c,).
    """
    n_contour = (cells >= 0).sum(axis=1)
    contours = points[np.maximum(cells, 0)]
    meshes = yield from contours_in_steps(contours, n_contour, edge_length, watch, more=more, roles=roles)
    n_contour, cells = np.repeat(n_contour, len(more)), np.repeat(cells, len(more), axis=0)
    row, k = np.nonzero(np.arange(meshes.inner.shape[1]) < meshes.n_inner[:, None])
    width = int((n_contour + meshes.n_inner).max(initial=3))
    number = np.zeros((len(cells), width), dtype=np.int64)
    size = min(width, cells.shape[1])
    number[:, :size] = cells[:, :size]
    number[row, n_contour[row] + k] = len(points) + np.arange(len(row))
    triangles = number[meshes.owner[:, None], meshes.triangles]
    return np.concatenate([points, meshes.inner[row, k]]), triangles, meshes.owner, meshes.fallbacks


def mean_edge_lengths(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """(c,) the average edge length of each cell's contour: the target that the paper meshes a sub-contour at."""
    count = (cells >= 0).sum(axis=1)
    contours = points[cells]
    lengths = np.linalg.norm(next_vertices(contours, count) - contours, axis=-1)
    return _total(lengths, cells) / count


def middles(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """(c, 2) the mean of each cell's vertices."""
    return _total(points[cells], cells) / (cells >= 0).sum(axis=1)[:, None]


def wanted_edge_lengths(
    points: np.ndarray, cells: np.ndarray, owner: np.ndarray, target: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    """(c,) `mean_edge_lengths`, times the target inside each cell over that along its contour.

    owner: (c,); target: points (n, 2) of owners (n,) -> (n,) wanted edge lengths. Inside, it is the length of as many
    equal elements as are wanted in all.
    """
    count = (cells >= 0).sum(axis=1)
    contours = points[cells]
    after = next_vertices(contours, count)
    centre = middles(points, cells)[:, None]
    u, v = contours - centre, after - centre
    area = np.maximum(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0], 0)
    of = np.repeat(owner, cells.shape[1])
    along = target((0.5 * (contours + after)).reshape(-1, 2), of).reshape(cells.shape)
    inside = target(((contours + after + centre) / 3).reshape(-1, 2), of).reshape(cells.shape)
    along = _total(along, cells) / count
    inside = np.sqrt(_total(area, cells) / _total(area / inside**2, cells))
    return mean_edge_lengths(points, cells) * inside / along


def _total(values: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """(c, ...) sums of values (c, N, ...) over the vertices of cells (c, N); padding changes no last bit."""
    real = (cells >= 0).reshape(*cells.shape, *[1] * (values.ndim - 2))
    return total_in_turn(np.moveaxis(np.where(real, values, 0), 1, 0))
