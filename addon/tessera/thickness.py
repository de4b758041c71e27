"""How thick a domain is: from places on its contours straight across to the opposite side."""

from __future__ import annotations

import numpy as np

from .sampling import cut

# Two sides that meet at more than this angle are a corner, not a thin part.
FACING = np.radians(45.0)
_LEAF = 4
_BLOCK = 1 << 14
_MOST_ROUNDS = 30


def thin_parts(
    start: np.ndarray, end: np.ndarray, elements: float, longest: float, shortest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Lines across the thin parts of a domain: (k, 2) from where, (k, 2) to where.

    start, end: (n, 2) the boundary's edges, the domain to the left of each. The lines are perpendicular to the edges
    that they start at, shorter than ``elements · longest``, and no farther apart than half of what they allow for an
    edge length, which is their length over ``elements``, but at least ``shortest``.
    """
    tree = _boxes(start, end)
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

    origin, direction: (n, 2), of length 1; start, end, tree: the boundary's edges and their boxes.
    """
    return np.concatenate(
        [np.zeros(0)]
        + [
            _first_exits(origin[part], direction[part], reach[part], start, end, tree)
            for part in (slice(first, first + _BLOCK) for first in range(0, len(origin), _BLOCK))
        ]
    )


def _first_exits(origin, direction, reach, start, end, tree) -> np.ndarray:
    """`first_exits` for one block: all rays go down the tree together, a level at a time."""
    ray, node = np.arange(len(origin)), np.zeros(len(origin), dtype=np.int64)
    for level, (low, high) in enumerate(tree):
        if level:
            ray, node = np.repeat(ray, 2), np.repeat(2 * node, 2)
            node[1::2] += 1
        with np.errstate(divide="ignore", invalid="ignore"):
            sides = np.stack([low[node] - origin[ray], high[node] - origin[ray]]) / direction[ray]
        # Not a number where a ray runs along a side of the box: that side says nothing.
        enter = np.fmax.reduce(np.fmin.reduce(sides, axis=0), axis=1)
        leave = np.fmin.reduce(np.fmax.reduce(sides, axis=0), axis=1)
        met = (leave >= 0) & (enter <= leave + 1e-9 * reach[ray]) & (enter <= reach[ray])
        ray, node = ray[met], node[met]
    edge = np.minimum((node[:, None] * _LEAF + np.arange(_LEAF)).ravel(), len(start) - 1)
    ray = np.repeat(ray, _LEAF)
    d, along, offset = direction[ray], end[edge] - start[edge], start[edge] - origin[ray]
    facing = d[:, 0] * along[:, 1] - d[:, 1] * along[:, 0]  # positive where the ray leaves through this edge
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / facing
        share = (offset[:, 0] * d[:, 1] - offset[:, 1] * d[:, 0]) / facing
    hit = (facing > 0) & (far > 0) & (far <= reach[ray]) & (share >= -1e-9) & (share <= 1 + 1e-9)
    ray, far = ray[hit], far[hit]
    straight = facing[hit] / np.linalg.norm(along[hit], axis=1) >= np.cos(FACING)
    order = np.lexsort((~straight, far, ray))
    first = order[np.flatnonzero(np.diff(ray[order], prepend=-1))]
    found = np.full(len(origin), np.inf)
    found[ray[first]] = np.where(straight[first], far[first], np.inf)
    return found


def _boxes(start: np.ndarray, end: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Boxes of the nodes of each level of a binary tree over edges, in the order that they have along the contours."""
    depth = max(0, int(np.ceil(np.log2(len(start) / _LEAF))))
    order = np.minimum(np.arange(_LEAF << depth), len(start) - 1)
    low, high = np.minimum(start, end)[order], np.maximum(start, end)[order]
    nodes = [1 << level for level in range(depth + 1)]
    return [(low.reshape(n, -1, 2).min(axis=1), high.reshape(n, -1, 2).max(axis=1)) for n in nodes]
