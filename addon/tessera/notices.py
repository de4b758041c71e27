"""What a mesh's report warns of."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from .crossings import close_pairs, gaps
from .sizing import LONG
from .spacing import Target

GAP = 0.02  # of the target edge length, from which two edges of a boundary that share no vertex are close
LOST_AREA = 0.1  # of a curve's area, from which a coarser boundary is warned of


def long_edge_warnings(
    start: np.ndarray, end: np.ndarray, target: Callable[[np.ndarray], np.ndarray]
) -> tuple[str, ...]:
    """A warning where kept edges, from start to end (e, 2), are longer than the target at places (n, 2), or none."""
    lengths = np.linalg.norm(end - start, axis=1)
    wanted = target(0.5 * (start + end))
    long = np.count_nonzero(lengths > LONG * wanted)
    if not long:
        return ()
    shortest = wanted[lengths > LONG * wanted].min()
    return (
        f"{long} of the {len(lengths)} kept boundary edges are longer than the target edge length {shortest:g} "
        f"(the longest is {lengths.max():g}), and so are the elements beside them: resample the boundary, or divide it",
    )


def lost_area_warnings(area: float, vertices: np.ndarray, triangles: np.ndarray, edge_length: float) -> tuple[str, ...]:
    """A warning where the resampled boundary is too coarse for a domain of that area, or none."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    u, v = b - a, c - a
    covered = 0.5 * float(np.sum(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    changed = abs(covered / area - 1)
    if changed < LOST_AREA:
        return ()
    return (
        f"the target edge length {edge_length:g} is too long for the curve's shape: the mesh's area differs by "
        f"{100 * changed:.0f} %. Use a shorter one",
    )


def gap_warnings(start: np.ndarray, end: np.ndarray, domain: np.ndarray, target: Target) -> dict[int, tuple[str, ...]]:
    """By domain, a warning where edges that share no vertex, or points, come very near to each other.

    start, end (e, 2), domain (e,): all edges, a point by itself is one to itself; target: points (n, 2) of domains (n,)
    -> (n,) wanted edge lengths. Near is what is a small share of that and of both edges.
    """
    if not len(start):
        return {}
    length = np.linalg.norm(end - start, axis=1)
    reach = GAP * np.minimum(np.where(length > 0, length, np.inf), target(0.5 * (start + end), domain))
    most = np.zeros(int(domain.max()) + 1)
    np.maximum.at(most, domain, reach)
    unit = most[domain, None]  # each domain in its own measure, so that none makes others slow
    found = [(np.zeros(0), np.zeros((0, 2)), domain[:0])]
    for pairs in close_pairs(start / unit, end / unit, domain, 1.0):
        (a, c), (b, d) = start[pairs.T], end[pairs.T]
        joined = np.logical_or.reduce([(p == q).all(axis=1) for p in (a, b) for q in (c, d)])
        pairs = pairs[~joined]
        gap, place = gaps(start, end, pairs)
        near = gap < reach[pairs].min(axis=1)
        found.append((gap[near], place[near], domain[pairs[near, 0]]))
    gap, place, of = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((gap, of))
    number, first = np.unique(of[order], return_index=True)
    return {
        int(n): (
            f"edges come as near to each other as {gap[k]:.2g} at ({place[k, 0]:.9g}, {place[k, 1]:.9g}), a small part "
            "of the target edge length, and elements between them are thin: move them apart, or join them",
        )
        for n, k in zip(number, order[first], strict=True)
    }


def repeated_warnings(loops: Sequence[ArrayLike], cleaned: list[np.ndarray]) -> tuple[str, ...]:
    """A warning where points of contours are given more than once, but for a last one that is the first again."""
    repeated = sum(
        len(loop) - len(clean) - int(len(loop) > len(clean) and np.array_equal(loop[0], loop[-1]))
        for loop, clean in zip(loops, cleaned, strict=True)
    )
    if not repeated:
        return ()
    return (f"{repeated} repeated point{'s' * (repeated > 1)} of contours {'are' if repeated > 1 else 'is'} left out",)
