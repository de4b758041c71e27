"""Examples in memory, and the batches that each role is trained on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numba import njit

from tessera.cavity import even_lengths, is_inside
from tessera.elements import describe
from tessera.scheme import connect, join_vertices
from tessera.stopwatch import Stopwatch
from tessera.transform import superimpose
from tessera.triangulation import triangulate

from . import configuration
from .compact import unpack
from .meshing import area2, delaunay, triangles
from .provenance import fingerprint
from .tables import connection_table


@dataclass(frozen=True)
class Examples:
    """Padded float64 contours (n, N, 2) and inner vertices (n, M, 2), int64 counts (n,), l_s (n,), kinds (n,).

    placed: (n, P, 2) NN2's own placements of n_placed (n,) vertices, 0 of them where there is none.
    """

    contour: np.ndarray
    inner: np.ndarray
    n_contour: np.ndarray
    n_inner: np.ndarray
    l_s: np.ndarray
    kind: np.ndarray
    placed: np.ndarray
    n_placed: np.ndarray

    def __getitem__(self, rows: np.ndarray) -> Examples:
        return Examples(**{name: getattr(self, name)[rows] for name in self.__dataclass_fields__})

    def __len__(self) -> int:
        return len(self.l_s)


def placed_file(split: str) -> Path:
    """Where NN2's own placements of a split are."""
    return configuration.ROOT / configuration.read()["data"]["folder"] / f"{split}_placed.npz"


def load(split: str) -> Examples:
    """All examples of a split, with NN2's own placements where they have been made."""
    file = configuration.ROOT / configuration.read()["data"]["folder"] / f"{split}.npz"
    arrays = unpack(file)
    arrays = {name: arrays[name] for name in ("contour", "inner", "n_contour", "n_inner", "l_s", "kind")}
    count = len(arrays["l_s"])
    placed, n_placed = np.zeros((count, 1, 2)), np.zeros(count, dtype=np.int64)
    if placed_file(split).exists():
        with np.load(placed_file(split)) as made:
            if str(made["examples"]) != fingerprint(file):
                raise ValueError(f"{placed_file(split)} is of other examples: run 'python -m training.place'")
            placed, n_placed = made["placed"].astype(np.float64), made["n_placed"]
    return Examples(**arrays, placed=placed, n_placed=n_placed)


def reflect(examples: Examples, chosen: np.ndarray) -> Examples:
    """Mirror the chosen (n,) examples across the first vertex's axis; contours stay counter-clockwise."""
    index = np.arange(examples.contour.shape[1])
    count = examples.n_contour[:, None]
    order = np.where((index < count) & chosen[:, None], (count - index) % count, index)
    contour = np.take_along_axis(examples.contour, order[..., None], axis=1)
    sign = np.where(chosen, -1.0, 1.0)[:, None, None] * [0, 1] + [1, 0]
    return replace(examples, contour=contour * sign, inner=examples.inner * sign, placed=examples.placed * sign)


def by_size(examples: Examples) -> list[np.ndarray]:
    """Rows of examples of like numbers of inner vertices, so that batches need little padding."""
    edges = np.searchsorted([3, 5, 8, 13], examples.n_inner, side="right")
    return [np.flatnonzero(edges == k) for k in range(5) if (edges == k).any()]


def trim(examples: Examples) -> Examples:
    """The same examples with no more padding than their largest needs."""
    n, m, p = (max(1, int(count.max())) for count in (examples.n_contour, examples.n_inner, examples.n_placed))
    return replace(
        examples, contour=examples.contour[:, :n], inner=examples.inner[:, :m], placed=examples.placed[:, :p]
    )


def score_batch(
    rng: np.random.Generator, examples: Examples, spread: int = 32, near: int = 16
) -> tuple[np.ndarray, ...]:
    """Points (n, M, 2) over each cavity and near its inner vertices, their scores (n, M), and whether they count."""
    n = len(examples)
    even = even_lengths(examples.contour, examples.n_contour, examples.n_inner)
    low, high = examples.contour.min(1, keepdims=True), examples.contour.max(1, keepdims=True)
    everywhere = low + (high - low) * rng.random((n, spread, 2))
    chosen = (rng.random((n, near)) * examples.n_inner[:, None]).astype(int)
    centres = np.take_along_axis(examples.inner, chosen[..., None], axis=1)
    close = centres + rng.normal(0, 0.25, centres.shape) * even[:, None, None]
    points = np.concatenate([everywhere, close], axis=1)
    away = np.linalg.norm(points[:, :, None] - examples.inner[:, None], axis=-1)
    away[np.broadcast_to((np.arange(away.shape[2]) >= examples.n_inner[:, None])[:, None], away.shape)] = np.inf
    counts = is_inside(points, examples.contour, examples.n_contour) & (examples.n_inner > 0)[:, None]
    scores = np.where(counts, away.min(-1, initial=1e3) / even[:, None], 0)
    return points, scores, counts


@njit(cache=True)
def _segment_distance(points, v, a, b):
    ex, ey = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    px, py = points[v, 0] - points[a, 0], points[v, 1] - points[a, 1]
    t = min(1.0, max(0.0, (px * ex + py * ey) / max(ex * ex + ey * ey, 1e-300)))
    return np.hypot(px - t * ex, py - t * ey)


@njit(cache=True)
def is_clear(points, n_contour, n, v, gap):
    """Whether inner vertex v is inside the contour and ``gap`` away from it and from the vertices before v."""
    odd = False
    for a in range(n_contour):
        b = (a + 1) % n_contour
        if _segment_distance(points, v, a, b) < gap:
            return False
        if (points[a, 1] > points[v, 1]) != (points[b, 1] > points[v, 1]) and (area2(points, a, b, v) > 0) == (
            points[b, 1] > points[a, 1]
        ):
            odd = not odd
    if not odd:
        return False
    for u in range(n_contour, v):
        odd &= np.hypot(points[u, 0] - points[v, 0], points[u, 1] - points[v, 1]) >= gap
    return odd


@njit(cache=True)
def jitter(contour, inner, n_contour, n_inner, noise, even):
    """Move inner vertices by ``noise``, less where that would leave the cavity: points (N_C + N_I, 2) and success."""
    n = n_contour + n_inner
    points = np.empty((n, 2))
    points[:n_contour] = contour[:n_contour]
    for k in range(n_inner):
        v, fits = n_contour + k, False
        for weaker in range(5):
            points[v] = inner[k] + noise[k] * (0.5**weaker if weaker < 4 else 0.0)
            if is_clear(points, n_contour, n, v, 0.12 * even):
                fits = True
                break
        if not fits:
            return points, False
    return points, True


@njit(cache=True)
def elements_of(contour, inner, n_contour, n_inner, out, ok):
    """Constrained Delaunay elements of each example into ``out`` (n, T, 3), unused rows -1, success into ``ok``."""
    out[:] = -1
    most = contour.shape[1]
    for row in range(len(n_contour)):
        nc, ni = n_contour[row], n_inner[row]
        points = np.empty((nc + ni, 2))
        points[:nc] = contour[row, :nc]
        points[nc:] = inner[row, :ni]
        opposite = np.empty((nc + ni, nc + ni), np.int64)
        ok[row] = delaunay(points, nc, nc + ni, opposite)
        if ok[row]:
            found = triangles(opposite, nc + ni)
            for t in range(len(found)):
                for c in range(3):
                    out[row, t, c] = found[t, c] if found[t, c] < nc else found[t, c] - nc + most


def move_batch(rng: np.random.Generator, examples: Examples) -> tuple[np.ndarray, np.ndarray]:
    """Inner vertices to be moved, (n, M, 2), and how many, (n,): NN2's own placements, or the teacher's, disturbed.

    0 of them where they do not fit.
    """
    own = (rng.random(len(examples)) < 0.6) & (examples.n_placed > 0)
    n_inner = np.where(own, examples.n_placed, examples.n_inner)
    start = np.zeros((len(examples), max(1, int(n_inner.max())), 2))
    for chosen, places in ((own, examples.placed), (~own, examples.inner)):
        m = min(places.shape[1], start.shape[1])
        start[chosen, :m] = places[chosen, :m]
    even = even_lengths(examples.contour, examples.n_contour, n_inner)
    sigma = rng.uniform(0.02, 0.4, len(examples)) * np.where(own, 0.25, 1)
    noise = rng.normal(size=start.shape) * (sigma * even)[:, None, None]
    for row in range(len(examples)):
        nc, ni = examples.n_contour[row], n_inner[row]
        points, fits = jitter(examples.contour[row], start[row], nc, ni, noise[row], even[row])
        start[row, :ni] = points[nc:]
        n_inner[row] *= fits
    return start, n_inner


def levels(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray) -> Iterator[tuple[np.ndarray, int, int]]:
    """The contours of every level of the triangulation's recursion, by the shipped NN3, each alone and transformed.

    points: (B, V, 2), as `triangulate` takes them. Yields points (n, 2), the contour's first, N_C and the level, from
    0. Contours that need no table are in none.
    """
    asked = []

    def ask(*level: np.ndarray) -> np.ndarray:
        asked.append(level[:3])
        return connect(*level, Stopwatch())

    # Contours of up to 32 vertices and larger ones go through the levels separately.
    large = n_contour + n_inner > 32
    for rows in (np.flatnonzero(~large), np.flatnonzero(large)):
        asked.clear()
        triangulate(points[rows], n_contour[rows], n_inner[rows], ask)
        for level, (vertices, edges, inner) in enumerate(asked):
            transformed = superimpose(vertices[:, : edges.max()], edges).apply(vertices)
            for row, (nc, ni) in enumerate(zip(edges.tolist(), inner.tolist(), strict=True)):
                yield transformed[row, : nc + ni], nc, level


def table_batch(rng: np.random.Generator, examples: Examples) -> dict[str, np.ndarray]:
    """Contours, inner vertices and their calculated connection tables: of the recursion's levels from the first on.

    All contours of the first level, but for those that need no table, and as many of the others, drawn.
    ``table`` is (n, N, V, 2), 0 where NN3 is told of no element; beside it is what it is told of the others, in their
    order.
    """
    inner, n_inner = move_batch(rng, examples)
    fits = (n_inner > 0) | (examples.n_inner == 0)
    points = join_vertices(examples.contour[fits], examples.n_contour[fits], inner[fits], n_inner[fits])
    contours = list(levels(points, examples.n_contour[fits], n_inner[fits]))
    whole = [contour for contour in contours if contour[2] == 0]
    below = [contour for contour in contours if contour[2] > 0]
    made = []
    for vertices, nc, _ in whole + [below[number] for number in rng.permutation(len(below))[: len(whole)]]:
        table = np.zeros((nc, len(vertices), 2))
        if connection_table(np.ascontiguousarray(vertices), nc, len(vertices), table):
            made.append((vertices, nc, table))
    n_contour = np.array([nc for _, nc, _ in made])
    size = np.array([len(vertices) for vertices, _, _ in made])
    points, tables = np.zeros((len(made), size.max(), 2)), np.zeros((len(made), n_contour.max(), size.max(), 2))
    for row, (vertices, nc, table) in enumerate(made):
        points[row, : len(vertices)], tables[row, :nc, : len(vertices)] = vertices, table
    entries = np.argwhere((tables > 0).any(-1))
    told, described = describe(points, n_contour, size - n_contour, entries)
    table, place = np.zeros_like(tables), tuple(entries[told].T)
    table[place] = tables[place]
    return {"table": table, **vars(described)}
