"""Which region each face of a graph is part of, by the contours around it; what contours must not do to each other."""

from __future__ import annotations

import numpy as np

from .contour import meeting_error
from .errors import ContourError
from .graph import Faces
from .noding import Noded


def face_regions(noded: Noded, faces: Faces, n_loops: int, owner: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """The region of each face (f,), -1 outside; and the points (k,) where contours of one owner touch.

    The first curves of `noded` are closed contours; owner: (l,) which of several domains each of those bounds, or None
    for all the same. Inside a domain is what an odd number of its contours have around them. A region is a domain, or,
    without owners, the inside of an outer contour, by number. Raises ContourError "self-intersection", "crossing"
    (contours of one domain cross, or run along each other with the outside beside them) or "overlap" (of two domains).
    """
    by_contour = owner is None
    owner = np.zeros(n_loops, dtype=np.int64) if by_contour else owner
    traced = noded.curve < n_loops
    edge, loop, sign = noded.edge[traced], noded.curve[traced], noded.sign[traced]
    signed = windings(len(noded.edges), edge, loop, sign, faces, len(owner))
    # Which contours are around which faces: of thousands of contours, few are around the same one.
    face, around = np.nonzero(signed)
    _check_lost(noded, around, len(owner))
    touching, pairs = _touching(noded, edge, loop, owner)
    _check_turns(noded, edge, loop, signed)
    _check_crossings(noded, edge, loop, face, around, pairs)
    inside, count = np.unique(np.column_stack([face, owner[around]]), axis=0, return_counts=True)
    covered, domain = inside[count % 2 == 1].T
    _check_overlaps(noded, faces, covered, domain)
    _check_double_edges(noded, faces, edge, loop, owner, covered, domain)
    if not by_contour:
        region = np.full(faces.count, -1)
        region[covered] = domain
        return region, touching
    # The innermost contour around a face is the one around which there are most others; of a hole and what fills it,
    # the smaller one, or the later.
    depth = np.bincount(face, minlength=faces.count)
    level = np.full(len(owner), faces.count)
    np.minimum.at(level, around, depth[face])
    order = np.lexsort((-np.bincount(around, minlength=len(owner)), level))
    rank, highest = np.argsort(order), np.full(faces.count, -1)
    np.maximum.at(highest, face, rank[around])
    return np.where(depth % 2 == 1, order[highest], -1), touching


def windings(
    n_edges: int, edge: np.ndarray, loop: np.ndarray, sign: np.ndarray, faces: Faces, n_loops: int
) -> np.ndarray:
    """(f, l) int8, how often each loop runs around each face, counter-clockwise; from face to face across edges.

    edge, loop, sign: (t,) which edges each loop runs along, as of `Noded`.
    """
    wound = np.zeros((faces.count, n_loops), dtype=np.int8)
    known = np.zeros(faces.count, dtype=bool)
    known[-1] = True
    order = np.argsort(edge, kind="stable")
    edge, loop, sign = edge[order], loop[order], sign[order]
    first, last = (np.searchsorted(edge, np.arange(n_edges), side=side) for side in ("left", "right"))
    left, right = np.split(faces.of_half_edge, 2)
    while not known.all():
        across = np.flatnonzero(known[left] != known[right])
        source, goal = np.where(known[left], [left, right], [right, left])[:, across]
        goal, once = np.unique(goal, return_index=True)
        across, source = across[once], source[once]
        wound[goal] = wound[source]
        count = last[across] - first[across]
        row = np.repeat(np.arange(len(across)), count)
        item = first[across][row] + np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
        to_left = np.where(left[across] == goal, 1, -1)
        np.add.at(wound, (goal[row], loop[item]), (to_left[row] * sign[item]).astype(np.int8))
        known[goal] = True
    return wound


def _touching(noded: Noded, edge, loop, owner) -> tuple[np.ndarray, np.ndarray]:
    """Points (k,) that contours of one owner pass more than once, and the pairs of contours (c, 2) that do."""
    at = np.column_stack([noded.edges[edge].ravel(), np.repeat(loop, 2)])
    visit, count = np.unique(at, axis=0, return_counts=True)
    point, by = visit.T
    twice = [point[count > 2]]
    pairs = []
    # Of more than two contours at a point, each meets the next ones.
    for step in range(1, int(np.bincount(point).max())):
        (here,) = np.nonzero(point[step:] == point[:-step])
        if not len(here):
            break
        pairs.append(np.column_stack([by[here], by[here + step]]))
        twice.append(point[here][owner[by[here]] == owner[by[here + step]]])
    pairs = np.unique(np.concatenate([np.zeros((0, 2), dtype=np.int64), *pairs]), axis=0)
    return np.unique(np.concatenate(twice)), pairs[owner[pairs[:, 0]] == owner[pairs[:, 1]]]


def _check_turns(noded: Noded, edge, loop, signed: np.ndarray) -> None:
    """A contour that touches itself runs around faces once, always the same way, and along no edge twice."""
    wrong = np.flatnonzero(signed.max(axis=0) - signed.min(axis=0) > 1)
    if len(wrong):
        ends = noded.edges[edge[loop == wrong[0]]].ravel()
        raise _meeting(True, noded.points[np.flatnonzero(np.bincount(ends) > 2)[0]])
    key, count = np.unique(np.column_stack([edge, loop]), axis=0, return_counts=True)
    if (count > 1).any():
        raise _meeting(True, noded.points[noded.edges[key[count > 1][0, 0]]].mean(axis=0))


def _check_lost(noded: Noded, around: np.ndarray, n_loops: int) -> None:
    """Every contour is around a face: none is so small that its vertices became one with others."""
    lost = np.setdiff1d(np.arange(n_loops), around)
    if len(lost):
        x, y = map(float, noded.points[noded.first[lost[0]]])
        message = (
            f"The contour at ({x:.9g}, {y:.9g}) is thinner than a millionth of the domain's size, and what is as near "
            "to each other is joined. Leave it out, or mesh it by itself."
        )
        raise ContourError("zero-area", message, (x, y))


def _check_crossings(noded: Noded, edge, loop, face: np.ndarray, around: np.ndarray, pairs: np.ndarray) -> None:
    """Contours that touch lie inside each other or beside each other."""
    faces_in = np.split(face[np.argsort(around, kind="stable")], np.cumsum(np.bincount(around))[:-1])
    for one, other in pairs:
        both = len(np.intersect1d(faces_in[one], faces_in[other], assume_unique=True))
        if 0 < both < min(len(faces_in[one]), len(faces_in[other])):
            common = np.intersect1d(noded.edges[edge[loop == one]], noded.edges[edge[loop == other]])
            raise _meeting(False, noded.points[common[0]])


def _check_overlaps(noded: Noded, faces: Faces, covered: np.ndarray, domain: np.ndarray) -> None:
    """No face is in two domains; covered, domain (k,): faces, in order, and domains that they are in."""
    several = np.flatnonzero(covered[1:] == covered[:-1])
    if len(several):
        one, other = domain[several[0]], domain[several[0] + 1]
        half_edge = np.flatnonzero(faces.of_half_edge == covered[several[0]])[0]
        x, y = noded.points[noded.edges[half_edge % len(noded.edges)]].mean(axis=0)
        message = (
            f"Regions {one} and {other} (counting from 0) overlap near ({x:.9g}, {y:.9g}). Move their contours apart, "
            "or cut one of them out of the other, as a hole."
        )
        raise ContourError("overlap", message, (float(x), float(y)))


def _check_double_edges(noded: Noded, faces: Faces, edge, loop, owner, covered, inside) -> None:
    """Where contours of one domain run along each other, both have the inside of the domain beside them.

    covered, inside (k,): faces, and domains that they are in.
    """
    order = np.lexsort((owner[loop], edge))
    same = (np.diff(edge[order]) == 0) & (np.diff(owner[loop][order]) == 0)
    double, domain = edge[order][1:][same], owner[loop][order][1:][same]
    sides = np.stack(np.split(faces.of_half_edge, 2))[:, double]
    open_ = ~np.isin(sides + faces.count * domain, covered + faces.count * inside).all(axis=0)
    if open_.any():
        raise _meeting(False, noded.points[noded.edges[double[open_][0]]].mean(axis=0))


def _meeting(same_loop: bool, place: np.ndarray) -> ContourError:
    return meeting_error(same_loop, (float(place[0]), float(place[1])))
