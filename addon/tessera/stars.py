"""Stars: the elements around each vertex of a mesh, and the ring of its neighbours as a contour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Stars:
    """Rings of S vertices: centre (S,) vertices, ring (R, S) neighbours counter-clockwise, padded, n_ring (S,).

    Stars are the last axis, as they are many.
    """

    centre: np.ndarray
    ring: np.ndarray
    n_ring: np.ndarray

    def rows(self, rows: np.ndarray) -> Stars:
        """The chosen stars."""
        return Stars(self.centre[rows], self.ring[:, rows], self.n_ring[rows])


def find_stars(triangles: np.ndarray, free: np.ndarray, largest: int) -> Stars:
    """The stars of the ``free`` (n,) vertices, which are off the boundary; those of over ``largest`` edges left out.

    triangles: (m, 3) counter-clockwise.
    """
    n = len(free)
    centre = triangles.astype(np.int64).ravel()
    after, before = np.roll(triangles, -1, axis=1).ravel(), np.roll(triangles, -2, axis=1).ravel()
    keep = free[centre]
    centre, after, before = centre[keep], after[keep], before[keep]
    order = np.argsort(centre * n + after)
    centre, after, before = centre[order], after[order], before[order]
    # Around a vertex, the element that starts at neighbour `before` follows.
    following = np.searchsorted(centre * n + after, centre * n + before)
    start = np.flatnonzero(np.diff(centre, prepend=-1))
    count = np.diff(start, append=len(centre))
    start, count = start[count <= largest], count[count <= largest]
    ring = np.zeros((int(count.max(initial=1)), len(start)), dtype=np.int64)
    corner = start
    for k in range(len(ring)):
        ring[k] = np.where(k < count, after[corner], ring[0])
        corner = following[corner]
    return Stars(centre[start], ring, count)


def find_independent_stars(triangles: np.ndarray, domain: np.ndarray, free: np.ndarray, largest: int) -> list[Stars]:
    """The stars of ``free`` (n,) vertices in sets without neighbours, for each domain as it is alone.

    triangles: (m, 3) counter-clockwise, all that are around the free vertices; domain: (m,) int, of each triangle;
    stars of over ``largest`` edges are left out.
    """
    stars = find_stars(triangles, free, largest)
    number = _numbers_by_domain(triangles, domain, len(free))
    return [stars.rows(rows) for rows in independent_sets(stars, number)]


def independent_sets(stars: Stars, number: np.ndarray) -> list[np.ndarray]:
    """Rows of stars in sets, no two centres of a set neighbours; every star is in one set.

    number (n,) int of each vertex, different for neighbours. A set takes the stars whose number, scrambled, is the
    largest among their neighbours left, then those left that have no neighbour in it, until nothing more fits.
    """
    # Neighbours in space are often neighbours in number, which would make long chains. An odd factor keeps them apart.
    rank = (number.astype(np.uint64) * np.uint64(11400714819323198485) >> np.uint64(1)).astype(np.int64)
    row_of = np.full(len(number), -1)
    row_of[stars.centre] = np.arange(len(stars.centre))
    neighbour = row_of[stars.ring]
    neighbour[np.arange(len(neighbour))[:, None] >= stars.n_ring] = -1
    own, left, sets = rank[stars.centre], np.arange(len(stars.centre)), []
    while len(left):
        chosen, going = [], left
        fits = np.zeros(len(own) + 1, dtype=bool)  # the last is what padding points to
        fits[left] = True
        while len(going):
            near = neighbour[:, going]
            new = going[own[going] > np.where(fits[near], own[near], -1).max(axis=0)]
            chosen.append(new)
            fits[new] = False
            fits[neighbour[:, new]] = False
            going = going[fits[going]]
        sets.append(np.sort(np.concatenate(chosen)))
        left = np.setdiff1d(left, sets[-1], assume_unique=True)
    return sets


def _numbers_by_domain(triangles: np.ndarray, domain: np.ndarray, n_vertices: int) -> np.ndarray:
    """(n,) place of each vertex among the vertices of its domain."""
    of = np.full(n_vertices, -1)
    of[triangles] = domain[:, None]
    order = np.argsort(of, kind="stable")
    first = np.searchsorted(of[order], of[order])
    number = np.empty(n_vertices, dtype=np.int64)
    number[order] = np.arange(n_vertices) - first
    return number


def total_in_turn(values: np.ndarray) -> np.ndarray:
    """Sums over the first axis, one after the other, so that padding rings with zeros changes no last bit."""
    total = values[0]
    for value in values[1:]:
        total = total + value
    return total
