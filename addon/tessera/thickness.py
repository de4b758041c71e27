"""How thick a domain is: from places on its contours straight across to the opposite side."""

from __future__ import annotations

import numpy as np

from .nearby import along_curve
from .sampling import cut

# Two sides that meet at more than this angle are a corner, not a thin part.
FACING = np.radians(45.0)
_LEAF = 4
_BLOCK = 1 << 14
_MOST_ROUNDS = 30
# How far rays are followed at first, and then on: shares of their reach.
_SHARES = (1 / 64, 1 / 16, 1 / 4, 1.0)


def thin_parts(
    start: np.ndarray, end: np.ndarray, elements: float, longest: float, shortest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Lines across the thin parts of a domain: (k, 2) from where, (k, 2) to where.

    start, end: (n, 2) the boundary's edges, the domain to the left of each. The lines are perpendicular to the edges
    that they start at, shorter than ``elements · longest``, and no farther apart than half of what they allow for an
    edge length, which is their length over ``elements``, but at least ``shortest``.
    """
    tree = _tree(start, end)
    pieces = cut(start, end, np.ceil(4 * np.linalg.norm(end - start, axis=1) / longest))
    froms, tos = [], []
    for _ in range(_MOST_ROUNDS):
        a, b = pieces
        if len(a) == 0:
            break
        step = np.linalg.norm(b - a, axis=1)
        inward = np.column_stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]]) / step[:, None]
        origin = 0.5 * (a + b)
        across = first_exits(origin, inward, np.full(len(a), elements * longest), start, end, tree)
        length = np.maximum(across / elements, shortest)
        thin = np.isfinite(across) & (length < longest)
        done = thin & (step <= 0.5 * length)
        froms.append(origin[done])
        tos.append(origin[done] + across[done, None] * inward[done])
        pieces = cut(a[thin & ~done], b[thin & ~done], np.full(np.count_nonzero(thin & ~done), 2))
    return np.concatenate([np.zeros((0, 2)), *froms]), np.concatenate([np.zeros((0, 2)), *tos])


def first_exits(origin, direction, reach, start, end, tree) -> np.ndarray:
    """(n,) how far rays go until they leave the domain; infinite beyond `reach` or if not through a facing side.

    origin, direction: (n, 2), of length 1; start, end, tree: the boundary's edges and the tree over them. Rays are
    followed a little way at first, and on if they are still inside: what is far behind the side is not looked at.
    """
    across, open_ = np.full(len(origin), np.inf), np.arange(len(origin))
    for share in _SHARES:
        parts = np.array_split(open_, 1 + len(open_) // _BLOCK)
        left = []
        for part in parts:
            across[part], out = _first_exits(origin[part], direction[part], reach[part], share, start, end, tree)
            left.append(part[~out])
        open_ = np.concatenate(left)
    return across


def _first_exits(origin, direction, reach, share: float, start, end, tree) -> tuple[np.ndarray, np.ndarray]:
    """`first_exits` for one block of rays over a share of their reach, and which of them leave the domain there (n,).

    All rays go down the tree together, a level at a time.
    """
    margin, reach = 1e-9 * reach, share * reach
    ray, node = np.arange(len(origin)), np.zeros(len(origin), dtype=np.int64)
    order, levels = tree
    for level, (low, high) in enumerate(levels):
        if level:
            ray, node = np.repeat(ray, 2), np.repeat(2 * node, 2)
            node[1::2] += 1
        enter, leave = np.full(len(ray), -np.inf), np.full(len(ray), np.inf)
        for axis in (0, 1):
            x, d = origin[:, axis][ray], direction[:, axis][ray]
            with np.errstate(divide="ignore", invalid="ignore"):
                one, other = (low[:, axis][node] - x) / d, (high[:, axis][node] - x) / d
            # Not a number where a ray runs along a side of the box: then that coordinate says nothing.
            enter = np.fmax(enter, np.minimum(one, other))
            leave = np.fmin(leave, np.maximum(one, other))
        met = (leave >= 0) & (enter <= leave + margin[ray]) & (enter <= reach[ray])
        ray, node = ray[met], node[met]
    edge = order[(node[:, None] * _LEAF + np.arange(_LEAF)).ravel()]
    ray = np.repeat(ray, _LEAF)
    d, along, offset = direction[ray], end[edge] - start[edge], start[edge] - origin[ray]
    facing = d[:, 0] * along[:, 1] - d[:, 1] * along[:, 0]  # positive where the ray leaves through this edge
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / facing
        at = (offset[:, 0] * d[:, 1] - offset[:, 1] * d[:, 0]) / facing
    hit = (facing > 0) & (far > 0) & (far <= reach[ray]) & (at >= -1e-9) & (at <= 1 + 1e-9)
    ray, far = ray[hit], far[hit]
    straight = facing[hit] / np.linalg.norm(along[hit], axis=1) >= np.cos(FACING)
    order = np.lexsort((~straight, far, ray))
    first = order[np.flatnonzero(np.diff(ray[order], prepend=-1))]
    found, out = np.full(len(origin), np.inf), np.zeros(len(origin), dtype=bool)
    out[ray] = True
    found[ray[first]] = np.where(straight[first], far[first], np.inf)
    return found, out


def _tree(start: np.ndarray, end: np.ndarray) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
    """A tree over edges: their numbers (n,), near ones beside each other, and the boxes of each level's nodes."""
    depth = max(0, int(np.ceil(np.log2(len(start) / _LEAF))))
    order = along_curve(0.5 * (start + end), np.zeros(len(start), dtype=np.int64))
    order = order[np.minimum(np.arange(_LEAF << depth), len(start) - 1)]
    low, high = np.minimum(start, end)[order], np.maximum(start, end)[order]
    nodes = [1 << level for level in range(depth + 1)]
    return order, [(low.reshape(n, -1, 2).min(axis=1), high.reshape(n, -1, 2).max(axis=1)) for n in nodes]
