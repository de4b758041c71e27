"""A batch of domains to meshes: the whole way from curves to what `tessera.mesh` returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import radians

import numpy as np
from numpy.typing import ArrayLike

from .budget import MOST_TRIANGLES, checked_domain, checked_graph, enclosed_area
from .constraints import Domain, planar_domains
from .contour import clean_domains, edges_of, nesting
from .errors import ContourError
from .flips import flip_edges
from .gradation import Target, prepare
from .levels import RegionMeshes, mesh_by_levels
from .mesh import Mesh, make_mesh
from .notices import gap_warnings, long_edge_warnings, lost_area_warnings, repeated_warnings
from .outlines import Outlines, outlines_of, resampled
from .settings import Request, Settings
from .sizing import Limits, Sizing
from .smoothing import smooth_in_steps
from .steps import Progress, Steps, finish, within
from .stopwatch import Stopwatch


def mesh_domains(requests: Sequence[Request], settings: Settings) -> list[Mesh | ContourError]:
    """`domains_in_steps`, at once."""
    return finish(domains_in_steps(requests, settings))


def domains_in_steps(requests: Sequence[Request], settings: Settings) -> Steps[list[Mesh | ContourError]]:
    """Mesh many domains as one batch: a Mesh, or the ContourError that it has, for each.

    Raises ValueError for settings that are out of range.
    """
    settings.check()
    wanted, results = [], {}
    for number, request in enumerate(requests):
        try:
            wanted.append(request.checked(settings))
        except ContourError as error:
            results[number] = error
    numbers = [number for number in range(len(requests)) if number not in results]
    made = yield from _in_steps([requests[number].domain for number in numbers], wanted, settings)
    results |= dict(zip(numbers, made, strict=True))
    return [results[number] for number in range(len(requests))]


def _in_steps(
    domains: Sequence[Sequence[ArrayLike] | Domain], wanted: Sequence[tuple[Sizing | None, Limits]], settings: Settings
) -> Steps[list[Mesh | ContourError]]:
    """`domains_in_steps`, of domains with what is wanted in each."""
    corner_angle, watch = radians(settings.corner_angle), Stopwatch()
    with watch("contours"):
        cleaned, planar = planar_domains(domains, clean_domains([() if isinstance(d, Domain) else d for d in domains]))
        nested = [nesting([] if isinstance(d, ContourError) or n in planar else d) for n, d in enumerate(cleaned)]
        longest = [limits.longest for _, limits in wanted]
        results = [
            checked_graph(planar[n], longest[n]) if n in planar else checked_domain(d, nested[n], longest[n])
            for n, d in enumerate(cleaned)
        ]
    yield Progress("contours", 0.02)
    with watch("sizing"):
        sound = {number: result for number, result in enumerate(results) if not isinstance(result, ContourError)}
        target, errors = prepare(sound, wanted, MOST_TRIANGLES)
        results = [errors.get(number, result) for number, result in enumerate(results)]
    yield Progress("sizing", 0.05)
    with watch("boundary"):
        numbers = [number for number, result in enumerate(results) if not isinstance(result, ContourError)]
        outlines = outlines_of(results, nested, planar, numbers)
        if settings.boundary == "resample":
            outlines = resampled(outlines, target, corner_angle)
        gaps = gap_warnings(*_segments(outlines), target)
    if numbers:
        meshes = yield from within(_finished(outlines, target, corner_angle, settings, watch), 0.1, 1.0)
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
    outlines: Outlines, target: Target, corner_angle: float, settings: Settings, watch: Stopwatch
) -> Steps[RegionMeshes]:
    """The regions' meshes, after the passes that were asked for."""
    end = 0.8 if settings.smooth else 1.0
    meshing = mesh_by_levels(outlines, target, corner_angle, settings.passes, watch)
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
