"""Examples in memory, and the batches that each role is trained on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from tessera.cavity import even_lengths, is_inside
from tessera.transform import superimpose

from . import configuration
from .compact import unpack
from .meshing import area2, delaunay, triangles
from .tables import connection_table

MOST_PEELED = 32  # edges of the sub-contours that recursion makes


@dataclass(frozen=True)
class Examples:
    """Padded float64 contours (n, N, 2) and inner vertices (n, M, 2), int64 counts (n,), l_s (n,), kinds (n,).

    placed: (n, M, 2) NN2's own placements of as many vertices, NaN where there is none, or None.
    """

    contour: np.ndarray
    inner: np.ndarray
    n_contour: np.ndarray
    n_inner: np.ndarray
    l_s: np.ndarray
    kind: np.ndarray
    placed: np.ndarray | None = None

    def __getitem__(self, rows: np.ndarray) -> Examples:
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return Examples(**{name: None if value is None else value[rows] for name, value in values.items()})

    def __len__(self) -> int:
        return len(self.l_s)


def load(split: str) -> Examples:
    """All examples of a split, with NN2's own placements where they have been made."""
    folder = configuration.ROOT / configuration.read()["data"]["folder"]
    arrays = unpack(folder / f"{split}.npz")
    examples = Examples(**{name: arrays[name] for name in ("contour", "inner", "n_contour", "n_inner", "l_s", "kind")})
    file = folder / f"{split}_placed.npy"
    return replace(examples, placed=np.load(file).astype(np.float64)) if file.exists() else examples


def reflect(examples: Examples, chosen: np.ndarray) -> Examples:
    """Mirror the chosen (n,) examples across the first vertex's axis; contours stay counter-clockwise."""
    index = np.arange(examples.contour.shape[1])
    count = examples.n_contour[:, None]
    order = np.where((index < count) & chosen[:, None], (count - index) % count, index)
    contour = np.take_along_axis(examples.contour, order[..., None], axis=1)
    sign = np.where(chosen, -1.0, 1.0)[:, None, None] * [0, 1] + [1, 0]
    placed = None if examples.placed is None else examples.placed * sign
    return replace(examples, contour=contour * sign, inner=examples.inner * sign, placed=placed)


def by_size(examples: Examples) -> list[np.ndarray]:
    """Rows of examples of like numbers of inner vertices, so that batches need little padding."""
    edges = np.searchsorted([3, 5, 8, 13], examples.n_inner, side="right")
    return [np.flatnonzero(edges == k) for k in range(5) if (edges == k).any()]


def trim(examples: Examples) -> Examples:
    """The same examples with no more padding than their largest needs."""
    n, m = int(examples.n_contour.max()), max(1, int(examples.n_inner.max()))
    placed = None if examples.placed is None else examples.placed[:, :m]
    return replace(examples, contour=examples.contour[:, :n], inner=examples.inner[:, :m], placed=placed)


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
    """Inner vertices to be moved, (n, M, 2): the teacher's, disturbed, or NN2's own; and which examples fit, (n,)."""
    even = even_lengths(examples.contour, examples.n_contour, examples.n_inner)
    sigma = rng.uniform(0.02, 0.4, len(examples))
    noise = rng.normal(size=examples.inner.shape) * (sigma * even)[:, None, None]
    start = examples.inner.copy()
    if examples.placed is not None:
        own = (rng.random(len(examples)) < 0.6) & np.isfinite(examples.placed).all((1, 2))
        start[own] = examples.placed[own]
        noise[own] *= 0.25
    fits = np.zeros(len(examples), bool)
    for row in range(len(examples)):
        nc, ni = examples.n_contour[row], examples.n_inner[row]
        points, fits[row] = jitter(examples.contour[row], start[row], nc, ni, noise[row], even[row])
        start[row, :ni] = points[nc:]
    return start, fits & (examples.n_inner > 0)


@njit(cache=True)
def peel(opposite, n_contour, n, draws):
    """Take elements off the contour, one a draw, and return the walk around what is left: a sub-contour of recursion.

    Only elements whose third vertex is an inner one, or that cut off one contour vertex, are taken.
    """
    walk = np.empty(2 * n, np.int64)
    for i in range(n_contour):
        walk[i] = i
    size = n_contour
    on_walk = np.zeros(n, np.bool_)
    on_walk[:n_contour] = True
    for draw in draws:
        i = int(draw * size)
        a, b = walk[i], walk[(i + 1) % size]
        c = opposite[a, b]
        if not on_walk[c]:
            if size >= MOST_PEELED:
                continue
            for k in range(size, i + 1, -1):
                walk[k] = walk[k - 1]
            walk[i + 1] = c
            size += 1
            on_walk[c] = True
        elif c == walk[(i + 2) % size] and size > 4:
            on_walk[b] = False
            at = (i + 1) % size
            for k in range(at, size - 1):
                walk[k] = walk[k + 1]
            size -= 1
    return walk[:size].copy()


def sub_contour(rng: np.random.Generator, points: np.ndarray, n_contour: int) -> tuple[np.ndarray, int]:
    """A random sub-contour of an example's recursion, transformed: points (n, 2), contour first, and its N_C."""
    n = len(points)
    opposite = np.empty((n, n), np.int64)
    if not delaunay(points, n_contour, n, opposite):
        return points, n_contour
    walk = peel(opposite, n_contour, n, rng.random(int(rng.integers(1, n_contour + 3))))
    rest = np.setdiff1d(np.arange(n_contour, n), walk)
    contour, inner = points[walk], points[rest]
    transformation = superimpose(contour[None], np.array([len(contour)]))
    contour = np.roll(transformation.apply(contour[None])[0], -int(transformation.first[0]), axis=0)
    inner = transformation.apply(inner[None])[0]
    return np.concatenate([contour, inner]), len(walk)


def table_batch(rng: np.random.Generator, examples: Examples) -> dict[str, np.ndarray]:
    """Contours, inner vertices and their calculated connection tables, sub-contours of the recursion among them.

    ``table`` is (n, N, N + M, 2) with the padded N and M of ``contour`` and ``inner``; 0 where no element is possible.
    """
    inner, fits = move_batch(rng, examples)
    made = []
    for row in range(len(examples)):
        nc, ni = int(examples.n_contour[row]), int(examples.n_inner[row])
        if ni and not fits[row]:
            continue
        points = np.concatenate([examples.contour[row, :nc], inner[row, :ni]])
        if ni and rng.random() < 0.45:
            points, nc = sub_contour(rng, points, nc)
        table = np.zeros((nc, len(points), 2))
        if connection_table(points, nc, len(points), table):
            made.append((points, nc, table))
    n, m = max(nc for _, nc, _ in made), max(1, max(len(points) - nc for points, nc, _ in made))
    batch = {
        "contour": np.zeros((len(made), n, 2)),
        "inner": np.zeros((len(made), m, 2)),
        "n_contour": np.array([nc for _, nc, _ in made]),
        "n_inner": np.array([len(points) - nc for points, nc, _ in made]),
        "table": np.zeros((len(made), n, n + m, 2)),
    }
    for row, (points, nc, table) in enumerate(made):
        ni = len(points) - nc
        batch["contour"][row, :nc], batch["inner"][row, :ni] = points[:nc], points[nc:]
        batch["table"][row, :nc, :nc] = table[:, :nc]
        batch["table"][row, :nc, n : n + ni] = table[:, nc:]
    return batch
