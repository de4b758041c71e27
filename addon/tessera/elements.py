"""What NN3 is told of the entries of connection tables (section 2.5): lengths, angles and qualities, no coordinates.

They do not change when a contour is moved, turned or scaled, so it needs no transformation. Lengths are in units of the
even edge length. Contours and entries of a batch are put behind each other, without padding.

It is told of a third of all entries only, those of the bluntest apexes: the best one is hardly ever among the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cavity import even_lengths_of

# An entry is told of if the cotangent of its apex angle is larger than its facet's smallest by no more than this; the
# smallest is that of the constrained Delaunay triangulation.
_BLUNT = np.float32(1)
_FLAT = np.float32(5e-5)  # twice the area that an element is taken to have at the least
_THINNEST = 1e-12  # area of a contour beside its squared extent
_LOWEST, _HIGHEST = np.float32(-4), np.float32(5)  # what lengths and cotangents are cut to


@dataclass(frozen=True)
class Described:
    """T contour vertices, behind them one that stands for all inner vertices; and P entries."""

    vertices: np.ndarray  # (T + 1, 5) float32: both edges' lengths, the turn's sine and cosine, N_C / 16
    following: np.ndarray  # (T + 1,) int64, the next vertex of the contour
    facets: np.ndarray  # (P,) int64, the vertex that an entry's facet starts from
    apexes: np.ndarray  # (P,) int64
    # (8, P) float32: quality and its square, sides, cotangent at the apex, and both beside the best that are told of.
    elements: np.ndarray


def describe(
    points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, entries: np.ndarray
) -> tuple[np.ndarray, Described]:
    """Which of the entries NN3 is told of, (P,) of their numbers, and what.

    points: (B, V, 2) float64, each row n_contour vertices of a contour, n_inner inner ones, padding; entries: (n, 3)
    int64, sorted (contour, facet, vertex).
    """
    width, total = points.shape[1], int(n_contour.sum())
    # What goes to onnxruntime is int64, also where numpy's own integers are shorter.
    first = np.cumsum(n_contour, dtype=np.int64) - n_contour
    following = np.arange(1, total + 2, dtype=np.int64)
    following[first + n_contour - 1] = first
    following[total] = total
    # Where the contours' vertices are in the rows of points.
    place = np.repeat(width * np.arange(len(points)) - first, n_contour) + np.arange(total)
    # From the first vertex, so that single precision is enough far from the origin too.
    x, y = (points[..., axis] - points[:, :1, axis] for axis in (0, 1))
    unit = _even_lengths(x.take(place), y.take(place), following[:-1], first, n_contour, n_inner)
    x, y = ((of / unit[:, None]).astype(np.float32).ravel() for of in (x, y))
    vertices = _vertices(x[place], y[place], following[:-1], np.repeat(n_contour, n_contour))
    row, facet, vertex = entries.T
    facets, apex = first[row] + facet, row * width + vertex
    blunt, elements = _elements(x, y, place, following, facets, apex)
    number = np.full(len(x), total, dtype=np.int64)
    number[place] = np.arange(total)
    return blunt, Described(vertices, following, facets[blunt], number.take(apex[blunt]), elements)


def _even_lengths(
    x: np.ndarray, y: np.ndarray, following: np.ndarray, first: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray
) -> np.ndarray:
    """(B,) as `cavity.even_lengths`, of contours one behind the other (T,), each from its `first` on.

    An area that is nothing beside the contour's extent, or less by rounding, counts as a little of it.
    """
    area = 0.5 * np.add.reduceat(x * y[following] - y * x[following], first)
    least = _THINNEST * np.maximum.reduceat(x * x + y * y, first)
    return even_lengths_of(np.maximum(area, least), n_contour, n_inner)


def _vertices(x: np.ndarray, y: np.ndarray, following: np.ndarray, n_contour: np.ndarray) -> np.ndarray:
    """(T + 1, 5) of contour vertices at x, y (T,)."""
    before = np.empty_like(following)
    before[following] = np.arange(len(following))
    dx, dy = x[following] - x, y[following] - y
    ahead = np.sqrt(dx * dx + dy * dy)
    behind, back_x, back_y = ahead[before], dx[before], dy[before]
    scale = np.maximum(ahead * behind, np.float32(1e-6))
    found = np.zeros((len(x) + 1, 5), dtype=np.float32)
    found[:-1, 0], found[:-1, 1] = np.minimum(ahead, _HIGHEST), np.minimum(behind, _HIGHEST)
    found[:-1, 2], found[:-1, 3] = (back_x * dy - back_y * dx) / scale, (back_x * dx + back_y * dy) / scale
    found[:-1, 4] = n_contour / np.float32(16)
    return found


def _elements(
    x: np.ndarray, y: np.ndarray, place: np.ndarray, following: np.ndarray, facets: np.ndarray, apex: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The numbers (P,) of the blunt ones of n elements, and (8, P) of them.

    x, y: where the vertices are; place (T,), following: where the contours' are among them, and which comes after each;
    facets (n,): the contour vertices from which the elements' facets go; apex (n,) of all vertices.
    """
    if not len(apex):
        return np.zeros(0, dtype=np.int64), np.zeros((8, 0), dtype=np.float32)
    changes = np.append(True, facets[1:] != facets[:-1])
    begins, facet = np.flatnonzero(changes), np.cumsum(changes) - 1
    start, end = place[facets[begins]], place[following[facets[begins]]]
    start_x, start_y, along_x, along_y = x[start], y[start], x[end] - x[start], y[end] - y[start]
    ax, ay = x.take(apex) - start_x.take(facet), y.take(apex) - start_y.take(facet)
    bx, by = ax - along_x.take(facet), ay - along_y.take(facet)
    twice = ax * by - ay * bx
    cotangent = (ax * bx + ay * by) / np.maximum(twice, _FLAT)
    beyond = cotangent - np.minimum.reduceat(cotangent, begins).take(facet)
    blunt = np.flatnonzero(beyond <= _BLUNT)
    ax, ay, bx, by, twice, facet = (of.take(blunt) for of in (ax, ay, bx, by, twice, facet))
    left, right, base = ax * ax + ay * ay, bx * bx + by * by, (along_x * along_x + along_y * along_y).take(facet)
    quality = twice / (left + right + base + np.float32(1e-9))
    quality *= np.float32(2 * 3**0.5)
    found = np.empty((8, len(blunt)), dtype=np.float32)
    found[0] = quality
    np.multiply(quality, quality, out=found[1])
    for row, squared in enumerate((left, right, base), 2):
        np.sqrt(squared, out=found[row])
    found[5] = np.maximum(cotangent.take(blunt), _LOWEST)
    found[6] = beyond.take(blunt)
    np.minimum(found[2:7], _HIGHEST, out=found[2:7])
    size = np.bincount(facet)
    np.subtract(np.maximum.reduceat(quality, np.cumsum(size) - size).take(facet), quality, out=found[7])
    return blunt, found
