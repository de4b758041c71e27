"""Domains to meshes: the whole way from a user's curves to what `tessera.mesh` returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from .budget import MOST_TRIANGLES, checked_domain, checked_graph, enclosed_area
from .constraints import Domain, planar_domains
from .contour import clean_domains, clean_loop, edges_of, nesting
from .errors import ContourError
from .flips import flip_edges
from .gradation import Target, prepare
from .levels import RegionMeshes, mesh_by_levels
from .mesh import Mesh, make_mesh
from .notices import gap_warnings, long_edge_warnings, lost_area_warnings, repeated_warnings
from .outlines import Outlines, outlines_of, resampled
from .paper import roles_named
from .placement import MOST_INNER
from .scheme import LARGEST_CONTOUR, join_vertices, mesh_contours
from .settings import Settings
from .sizing import Limits, Sizing, checked_edge_length
from .smoothing import checked_steps, smooth_in_steps
from .smoothing import smooth as move_downhill
from .steps import Progress, Steps, finish, within
from .stopwatch import Stopwatch


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
    passes: int = 3,
    flips: bool = False,
    smooth: int = 0,
) -> Mesh:
    """Mesh one domain: the planar region that closed curves bound.

    loops: (k, 2) arrays, in any winding and order: outer contours, holes and islands in them by the even-odd rule.
    edge_length: the target, in the loops' unit. boundary: "resample" places vertices on the given polylines at the
    target edge length, keeping their corners, which turn by more than corner_angle degrees; "keep" keeps exactly the
    given vertices and adds none on the contour. passes: how often in a row NN2 is asked for better places of all inner
    vertices; 0 makes a draft, whose poor patches are not meshed again either. flips: a last pass exchanges edges where
    that raises the worse quality of the two elements beside them. smooth: how often every inner vertex may move after
    that, to better the poorest elements.

    points: (p, 2), inside the domain, that must be vertices of the mesh. lines: polylines (k, 2), closed if they end
    where they start, whose course must be edges of the mesh; their vertices are placed as those of the contours. They
    may end at contours and at each other, and share vertices, but they cross nothing.

    sizing: asks for shorter targets than edge_length: a number; a function that takes points (n, 2) in the domain and
    gives lengths (n,); `by_curvature`, `by_thickness`, `by_distance`, `from_values`; or the `smallest` of several. No
    target is shorter than min_edge_length, and from one element to the next it changes by no more than the factor
    gradation.

    Contours that touch in vertices, or outside of each other along edges, to 1e-6 of the size of all, are meshed with a
    common boundary there, and a warning. The mesh's region is the number of the outer contour around each triangle.

    Raises ContourError, whose ``reason`` is a short word, for input that cannot be meshed, and a plain ValueError for
    what is no sequence of (k, 2) arrays of numbers.
    """
    settings = Settings(sizing, min_edge_length, gradation, boundary, corner_angle, passes, flips, smooth)
    return finish(_one_in_steps(_domain(loops, points, lines), edge_length, settings))


def mesh_in_steps(
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
    passes: int = 3,
    flips: bool = False,
    smooth: int = 0,
) -> Steps[Mesh]:
    """What `mesh` does, as a generator: it yields a `Progress` several times a second, and returns the Mesh.

    Closing the generator stops the work. Raises as `mesh` does, when it comes to it.
    """
    settings = Settings(sizing, min_edge_length, gradation, boundary, corner_angle, passes, flips, smooth)
    return _one_in_steps(_domain(loops, points, lines), edge_length, settings)


def _domain(
    loops: Sequence[ArrayLike], points: ArrayLike | None, lines: Sequence[ArrayLike]
) -> Sequence[ArrayLike] | Domain:
    """What `domains_in_steps` takes."""
    loops, lines = list(loops), list(lines)
    return Domain(loops, None, points, lines) if points is not None or len(lines) > 0 else loops


def _one_in_steps(domain: Sequence[ArrayLike] | Domain, edge_length: float, settings: Settings) -> Steps[Mesh]:
    (result,) = yield from domains_in_steps([domain], edge_length, settings)
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
    passes: int = 3,
    flips: bool = False,
    smooth: int = 0,
) -> Mesh:
    """Mesh several regions as one: where they share edges, or parts of them, they have the same vertices.

    regions: domains as of `mesh`, that do not overlap. A vertex of one that is nearer to an edge of another than 1e-6
    of the size of all lies on it. The mesh's region is the number of the region that each triangle is part of. All else
    is as of `mesh`. Raises ContourError, "overlap" for regions that overlap.
    """
    settings = Settings(sizing, min_edge_length, gradation, boundary, corner_angle, passes, flips, smooth)
    regions = [list(region) for region in regions]
    loops = [loop for region in regions for loop in region]
    of = [number for number, region in enumerate(regions) for _ in region]
    return finish(_one_in_steps(Domain(loops, of, points, lines), edge_length, settings))


def mesh_many(
    domains: Sequence[Sequence[ArrayLike]],
    edge_length: float,
    *,
    sizing: Sizing | None = None,
    min_edge_length: float | None = None,
    gradation: float = 1.3,
    corner_angle: float = 32.0,
    passes: int = 3,
    flips: bool = False,
    smooth: int = 0,
) -> list[Mesh | ContourError]:
    """Mesh a batch of domains, each as `mesh` does: a Mesh, or the ContourError that it has, for each.

    Raises ContourError "edge-length" where no domain could be meshed at that length.
    """
    settings = Settings(sizing, min_edge_length, gradation, "resample", corner_angle, passes, flips, smooth)
    return mesh_domains([list(loops) for loops in domains], edge_length, settings)


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
    domains: Sequence[Sequence[ArrayLike] | Domain], edge_length: float, settings: Settings
) -> list[Mesh | ContourError]:
    """`domains_in_steps`, at once."""
    return finish(domains_in_steps(domains, edge_length, settings))


def domains_in_steps(
    domains: Sequence[Sequence[ArrayLike] | Domain], edge_length: float, settings: Settings
) -> Steps[list[Mesh | ContourError]]:
    """Mesh many domains as one batch: a Mesh, or the ContourError that it has, for each."""
    sizing, limits = settings.checked(edge_length)
    watch = Stopwatch()
    with watch("contours"):
        cleaned, planar = planar_domains(domains, clean_domains([() if isinstance(d, Domain) else d for d in domains]))
        nested = [nesting([] if isinstance(d, ContourError) or n in planar else d) for n, d in enumerate(cleaned)]
        results = [
            checked_graph(planar[n], limits.longest) if n in planar else checked_domain(d, nested[n], limits.longest)
            for n, d in enumerate(cleaned)
        ]
    yield Progress("contours", 0.02)
    with watch("sizing"):
        sound = {number: result for number, result in enumerate(results) if not isinstance(result, ContourError)}
        target, errors = prepare(sound, sizing, limits, MOST_TRIANGLES)
        results = [errors.get(number, result) for number, result in enumerate(results)]
    yield Progress("sizing", 0.05)
    with watch("boundary"):
        numbers = [number for number, result in enumerate(results) if not isinstance(result, ContourError)]
        outlines = outlines_of(results, nested, planar, numbers)
        if settings.boundary == "resample":
            outlines = resampled(outlines, target, limits.corner_angle)
        gaps = gap_warnings(*_segments(outlines), target)
    if numbers:
        meshes = yield from within(_finished(outlines, target, limits, settings, watch), 0.1, 1.0)
        domain, first = outlines.domains, outlines.firsts
        fell = np.bincount(domain, meshes.fallbacks, minlength=len(results)).astype(int)
        parts = _parts(meshes, domain[meshes.region], numbers)
        for number, (part, elements, region) in zip(numbers, parts, strict=True):
            one, places = planar.get(number), target.inside(number)
            if settings.boundary == "keep":
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


def _segments(outlines: Outlines) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Start and end (s, 2) of what has vertices before meshing, edges and points alone, and the domain of each (s,)."""
    (start, end, of), (points, home) = outlines.edges(), outlines.points()
    domain = outlines.domains[np.concatenate([of, home])]
    return np.concatenate([start, points]), np.concatenate([end, points]), domain


def _finished(
    outlines: Outlines, target: Target, limits: Limits, settings: Settings, watch: Stopwatch
) -> Steps[RegionMeshes]:
    """The regions' meshes, after the passes that were asked for."""
    end = 0.8 if settings.smooth else 1.0
    meshing = mesh_by_levels(outlines, target, limits.corner_angle, settings.passes, watch)
    meshes = yield from within(meshing, 0.0, end)
    vertices, triangles = meshes.vertices, meshes.triangles
    if settings.flips:
        with watch("flips"):
            triangles = flip_edges(vertices, triangles, meshes.fixed)
    if settings.smooth:
        smoothing = smooth_in_steps(vertices, triangles, settings.smooth, meshes.region, watch, meshes.fixed)
        vertices = yield from within(smoothing, end, 1.0)
    return replace(meshes, vertices=vertices, triangles=triangles)


def _parts(
    meshes: RegionMeshes, domain: np.ndarray, numbers: list[int]
) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """The vertices, the triangles and their regions of each domain by itself; vertices keep their order."""
    order = np.argsort(domain, kind="stable")
    triangles, region, domain = meshes.triangles[order], meshes.region[order], domain[order]
    starts = np.searchsorted(domain, numbers)
    ends = np.searchsorted(domain, numbers, side="right")
    parts = []
    for start, end in zip(starts, ends, strict=True):
        used, local = np.unique(triangles[start:end], return_inverse=True)
        parts.append((meshes.vertices[used], local.reshape(-1, 3), region[start:end]))
    return parts
