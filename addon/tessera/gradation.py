"""The sizing of a call made ready for meshing: joined, limited and graded, or found to ask for what cannot be.

Where a user's function rises faster than the gradation allows, the places at the foot of the rise are found by sampling
the domain, and the wanted length grows from them as from any other place: h(x) = min (h(s) + slope · |x - s|).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .cones import Cones, Places, build_cones, join_places, lowest
from .contour import lost_in_rounding, real_numbers
from .errors import ContourError
from .sampling import Samples, neighbours, sample_domain
from .sizing import Limits, Sizing, checked_lengths, parts_of

# Cells of the sampling are at most so many times as large as the length wanted in them.
_COARSEST = 2.0
# Where it rises too steeply, they are as fine as this, so that the foot of the rise is found.
_FINEST = 0.5
# Cells that touch rise as fast as the function, but the way through their places is longer than the straight one.
_DETOUR = 0.8
# A function may fall unseen between samples, but not to less than this share of the least that was seen.
_UNSEEN = 0.5
_MOST_EDGES = 1e100  # along the side of a cell: more are as many
_EQUILATERAL = 4 / np.sqrt(3)  # triangles in the square of their edge length


@dataclass(frozen=True)
class Target:
    """The edge length that is wanted at each point of each domain, where it is not the same everywhere.

    functions: the user's, of those domains that have any; cones: of all domains; most, least: (d,) bounds in each
    domain; errors: what went wrong with a function while meshing, by domain.
    """

    functions: dict[int, list[Callable[[np.ndarray], np.ndarray]]]
    cones: Cones | None
    most: np.ndarray
    least: np.ndarray
    errors: dict[int, ContourError] = field(default_factory=dict)

    def __call__(self, points: np.ndarray, domain: np.ndarray) -> np.ndarray:
        """Points (n, 2) of domains (n,) -> lengths (n,)."""
        wanted = self.most[domain]
        for number, functions in self.functions.items():
            rows = np.flatnonzero(domain == number)
            if len(rows) and number not in self.errors:
                try:
                    wanted[rows] = np.minimum(wanted[rows], _smallest_of(functions, points[rows]))
                except ContourError as error:
                    self.errors[number] = error
        return np.maximum(lowest(self.cones, points, domain, wanted), self.least[domain])

    def inside(self, domain: int) -> Callable[[np.ndarray], np.ndarray]:
        """The target of one domain: points (n, 2) -> lengths (n,)."""
        return lambda points: self(points, np.full(len(points), domain))

    @cached_property
    def constant(self) -> np.ndarray:
        """(d,) which domains have one length everywhere."""
        constant = np.ones(len(self.most), dtype=bool)
        constant[list(self.functions)] = False
        if self.cones is not None:
            constant[self.cones.places.domain] = False
        return constant


def prepare(
    domains: dict[int, list[np.ndarray]], wanted: Sequence[tuple[Sizing | None, Limits]], most_triangles: int
) -> tuple[Target, dict[int, ContourError]]:
    """The target in each of the numbered domains, and the errors of those that have one.

    domains: loops, counter-clockwise, by number; wanted: of all numbers, the sizing, without which all lengths are the
    longest, and its limits; most_triangles: a domain that needs more has an error.
    """
    size = max(domains, default=-1) + 1
    most = np.array([limits.longest for _, limits in wanted[:size]])
    least = np.array([limits.shortest or 0.0 for _, limits in wanted[:size]])
    functions, places, errors = {}, [], {}
    for number, loops in domains.items():
        sizing, limits = wanted[number]
        if sizing is None:
            continue
        try:
            own, own_places, most[number], least[number] = _prepare_one(loops, sizing, limits, most_triangles)
        except ContourError as error:
            errors[number] = error
            continue
        if own:
            functions[number] = own
        if own_places is not None:
            places.append(_of_domain(own_places, number))
    return Target(functions, build_cones(join_places(places)) if places else None, most, least), errors


def _of_domain(places: Places, number: int) -> Places:
    return Places(places.start, places.end, places.value, places.slope, np.full(len(places.value), number))


def _prepare_one(loops: list[np.ndarray], sizing: Sizing, limits: Limits, most_triangles: int):
    """One domain's functions, places, longest and shortest wanted length."""
    parts = parts_of(sizing, loops, limits)
    functions = [part for part in parts if callable(part)]
    places = [part for part in parts if isinstance(part, Places)]
    longest = min([limits.longest] + [part for part in parts if isinstance(part, float)])
    shortest = limits.shortest or 0.0
    cones = build_cones(join_places(places)) if places else None

    def ungraded(points: np.ndarray) -> np.ndarray:
        wanted = np.minimum(_smallest_of(functions, points), longest)
        return np.maximum(lowest(cones, points, np.zeros(len(points), dtype=np.int64), wanted), shortest)

    def too_large(samples: Samples) -> np.ndarray:
        if _fewest_triangles(samples, limits.slope) > most_triangles:
            raise _too_many(samples, samples.values, most_triangles)
        large = samples.size > _COARSEST * samples.values
        if functions and not large.any():
            foot, top = _rises(samples, limits.slope)
            for side in (foot, top):
                large[side[samples.size[side] > _FINEST * samples.values[foot]]] = True
        return large

    samples = sample_domain(loops, ungraded, too_large)
    values = samples.values
    if functions:
        places += _feet(samples, limits.slope)
        cones = build_cones(join_places(places)) if places else None
        values = lowest(cones, samples.points, np.zeros(len(values), dtype=np.int64), values)
    if error := _too_many(samples, values, most_triangles) or lost_in_rounding(loops, values.min()):
        raise error
    if values.min() == values.max():
        return [], None, values.max(), shortest
    if functions:
        shortest = max(shortest, _UNSEEN * values.min())
    return functions, join_places(places) if places else None, values.max(), shortest


def _smallest_of(functions: list[Callable[[np.ndarray], np.ndarray]], points: np.ndarray) -> np.ndarray:
    """(n,) the smallest of the users' functions at points (n, 2); raises ContourError where one is no length."""
    smallest = np.full(len(points), np.inf)
    for function in functions if len(points) else ():
        given = function(points.copy())
        try:
            values = real_numbers(given, "a sizing")
        except ValueError:
            values = np.zeros(0)
        if values.shape != (len(points),):
            place = tuple(map(float, points[0]))
            message = f"The sizing function gave {_shape_of(given)} for {len(points)} points, of which the first is "
            message += f"({place[0]:g}, {place[1]:g}). Let it give real numbers, an array of shape ({len(points)},)."
            raise ContourError("sizing", message, place)
        checked_lengths(values, points, "The sizing function")
        smallest = np.minimum(smallest, values)
    return smallest


def _shape_of(given: object) -> str:
    if isinstance(given, np.ndarray):
        return f"an array of {given.dtype} of shape {given.shape}"
    return f"a {type(given).__name__}"


def _rises(samples: Samples, slope: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of cells that touch, between which the function rises faster than allowed: the lower and the higher."""
    one, other = neighbours(samples)
    rise = samples.values[other] - samples.values[one]
    foot, top = np.where(rise > 0, one, other), np.where(rise > 0, other, one)
    x, y = (samples.points[top] - samples.points[foot]).T
    steep = np.abs(rise) > _DETOUR * slope * np.hypot(x, y)
    return foot[steep], top[steep]


def _feet(samples: Samples, slope: float) -> list[Places]:
    """The places at the feet of rises that are too steep, without those that lie in the rise from another."""
    foot = np.unique(_rises(samples, slope)[0])
    if not len(foot):
        return []
    points, values, domain = samples.points[foot], samples.values[foot], np.zeros(len(foot), dtype=np.int64)
    places = Places(points, points, values, np.full(len(foot), slope), domain)
    below = lowest(build_cones(places), points, domain, np.full(len(foot), np.inf)) < values
    return [places.rows(~below)]


def _fewest_triangles(samples: Samples, slope: float) -> float:
    """How many triangles there are at least: in each cell the length may grow from its place to all sides."""
    inside = samples.inside
    growth = slope / np.sqrt(np.pi) * _edges_along(samples.size[inside], samples.values[inside])
    return _EQUILATERAL * 2 * np.pi / slope**2 * float(np.sum(np.log1p(growth) - growth / (1 + growth)))


def _edges_along(size: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(n,) how many edges of lengths (n,) fit along the sides (n,) of cells, at most `_MOST_EDGES`."""
    with np.errstate(over="ignore"):
        return np.minimum(size / values, _MOST_EDGES)


def _too_many(samples: Samples, values: np.ndarray, most: int) -> ContourError | None:
    """The error "too-many-triangles" of lengths `values` (n,) in the cells, if there are more than `most`."""
    edges = _edges_along(samples.size, values)
    triangles = _EQUILATERAL * np.sum(edges[samples.inside] ** 2) + np.sum(samples.boundary() / samples.size * edges)
    if triangles <= most:
        return None
    smallest = int(np.argmin(values))
    place = tuple(map(float, samples.points[smallest]))
    factor = 1.1 * (triangles / most) ** 0.5
    message = (
        f"The sizing asks for about {triangles:.2g} triangles, the most is {most:,}; it is smallest, "
        f"{values[smallest]:.2g}, at ({place[0]:g}, {place[1]:g}). Multiply it by {factor:.2g} or more, or give a "
        "larger min_edge_length."
    )
    return ContourError("too-many-triangles", message, place)
