"""Domains to meshes: the whole way from a user's curves to what `tessera.mesh` returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from .assembly import mean_edge_lengths, mesh_cells, wanted_edge_lengths
from .constraints import Domain, PlanarDomain, planar_domains
from .contour import Nesting, clean_domains, clean_loop, edges_of, nesting, signed_area
from .division import divide
from .errors import ContourError
from .flips import flip_edges
from .gradation import Target, prepare
from .mesh import Mesh, make_mesh
from .notices import gap_warnings, long_edge_warnings, lost_area_warnings, repeated_warnings
from .outlines import Outlines, outlines_of, resampled
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
    points: ArrayLike | None = None,
    lines: Sequence[ArrayLike] = (),
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

    points: (p, 2), inside the domain, that must be vertices of the mesh. lines: polylines (k, 2), closed if they end
    where they start, whose course must be edges of the mesh; their vertices are placed as those of the contours. They
    may end at contours and at each other, and share vertices, but they cross nothing.

    sizing: asks for shorter targets than edge_length: a number; a function that takes points (n, 2) in the domain and
    gives lengths (n,); `by_curvature`, `by_thickness`, `by_distance`, `from_values`; or the `smallest` of several. No
    target is shorter than min_edge_length, and from one element to the next it changes by no more than the factor
    gradation.

    Contours that touch in vertices, or outside of each other along edges, are meshed with a common boundary there, and
    a warning. The mesh's region is the number of the outer contour around each triangle.

    Raises ContourError, whose ``reason`` is a short word, for input that cannot be meshed, and a plain ValueError for
    what is no sequence of (k, 2) arrays of numbers.
    """
    wanted = sizing, min_edge_length, gradation, corner_angle
    constrained = points is not None or len(lines) > 0
    domain = Domain(loops, None, points, lines) if constrained else loops
    (result,) = mesh_domains([domain], edge_length, boundary, flips, smooth, *wanted)
    if isinstance(result, ContourError):
        raise result
    return result


def mesh_regions(
    regions: Sequence[Sequence[ArrayLike]],
    edge_length: float,
    *,
    points: ArrayLike | None = None,
    lines: Sequence[ArrayLike] = (),
    sizing: Sizing | None = None,
    min_edge_length: float | None = None,
    gradation: float = 1.3,
    boundary: str = "resample",
    corner_angle: float = 32.0,
    flips: bool = False,
    smooth: int = 0,
) -> Mesh:
    """Mesh several regions as one: where they share edges, or parts of them, they have the same vertices.

    regions: domains as of `mesh`, that do not overlap. A vertex of one that is nearer to an edge of another than 1e-6
    of the size of all lies on it. The mesh's region is the number of the region that each triangle is part of. All else
    is as of `mesh`. Raises ContourError, "overlap" for regions that overlap.
    """
    wanted = sizing, min_edge_length, gradation, corner_angle
    loops = [loop for region in regions for loop in region]
    of = [number for number, region in enumerate(regions) for _ in region]
    (result,) = mesh_domains([Domain(loops, of, points, lines)], edge_length, boundary, flips, smooth, *wanted)
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


def mesh_contour(points: ArrayLike, edge_length: float, *, flips: bool = False, smooth: int = 0) -> Mesh:
    """Mesh one contour by the paper's scheme alone: 3 ≤ N_C ≤ 16, its vertices are the boundary, untouched.

    points: (N_C, 2); flips, smooth: as in `mesh`. The mesh's first N_C vertices are the contour's, counter-clockwise.
    Raises ContourError.
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
    meshes = mesh_contours(contour[None], n_contour, np.array([edge_length]), watch, flips)
    (vertices,) = join_vertices(contour[None], n_contour, meshes.inner, meshes.n_inner)
    if smooth:
        with watch("smoothing"):
            vertices = move_downhill(vertices, meshes.triangles, smooth)
    warnings = long_edge_warnings(*edges_of([contour]), lambda places: np.full(len(places), edge_length))
    if meshes.n_inner[0] < meshes.wanted[0]:
        warnings += (
            f"{meshes.wanted[0]} inner vertices would suit the target edge length, {meshes.n_inner[0]} were placed "
            f"(at most {MOST_INNER}): tessera.mesh refines further",
        )
    return make_mesh(
        vertices,
        meshes.triangles,
        np.zeros(len(meshes.triangles)),
        fallbacks=int(meshes.fallbacks[0]),
        warnings=warnings,
        seconds=watch.seconds,
    )


def mesh_domains(
    domains: Sequence[Sequence[ArrayLike] | Domain],
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
        cleaned, planar = planar_domains(domains, clean_domains([() if isinstance(d, Domain) else d for d in domains]))
        nested = [nesting([] if isinstance(d, ContourError) or n in planar else d) for n, d in enumerate(cleaned)]
        results = [
            checked_graph(planar[n], limits.longest) if n in planar else checked_domain(d, nested[n], limits.longest)
            for n, d in enumerate(cleaned)
        ]
    with watch("sizing"):
        sound = {number: result for number, result in enumerate(results) if not isinstance(result, ContourError)}
        target, errors = prepare(sound, sizing, limits, MOST_TRIANGLES)
        results = [errors.get(number, result) for number, result in enumerate(results)]
    with watch("boundary"):
        numbers = [number for number, result in enumerate(results) if not isinstance(result, ContourError)]
        outlines = outlines_of(results, nested, planar, numbers)
        if boundary == "resample":
            outlines = resampled(outlines, target, limits.corner_angle)
        start, end, of = outlines.edges()
        gaps = gap_warnings(start, end, outlines.domains[of], target)
    if numbers:
        vertices, triangles, owner, fallbacks = _mesh_regions(outlines, target, flips, smooth, watch)
        domain, first = outlines.domains, outlines.firsts
        fell = np.bincount(domain, fallbacks, minlength=len(results)).astype(int)
        parts = _parts(vertices, triangles, owner, domain[owner], numbers)
        for number, (part, elements, region) in zip(numbers, parts, strict=True):
            one, places = planar.get(number), target.inside(number)
            if boundary == "keep":
                ends = one.graph.points[one.graph.edges.T] if one else edges_of(results[number])
                warnings = long_edge_warnings(*ends, places)
            else:
                area = one.graph.area() if one else enclosed_area(results[number], nested[number])
                warnings = lost_area_warnings(area, part, elements, target.most[number])
            given = domains[number]
            repeated = repeated_warnings(given.loops if isinstance(given, Domain) else given, results[number])
            results[number] = make_mesh(
                part,
                elements,
                region - first[number],
                fallbacks=int(fell[number]),
                warnings=warnings + (one.warnings if one else ()) + gaps.get(number, ()) + repeated,
                seconds=watch.seconds,
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
    length = sum(float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum()) for loop in loops)
    return _too_many(enclosed_area(loops, nested), length, edge_length) or loops


def checked_graph(domain: PlanarDomain, edge_length: float) -> list[np.ndarray] | ContourError:
    """The domain's clean loops, or the error of one that would have too many triangles."""
    return _too_many(domain.graph.area(), domain.graph.length(), edge_length) or domain.loops


def _too_many(area: float, length: float, edge_length: float) -> ContourError | None:
    """The error of a domain of an area, with so much of boundary, that would have too many triangles."""
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
    return None


def enclosed_area(loops: list[np.ndarray], nested: Nesting) -> float:
    """The area of a domain, without that of its holes; loops: counter-clockwise."""
    areas = np.array([signed_area(loop) for loop in loops])
    return float(areas[nested.outer].sum() - areas[nested.holes].sum())


def _mesh_regions(
    outlines: Outlines, target: Target, flips: bool, smooth: int, watch: Stopwatch
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Mesh what outlines bound: vertices (n, 2), triangles (m, 3) and their regions (m,), fallbacks by region (r,)."""
    domain = outlines.domains

    def wanted(points: np.ndarray, region: np.ndarray) -> np.ndarray:
        """The target at points (n, 2) of regions (n,)."""
        return target(points, domain[region])

    with watch("division"):
        longest, varying = target.most[domain], None if target.constant else wanted
        points, polygons, fixed = outlines.polygons(longest, varying)
        division = divide(points, polygons, longest, varying)
        if target.constant:
            cell_target = mean_edge_lengths(division.points, division.cells)
        else:
            cell_target = wanted_edge_lengths(division.points, division.cells, division.owner, wanted)
    vertices, triangles, cell, fallbacks = mesh_cells(division.points, division.cells, cell_target, watch)
    owner = division.owner[cell]
    sizing = grade_from_edges(*outlines.edges(), wanted)
    if fixed is not None:  # an edge between two regions has the same length for both
        together, of_one = outlines.together(), sizing
        sizing = lambda points, region: of_one(points, together[region])  # noqa: E731
    vertices, triangles, parent, more = refine(vertices, triangles, owner, sizing, watch, fixed)
    counts = np.bincount(division.owner, fallbacks, minlength=len(domain))
    counts += np.bincount(owner, more, minlength=len(domain))
    vertices, triangles, owner, again = improve(vertices, triangles, owner[parent], watch, fixed)
    counts[: len(again)] += again
    if flips:
        with watch("flips"):
            triangles = flip_edges(vertices, triangles, fixed)
    if smooth:
        with watch("smoothing"):
            vertices = move_downhill(vertices, triangles, smooth, owner, fixed)
    return vertices, triangles, owner, counts


def _parts(
    vertices: np.ndarray, triangles: np.ndarray, region: np.ndarray, domain: np.ndarray, numbers: list[int]
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """The vertices, the triangles and their regions of each domain by itself; vertices keep their order."""
    order = np.argsort(domain, kind="stable")
    triangles, region, domain = triangles[order], region[order], domain[order]
    starts = np.searchsorted(domain, numbers)
    ends = np.searchsorted(domain, numbers, side="right")
    parts = []
    for start, end in zip(starts, ends, strict=True):
        used, local = np.unique(triangles[start:end], return_inverse=True)
        parts.append((vertices[used], local.reshape(-1, 3), region[start:end]))
    return parts
