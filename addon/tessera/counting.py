"""A mesh of a wanted number of triangles: an edge length from area and length, corrected by what comes out of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from .budget import enclosed_area, total_length
from .constraints import Domain, planar_domains
from .contour import clean_domains, nesting
from .errors import ContourError
from .mesh import Mesh
from .steps import Steps, within

TOLERANCE = 0.1  # of the wanted number
MOST_TRIES = 6
# A mesh of the target edge length l has about SHARE · (4/√3 · area / l² + BESIDE · length / l) triangles: fitted to
# meshes of 30 to 1500 triangles of squares, circles, stars, rings, strips and plates with holes.
_SHARE, _BESIDE = 1.05, 0.25


def expected_edge_length(domain: Sequence[ArrayLike] | Domain, n_triangles: int) -> float:
    """The target edge length, in the domain's unit, that gives about so many triangles of one size.

    domain: loops (k, 2), as for `mesh`, or regions. Raises ContourError for what cannot be meshed.
    """
    (cleaned,), planar = planar_domains([domain], clean_domains([() if isinstance(domain, Domain) else domain]))
    if isinstance(cleaned, ContourError):
        raise cleaned
    if not cleaned:
        raise ContourError("too-few-points", "The domain has no contour. Give at least one closed loop of points.")
    if planar:
        area, length = planar[0].graph.area(), planar[0].graph.length()
    else:
        area, length = enclosed_area(cleaned, nesting(cleaned)), total_length(cleaned)
    area, beside, wanted = 4 / 3**0.5 * area, _BESIDE * length, n_triangles / _SHARE
    return (beside + (beside**2 + 4 * wanted * area) ** 0.5) / (2 * wanted)


# Meshes those of several domains that have these numbers, at these target edge lengths.
MeshAt = Callable[[list[int], list[float]], Steps[list[Mesh | ContourError]]]


def mesh_to_counts(
    domains: Sequence[Sequence[ArrayLike] | Domain], wanted: Sequence[int], mesh_at: MeshAt
) -> Steps[list[Mesh | ContourError]]:
    """Mesh domains until the number of triangles of each is within 10 % of the wanted one.

    Gives the closest of at most six meshes of each, or its ContourError. Where corners, a kept boundary or limits of
    the sizing leave no such mesh, the closest has a warning.
    """
    results, searches = {}, {}
    for number, (domain, n_triangles) in enumerate(zip(domains, wanted, strict=True)):
        try:
            searches[number] = _Search(n_triangles, float(np.log(expected_edge_length(domain, n_triangles))))
        except ContourError as error:
            results[number] = error
    for tries in range(MOST_TRIES):
        if not searches:
            break
        # Nobody knows how many tries will follow: each has half of what is left.
        lengths = [float(np.exp(search.length)) for search in searches.values()]
        steps = within(mesh_at(list(searches), lengths), 1 - 0.5**tries, 1 - 0.5 ** (tries + 1))
        made = yield from steps
        for number, mesh in zip(list(searches), made, strict=True):
            if not isinstance(mesh, ContourError):
                searches[number] = searches[number].after(mesh)
                if not searches[number].is_over:
                    continue
                mesh = searches[number].result()
            results[number] = mesh
            del searches[number]
    results |= {number: search.result() for number, search in searches.items()}
    return [results[number] for number in range(len(results))]


@dataclass(frozen=True)
class _Search:
    """The search for a mesh of so many triangles; length: the logarithm of the target edge length to try next.

    tried: logarithms of lengths, and of the counts they gave over the wanted one; best: the closest mesh.
    """

    wanted: int
    length: float
    tried: tuple[tuple[float, float], ...] = ()
    best: Mesh | None = None

    def after(self, mesh: Mesh) -> _Search:
        """With what the length that was to be tried has come to."""
        best = mesh if self.best is None or self._error(mesh) < self._error(self.best) else self.best
        tried = (*self.tried, (self.length, float(np.log(mesh.report.n_triangles / self.wanted))))
        return _Search(self.wanted, _next(tried), tried, best)

    @property
    def is_over(self) -> bool:
        """Whether the best is close enough, or another length made no difference at all."""
        stuck = len(self.tried) > 1 and self.tried[-1][1] == self.tried[-2][1]
        return stuck or self._error(self.best) <= TOLERANCE

    def result(self) -> Mesh:
        """The best, with a warning where it is not close enough."""
        report = self.best.report
        if self._error(self.best) <= TOLERANCE:
            return self.best
        warning = (
            f"{self.wanted} triangles are wanted, and {report.n_triangles} is as close as meshing came: the outline's "
            "corners, a kept boundary or the sizing's limits leave no other number"
        )
        return replace(self.best, report=replace(report, warnings=(*report.warnings, warning)))

    def _error(self, mesh: Mesh) -> float:
        return abs(mesh.report.n_triangles / self.wanted - 1)


def _next(tried: Sequence[tuple[float, float]]) -> float:
    """The logarithm of the length to try next: between a longer and a shorter one, if both are known."""
    fewer = max((pair for pair in tried if pair[1] < 0), key=lambda pair: pair[1], default=None)
    more = min((pair for pair in tried if pair[1] > 0), key=lambda pair: pair[1], default=None)
    if fewer is None or more is None or fewer[0] <= more[0]:
        # The number goes with the inverse square of the length; where a limit holds it, farther each time.
        length, ratio = tried[-1]
        return length + ratio / 2 * len(tried)
    share = np.clip(more[1] / (more[1] - fewer[1]), 0.1, 0.9)
    return more[0] + share * (fewer[0] - more[0])
