"""The scheme once more, on patches around a large mesh's poor elements and irregular vertices.

What the division cut apart may fit badly where cells meet. The elements of a patch are taken out; what is left is a
contour, meshed by the scheme like any other, across whatever seam was there: with as many inner vertices as NN1 asks
for, and with a few less and more. The best of the meshes stays, if it is better than the elements that were there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .assembly import mean_edge_lengths, mesh_cells, middles
from .edges import off_boundary
from .patches import find_patches
from .quality import element_quality
from .refinement import Sizing
from .relaxation import relax
from .steps import Progress, Steps, within
from .stopwatch import Stopwatch

# Small domains are those of up to so many elements (regions count by themselves), at the last level and before it; they
# have more turns, tries and choices than large ones. Of what comes in twos, the first is for small domains.
_SMALL, _SMALL_BEFORE = 5000, 300
_TURNS, _TURNS_BEFORE = (8, 4), (8, 2)
POOR = 0.96  # elements of less quality are worth a try
_ALL_MORE, _MORE = (0, -1, 1, 2, -2), (0, -1, 1)  # inner vertices than NN1 asks for
# What a patch is worth: its worst quality, and so many times its mean; a new one has to be better by the gain. Of those
# that are worth as much as `_GOOD` already, few would get better, and by little: they are not tried. Those below `_BAD`
# are; those between only where a domain has more to try than `_FEW` of its elements, or a turn is not worth it.
_MEAN, _GAIN, _GOOD, _BAD, _FEW = 3, 3e-3, (3.95, 3.75), (3.8, 3.6), 1e-3
_RELAXED = 0.3  # share of the work that is done after the first relaxation


def improve(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    sizing: Sizing,
    passes: int,
    watch: Stopwatch,
    fixed: np.ndarray | None = None,
    last: bool = True,
) -> Steps[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Relax a mesh, then mesh its poor patches again and relax, a few times.

    vertices: (n, 2); triangles: (m, 3); domain: (m,) int from 0: each domain is treated as it would be alone; sizing:
    (k, 2) points and the domains (k,) that they are in -> (k,) wanted edge lengths; passes: of relaxation; fixed:
    (f, 2) edges that stay, as the boundary does; last: no finer level follows. Returns vertices, triangles and domain
    of the better mesh, where vertices that it has no use for stay, and the fallbacks of each domain.
    """
    fallbacks = np.zeros(int(domain.max()) + 1, dtype=np.int64)
    free = off_boundary(triangles, len(vertices), fixed)
    vertices = yield from within(relax(vertices, triangles, domain, free, passes, watch), 0.0, _RELAXED)
    tried = np.zeros(len(vertices), dtype=bool), np.zeros(len(vertices), dtype=bool)
    n_elements = np.bincount(domain)
    small = n_elements <= (_SMALL if last else _SMALL_BEFORE)
    turns = np.where(n_elements == 0, 0, np.where(small, *(_TURNS if last else _TURNS_BEFORE)))
    most = turns.max()
    for turn in range(most):
        quality = element_quality(vertices, triangles)
        contours, patch, kind = find_patches(triangles, quality, free, tried, POOR, fixed)
        if not len(contours):
            break
        for number in (0, 1):
            tried[number][triangles[(patch >= 0) & (kind[patch] == number)]] = True
        contours, patch, home = _worthwhile(contours, patch, quality, domain, small, turn < turns)
        # A domain that has nothing worth a try is done.
        turns[np.bincount(home, minlength=len(turns)) == 0] = 0
        if not len(contours):
            break
        start, end = (_RELAXED + (1 - _RELAXED) * (turn + n) / most for n in (0, 1))
        remesh = _remesh(vertices, triangles, domain, quality, contours, patch, home, small, sizing, watch)
        found = yield from within(remesh, start, end)
        np.add.at(fallbacks, found.homes, found.fallbacks)
        triangles, domain = found.triangles, found.domain
        disturbed = np.zeros(len(found.vertices), dtype=bool)
        disturbed[found.replaced] = True
        free = np.append(free, np.ones(len(disturbed) - len(free), dtype=bool))
        relaxation = relax(found.vertices, triangles, domain, free, passes, watch, disturbed)
        vertices = yield from within(relaxation, end, end)
        disturbed |= (vertices != found.vertices).any(axis=1)
        tried = tuple(np.append(one, ~disturbed[len(one) :]) & ~disturbed for one in tried)
    yield Progress("relaxation", 1.0)
    return vertices, triangles, domain, fallbacks


def _worthwhile(
    contours: np.ndarray,
    patch: np.ndarray,
    quality: np.ndarray,
    domain: np.ndarray,
    small: np.ndarray,
    going: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The contours of patches (c, N), and each element's patch (m,) or -1, without those that are not worth a try.

    Returns the domains (c,) of those that are, too.
    small, going: (d,) bool, which domains are small, and which have this turn.
    """
    taken = np.flatnonzero(patch >= 0)
    worth = _worth(quality[taken], patch[taken], len(contours))
    home = np.zeros(len(contours), dtype=domain.dtype)
    home[patch[taken]] = domain[taken]
    n_elements = np.bincount(domain)
    good, bad = (np.where(small, *limits)[home] for limits in (_GOOD, _BAD))
    poor = (worth < good) & going[home]
    poor &= (worth < bad) | (np.bincount(home[poor], minlength=len(n_elements)) > _FEW * n_elements)[home]
    anew = np.append(np.where(poor, np.cumsum(poor) - 1, -1), -1)
    return contours[poor], anew[patch], home[poor]


@dataclass(frozen=True)
class _Remeshed:
    """A mesh after a turn; replaced: the vertices of new elements; homes, fallbacks: (b,) of each patch made better."""

    vertices: np.ndarray
    triangles: np.ndarray
    domain: np.ndarray
    replaced: np.ndarray
    homes: np.ndarray
    fallbacks: np.ndarray


def _remesh(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    quality: np.ndarray,
    contours: np.ndarray,
    patch: np.ndarray,
    home: np.ndarray,
    small: np.ndarray,
    sizing: Sizing,
    watch: Stopwatch,
) -> Steps[_Remeshed]:
    """Mesh patches (c, N) of domains `home` (c,) again, once; patch, small: as of `_worthwhile`."""
    n, taken = len(contours), np.flatnonzero(patch >= 0)
    # A patch is no reason for smaller elements than are wanted, though its own edges may be shorter.
    lengths = np.maximum(mean_edge_lengths(vertices, contours), sizing(middles(vertices, contours), home))
    more = _ALL_MORE if small[home].any() else _MORE
    points, new, made, fell = yield from mesh_cells(vertices, contours, lengths, watch, more)
    before = _worth(quality[taken], patch[taken], n)
    after = _worth(element_quality(points, new), made, n * len(more)).reshape(n, -1)
    after[~small[home], len(_MORE) :] = -np.inf
    better = np.flatnonzero(after.max(axis=1) > before + _GAIN)
    chosen = better * len(more) + after[better].argmax(axis=1)
    come = np.isin(made, chosen)
    stay = ~np.isin(patch, better)
    points, new = _without_unused(points, new[come], len(vertices))
    return _Remeshed(
        points,
        np.concatenate([triangles[stay], new]),
        np.concatenate([domain[stay], home[made[come] // len(more)]]),
        new.ravel(),
        home[better],
        fell[chosen],
    )


def _without_unused(points: np.ndarray, triangles: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles without those points from `first` on that no triangle has."""
    used = np.ones(len(points), dtype=bool)
    used[first:] = False
    used[triangles] = True
    return points[used], (np.cumsum(used) - 1)[triangles]


def _worth(quality: np.ndarray, owner: np.ndarray, count: int) -> np.ndarray:
    """(count,) worst and `_MEAN` times the mean quality of the elements of each owner, added."""
    worst = np.ones(count)
    np.minimum.at(worst, owner, quality)
    return worst + _MEAN * np.bincount(owner, quality, count) / np.maximum(np.bincount(owner, minlength=count), 1)
