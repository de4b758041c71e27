"""What NN3 is told of the entries of connection tables (section 2.5): lengths, angles and qualities, no coordinates.

They do not change when a contour is moved, turned or scaled, so it needs no transformation. Lengths are in units of the
even edge length. Contours and entries of a batch are put behind each other, without padding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cavity import even_lengths_of

_FLAT = np.float32(1e-4)  # four times the area that an element is taken to have at the least
_THINNEST = 1e-12  # area of a contour beside its squared extent
_LOWEST, _HIGHEST = np.float32(-4), np.float32(5)  # what lengths and cotangents are cut to


@dataclass(frozen=True)
class Described:
    """T contour vertices, behind them one that stands for all inner vertices; and P entries."""

    vertices: np.ndarray  # (T + 1, 5) float32: both edges' lengths, the turn's sine and cosine, N_C / 16
    following: np.ndarray  # (T + 1,) int64, the next vertex of the contour
    facets: np.ndarray  # (P,) int64, the vertex that an entry's facet starts from
    apexes: np.ndarray  # (P,) int64
    elements: np.ndarray  # (8, P) float32: quality and its square, sides, cotangent at the apex, both beside the best


def describe(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, entries: np.ndarray) -> Described:
    """Describe contours and entries.

    points: (B, V, 2) float64, each row n_contour vertices of a contour, n_inner inner ones, padding; entries: (P, 3)
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
    x, y = np.moveaxis(points - points[:, :1], 2, 0)
    unit = _even_lengths(x.take(place), y.take(place), following[:-1], first, n_contour, n_inner)
    x, y = ((of / unit[:, None]).astype(np.float32).ravel() for of in (x, y))
    vertices = _vertices(x[place], y[place], following[:-1], np.repeat(n_contour, n_contour))
    row, facet, vertex = entries.T
    facets = first[row] + facet
    begins = np.flatnonzero(np.diff(facets, prepend=-1))
    size = np.diff(begins, append=len(entries))
    start, apex = facets[begins], row * width + vertex
    elements = _elements(x, y, place[start], place[following[start]], apex, begins, size)
    number = np.full(len(x), total, dtype=np.int64)
    number[place] = np.arange(total)
    return Described(vertices, following, facets, number.take(apex), elements)


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
    x: np.ndarray,
    y: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    apex: np.ndarray,
    begins: np.ndarray,
    size: np.ndarray,
) -> np.ndarray:
    """(8, P) of elements on f facets, from vertices start to end (f,) of those at x, y, with apexes (P,).

    begins, size: (f,) where each facet's elements begin, and how many they are. The cotangent at the apex is the
    facet's smallest in the constrained Delaunay triangulation.
    """
    if not len(apex):
        return np.zeros((8, 0), dtype=np.float32)
    along_x, along_y = x[end] - x[start], y[end] - y[start]
    base = np.repeat(along_x * along_x + along_y * along_y, size)
    ax, ay = x.take(apex) - np.repeat(x[start], size), y.take(apex) - np.repeat(y[start], size)
    along_x, along_y = np.repeat(along_x, size), np.repeat(along_y, size)
    left, twice = ax * ax + ay * ay, along_x * ay - along_y * ax
    ax -= along_x
    ay -= along_y
    right = ax * ax + ay * ay
    around = left + right
    quality = twice / (around + base + np.float32(1e-9))
    quality *= np.float32(2 * 3**0.5)
    cotangent = (around - base) / np.maximum(twice + twice, _FLAT)
    least, best = np.minimum.reduceat(cotangent, begins), np.maximum.reduceat(quality, begins)
    found = np.empty((8, len(apex)), dtype=np.float32)
    found[0] = quality
    np.multiply(quality, quality, out=found[1])
    for place, squared in enumerate((left, right, base), 2):
        np.sqrt(squared, out=found[place])
    found[5] = np.maximum(cotangent, _LOWEST)
    np.subtract(cotangent, np.repeat(least, size), out=found[6])
    np.minimum(found[2:7], _HIGHEST, out=found[2:7])
    np.subtract(np.repeat(best, size), quality, out=found[7])
    return found
