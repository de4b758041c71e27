"""The scheme once more, on the cavities around a large mesh's poor elements.

What the division cut apart may fit badly where cells meet. The elements around the free vertices of a poor element are
taken out; what is left is a contour, meshed by the scheme like any other, across whatever seam was there. The new
elements stay where their worst and mean quality, added, are better.
"""

from __future__ import annotations

import numpy as np

from .assembly import mean_edge_lengths, mesh_cells
from .edges import among, off_boundary
from .quality import element_quality
from .relaxation import relax
from .scheme import LARGEST_CONTOUR
from .stopwatch import Stopwatch

ROUNDS = 3
POOR = 0.85  # elements of less quality are worth a try
_GAIN = 1e-2  # in worst and mean quality added


def improve(
    vertices: np.ndarray,
    triangles: np.ndarray,
    domain: np.ndarray,
    watch: Stopwatch,
    fixed: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Relax a mesh, then mesh its poor cavities again and relax, a few times.

    vertices: (n, 2); triangles: (m, 3); domain: (m,) int from 0: each domain is treated as it would be alone;
    fixed: (f, 2) edges that stay, as the boundary does. Returns the same of the better mesh, where vertices that it has
    no use for stay, and the fallbacks of each domain.
    """
    fallbacks = np.zeros(int(domain.max()) + 1, dtype=np.int64)
    with watch("relaxation"):
        vertices = relax(vertices, triangles, domain, fixed=fixed)
    active = np.ones(len(domain), dtype=bool)
    for _ in range(ROUNDS):
        vertices, new, of, replaced, homes, fell = _remesh(vertices, triangles[active], domain[active], watch, fixed)
        triangles, domain = np.concatenate([triangles[~active], new]), np.concatenate([domain[~active], of])
        np.add.at(fallbacks, homes, fell)
        active = np.isin(domain, homes)
        if not active.any():
            break
        disturbed = np.zeros(len(vertices), dtype=bool)
        disturbed[replaced] = True
        with watch("relaxation"):
            vertices = relax(vertices, triangles, domain, disturbed=disturbed, fixed=fixed)
    return vertices, triangles, domain, fallbacks


def _remesh(
    vertices: np.ndarray, triangles: np.ndarray, domain: np.ndarray, watch: Stopwatch, fixed: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mesh poor cavities again, once.

    Returns vertices, triangles and their domains; then, of the cavities that this made better, the elements' vertices,
    and the domain and the fallbacks of each.
    """
    quality = element_quality(vertices, triangles)
    cavity = _cavities(triangles, quality, off_boundary(triangles, len(vertices), fixed))
    if fixed is not None:
        cavity[np.isin(cavity, _swallowing(triangles, cavity, fixed))] = -1
    contours, cavity = _contours(triangles, cavity)
    if not len(contours):
        return vertices, triangles, domain, domain[:0], domain[:0], domain[:0]
    taken = np.flatnonzero(cavity >= 0)
    points, new, owner, fell = mesh_cells(vertices, contours, mean_edge_lengths(vertices, contours), watch)
    before = _worst_and_mean(quality[taken], cavity[taken], len(contours)).sum(axis=0)
    after = _worst_and_mean(element_quality(points, new), owner, len(contours)).sum(axis=0)
    better = after > before + _GAIN
    home = np.zeros(len(contours), dtype=domain.dtype)
    home[cavity[taken]] = domain[taken]
    stay, come = ~((cavity >= 0) & better[cavity]), better[owner]
    triangles = np.concatenate([triangles[stay], new[come]])
    domain = np.concatenate([domain[stay], home[owner[come]]])
    return points, triangles, domain, new[come].ravel(), home[better], fell[better]


def _cavities(triangles: np.ndarray, quality: np.ndarray, free: np.ndarray) -> np.ndarray:
    """(m,) number of the cavity that each element is taken into, or -1: no two cavities share an element.

    The cavity of a poor element is all elements around its free vertices. Where cavities meet, the worse one's stays.
    """
    poor = np.flatnonzero((quality < POOR) & free[triangles].any(axis=1))
    poor = poor[np.argsort(quality[poor], kind="stable")]
    rank_at = np.full(len(free), len(poor))  # of the worst poor element that wants the elements around a vertex
    corners = np.where(free[triangles[poor]], triangles[poor], -1)
    for corner in corners.T:
        np.minimum.at(rank_at, corner[corner >= 0], np.flatnonzero(corner >= 0))
    wanted_by = rank_at[triangles]
    best = wanted_by.min(axis=1)
    # A poor element gets its cavity if no element of it is wanted more by another one.
    spoiled = np.zeros(len(poor) + 1, dtype=bool)
    for corner in wanted_by.T:
        spoiled[corner[corner > best]] = True
    for corner in corners.T:
        lost = (corner >= 0) & (rank_at[corner] != np.arange(len(poor)))
        spoiled[:-1] |= lost
    spoiled[-1] = True
    return np.where(spoiled[best], -1, best)


def _swallowing(triangles: np.ndarray, cavity: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """The cavities that have a fixed edge between two of their elements, or one of its vertices amid them."""
    inside = np.flatnonzero(cavity >= 0)
    start, end = triangles[inside].ravel(), np.roll(triangles[inside], -1, axis=1).ravel()
    label = np.repeat(cavity[inside], 3)
    stride = int(triangles.max(initial=0)) + 1
    here, back = ((label * stride + a) * stride + b for a, b in ((start, end), (end, start)))
    within = np.isin(here, back)
    edges = label[within & among(np.column_stack([start, end]), fixed)]
    at = label * stride + start
    on_outline = np.isin(at, np.concatenate([at[~within], (label * stride + end)[~within]]))
    return np.unique(np.concatenate([edges, label[~on_outline & np.isin(start, fixed)]]))


def _contours(triangles: np.ndarray, cavity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The contours of cavities (c, N), padded with -1, and the cavities (m,) numbered anew; unfit ones are dropped.

    A cavity is fit if its boundary is one cycle that visits no vertex twice and has at most 16 edges.
    """
    inside = np.flatnonzero(cavity >= 0)
    start = triangles[inside].ravel().astype(np.int64)
    end = np.roll(triangles[inside], -1, axis=1).ravel().astype(np.int64)
    label = np.repeat(cavity[inside], 3)
    stride = int(triangles.max(initial=0)) + 1
    here, back = ((label * stride + a) * stride + b for a, b in ((start, end), (end, start)))
    outline = ~np.isin(here, back)
    label, start, end = label[outline], start[outline], end[outline]
    order = np.lexsort((start, label))
    label, start, end = label[order], start[order], end[order]
    numbers, first, count = np.unique(label, return_index=True, return_counts=True)
    key = label * stride + start
    following = np.minimum(np.searchsorted(key, label * stride + end), len(key) - 1)
    contours = np.full((len(numbers), LARGEST_CONTOUR), -1, dtype=np.int64)
    at, length = first, np.zeros(len(numbers), dtype=np.int64)
    for k in range(LARGEST_CONTOUR):
        contours[:, k] = np.where(k < count, start[at], -1)
        at = following[at]
        length = np.where((length == 0) & (at == first), k + 1, length)
    repeated = np.zeros(len(numbers), dtype=bool)
    repeated[np.searchsorted(numbers, label[1:][key[1:] == key[:-1]])] = True
    fit = (length == count) & ~repeated
    anew = np.full(int(cavity.max(initial=-1)) + 2, -1)
    anew[numbers[fit]] = np.arange(fit.sum())
    return contours[fit], anew[cavity]


def _worst_and_mean(quality: np.ndarray, owner: np.ndarray, count: int) -> np.ndarray:
    """(2, count) worst and mean quality of the elements of each owner."""
    worst = np.ones(count)
    np.minimum.at(worst, owner, quality)
    return np.stack([worst, np.bincount(owner, quality, count) / np.maximum(np.bincount(owner, minlength=count), 1)])
