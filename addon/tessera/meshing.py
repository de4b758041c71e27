"""Domains to meshes: the whole way from a user's curves to what `tessera.mesh` returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import repeat

import numpy as np
from numpy.typing import ArrayLike

from .assembly import mean_edge_lengths, mesh_cells, wanted_edge_lengths
from .boundary import resample_loops
from .bridges import bridge_holes
from .contour import Nesting, clean_domains, clean_loop, nesting, signed_area
from .division import divide
from .errors import ContourError
from .flips import flip_edges
from .gradation import Target, prepare
from .mesh import Mesh, make_mesh
from .notices import long_edge_warnings, lost_area_warnings
from .paper import roles_named
from .placement import MOST_INNER
from .refinement import refine
from .remeshing import improve
from .scheme import LARGEST_CONTOUR, join_vertices, mesh_contours
from .sizing import FromLoops, Sizing, checked_edge_length, checked_limits, grade_from_edges, positive
from .smoothing import checked_steps
from .smoothing import smooth as move_downhill
from .stopwatch import Stopwatch

MOST_TRIANGLES = 5_000_000


def mesh(
    loops: Sequence[ArrayLike],
    edge_length: float,
    *,
    sizing: Sizing | None = None,
    min_edge_length: float | None = None,
    gradation: float = 1.3,
    boundary: str = "resample",
    corner_angle: float = 32.0,
    flips: bool = False,
    smooth: int = 0,
) -> Mesh:
    """Mesh one domain: the planar region that closed curves bound.

    loops: (k, 2) arrays, in any winding and order: outer contours, holes and islands in them by the even-odd rule.
    edge_length: the target, in the loops' unit. boundary: "resample" places vertices on the given polylines at the
    target edge length, keeping their corners, which turn by more than corner_angle degrees; "keep" keeps exactly the
    given vertices and adds none on the contour. flips: a last pass exchanges edges where that raises the worse quality
    of the two elements beside them. smooth: how often every inner vertex may move after that, to better the poorest
    elements.

    sizing: asks for shorter targets than edge_length: a number; a function that takes points (n, 2) in the domain and
    gives lengths (n,); `by_curvature`, `by_thickness`, `by_distance`, `from_values`; or the `smallest` of several. No
    target is shorter than min_edge_length, and from one element to the next it changes by no more than the factor
    gradation.

    Raises ContourError, whose ``reason`` is a short word, for input that cannot be meshed, and a plain ValueError for
    what is no sequence of (k, 2) arrays of numbers.
    """
    wanted = sizing, min_edge_length, gradation, corner_angle
    (result,) = mesh_domains([loops], edge_length, boundary, flips, smooth, *wanted)
    if isinstance(result, ContourError):
        raise result
    return result


def mesh_many(
    domains: Sequence[Sequence[ArrayLike]],
    edge_length: float,
    *,
    sizing: Sizing | None = None,
    min_edge_length: float | None = None,
    gradation: float = 1.3,
    corner_angle: float = 32.0,
    flips: bool = False,
    smooth: int = 0,
) -> list[Mesh | ContourError]:
    """Mesh a batch of domains, each as `mesh` does: a Mesh, or the ContourError that it has, for each.

    Raises ContourError "edge-length" where no domain could be meshed at that length.
    """
    wanted = sizing, min_edge_length, gradation, corner_angle
    return mesh_domains(domains, edge_length, "resample", flips, smooth, *wanted)


def mesh_contour(
    points: ArrayLike, edge_length: float, *, flips: bool = False, smooth: int = 0, networks: str = "shipped"
) -> Mesh:
    """Mesh one contour by the paper's scheme alone: 3 ≤ N_C ≤ 16, its vertices are the boundary, untouched.

    points: (N_C, 2); flips, smooth: as in `mesh`; networks: "shipped", or the paper's own, "paper" with NN3 and
    "paper*" with NN3*, for contours that they were trained for (else ContourError "untrained-group"). The mesh's first
    N_C vertices are the contour's, counter-clockwise. Raises ContourError.
    """
    edge_length, smooth = checked_edge_length(edge_length), checked_steps(smooth)
    contour = clean_loop(points)
    n = len(contour)
    if n > LARGEST_CONTOUR:
        message = (
            f"The contour has {n} edges, the scheme alone meshes 3 to {LARGEST_CONTOUR}. "
            "Use tessera.mesh, which divides it."
        )
        raise ContourError("too-many-edges", message)
    watch = Stopwatch()
    n_contour = np.array([n])
    meshes = mesh_contours(contour[None], n_contour, np.array([edge_length]), watch, flips, roles_named(networks))
    (vertices,) = join_vertices(contour[None], n_contour, meshes.inner, meshes.n_inner)
    if smooth:
        with watch("smoothing"):
            vertices = move_downhill(vertices, meshes.triangles, smooth)
    warnings = long_edge_warnings([contour], lambda places: np.full(len(places), edge_length))
    if meshes.n_inner[0] < meshes.wanted[0]:
        warnings += (
            f"{meshes.wanted[0]} inner vertices would suit the target edge length, {meshes.n_inner[0]} were placed "
            f"(at most {MOST_INNER}): tessera.mesh refines further",
        )
    return make_mesh(
        vertices, meshes.triangles, fallbacks=int(meshes.fallbacks[0]), warnings=warnings, seconds=watch.seconds
    )


def mesh_domains(
    domains: Sequence[Sequence[ArrayLike]],
    edge_length: float,
    boundary: str,
    flips: bool,
    smooth: int,
    sizing: Sizing | None = None,
    min_edge_length: float | None = None,
    gradation: float = 1.3,
    corner_angle: float = 32.0,
) -> list[Mesh | ContourError]:
    """Mesh many domains as one batch: a Mesh, or the ContourError that it has, for each."""
    if boundary not in ("resample", "keep"):
        raise ValueError(f'boundary is "resample" or "keep", not {boundary!r}')
    smooth = checked_steps(smooth)
    limits = checked_limits(edge_length, min_edge_length, gradation, corner_angle)
    if sizing is not None and not callable(sizing) and not isinstance(sizing, FromLoops):
        number = max(positive(sizing, "sizing"), limits.shortest or 0.0)
        sizing, limits = None, replace(limits, longest=min(limits.longest, number))
    watch = Stopwatch()
    with watch("contours"):
        cleaned = clean_domains(domains)
        nested = [nesting([] if isinstance(loops, ContourError) else loops) for loops in cleaned]
        results = list(map(checked_domain, cleaned, nested, repeat(limits.longest)))
    with watch("sizing"):
        sound = {number: result for number, result in enumerate(results) if not isinstance(result, ContourError)}
        target, errors = prepare(sound, sizing, limits, MOST_TRIANGLES)
        results = [errors.get(number, result) for number, result in enumerate(results)]
    with watch("boundary"):
        numbers = [number for number, result in enumerate(results) if not isinstance(result, ContourError)]
        loops = [loop for number in numbers for loop in results[number]]
        domain = np.repeat(numbers, [len(results[number]) for number in numbers]).astype(np.int64)
        region, is_hole = _regions([nested[number] for number in numbers])
        if boundary == "resample" and loops:
            spacing = limits.longest if target.constant else target
            loops = resample_loops(loops, spacing, domain, limits.corner_angle)
    if loops:
        parts = _mesh_regions(loops, region, is_hole, domain, target, flips, smooth, watch)
        vertices, triangles, owner, fallbacks = parts
        of = domain[owner]
        fell = np.bincount(domain, fallbacks, minlength=len(results)).astype(int)
        for number, (part, elements) in zip(numbers, _parts(vertices, triangles, of, numbers), strict=True):
            if boundary == "keep":
                warnings = long_edge_warnings(
                    results[number], lambda places, n=number: target(places, np.full(len(places), n))
                )
            else:
                area = enclosed_area(results[number], nested[number])
                warnings = lost_area_warnings(area, part, elements, target.most[number])
            results[number] = make_mesh(
                part, elements, fallbacks=int(fell[number]), warnings=warnings, seconds=watch.seconds
            )
    return [target.errors.get(number, result) for number, result in enumerate(results)]


def checked_domain(
    loops: list[np.ndarray] | ContourError, nested: Nesting, edge_length: float
) -> list[np.ndarray] | ContourError:
    """Clean loops, or the error of a domain that has none or would have too many triangles."""
    if isinstance(loops, ContourError):
        return loops
    if not loops:
        return ContourError("too-few-points", "The domain has no contour. Give at least one closed loop of points.")
    area = enclosed_area(loops, nested)
    length = sum(float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum()) for loop in loops)
    # Equilateral triangles, and one on each edge of the boundary: area / l² + length / l, both divided before they are
    # multiplied, so that no length is too small or too large for it.
    area *= 4 / 3**0.5
    wanted = area / edge_length / edge_length + length / edge_length
    if wanted > MOST_TRIANGLES:
        smallest = (length + (length**2 + 4 * MOST_TRIANGLES * area) ** 0.5) / (2 * MOST_TRIANGLES)
        message = (
            f"The target edge length {edge_length:g} asks for about {wanted:.2g} triangles, "
            f"the most is {MOST_TRIANGLES:,}. Use {1.1 * smallest:.2g} or more."
        )
        return ContourError("too-many-triangles", message)
    return loops


def enclosed_area(loops: list[np.ndarray], nested: Nesting) -> float:
    """The area of a domain, without that of its holes; loops: counter-clockwise."""
    areas = np.array([signed_area(loop) for loop in loops])
    return float(areas[nested.outer].sum() - areas[nested.holes].sum())


def _regions(nested: list[Nesting]) -> tuple[np.ndarray, np.ndarray]:
    """Of all loops of domains, one behind the other: the number of the outer contour around each (l,), and the holes.

    An outer contour is its own; the numbers count all the loops.
    """
    region, is_hole, first = [], [], 0
    for loops in nested:
        own = np.arange(len(loops.outer) + len(loops.holes))
        own[loops.holes] = loops.parent
        region.append(own + first)
        is_hole.append(np.isin(np.arange(len(own)), loops.holes))
        first += len(own)
    if not region:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool)
    return np.concatenate(region), np.concatenate(is_hole)


def _mesh_regions(
    loops: list[np.ndarray],
    region: np.ndarray,
    is_hole: np.ndarray,
    domain: np.ndarray,
    target: Target,
    flips: bool,
    smooth: int,
    watch: Stopwatch,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mesh what loops bound (`bridge_holes`): vertices (n, 2), triangles (m, 3), the region of each (m,), fallbacks.

    domain: (l,) the number that the target knows each loop's domain by. The fallbacks are counted by region (l,), for
    as many as there are loops.
    """

    def wanted(points: np.ndarray, region: np.ndarray) -> np.ndarray:
        """The target at points (n, 2) of regions (n,)."""
        return target(points, domain[region])

    with watch("division"):
        longest, varying = target.most[domain], None if target.constant else wanted
        points, polygons = bridge_holes(loops, region, is_hole, longest, varying)
        division = divide(points, polygons, longest, varying)
        if target.constant:
            cell_target = mean_edge_lengths(division.points, division.cells)
        else:
            cell_target = wanted_edge_lengths(division.points, division.cells, division.owner, wanted)
    vertices, triangles, cell, fallbacks = mesh_cells(division.points, division.cells, cell_target, watch)
    owner = division.owner[cell]
    sizing = grade_from_edges(loops, region, wanted)
    vertices, triangles, parent, more = refine(vertices, triangles, owner, sizing, watch)
    counts = np.bincount(division.owner, fallbacks, minlength=len(loops))
    counts += np.bincount(owner, more, minlength=len(loops))
    vertices, triangles, owner, again = improve(vertices, triangles, owner[parent], watch)
    counts[: len(again)] += again
    if flips:
        with watch("flips"):
            triangles = flip_edges(vertices, triangles)
    if smooth:
        with watch("smoothing"):
            vertices = move_downhill(vertices, triangles, smooth, owner)
    return vertices, triangles, owner, counts


def _parts(
    vertices: np.ndarray, triangles: np.ndarray, domain: np.ndarray, numbers: list[int]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """The vertices and triangles of each domain by itself; vertices keep their order."""
    order = np.argsort(domain, kind="stable")
    triangles, domain = triangles[order], domain[order]
    starts = np.searchsorted(domain, numbers)
    ends = np.searchsorted(domain, numbers, side="right")
    parts = []
    for start, end in zip(starts, ends, strict=True):
        used, local = np.unique(triangles[start:end], return_inverse=True)
        parts.append((vertices[used], local.reshape(-1, 3)))
    return parts
