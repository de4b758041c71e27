"""Regions to meshes (paper, Algorithms 5 and 6): a coarse mesh, then finer ones level by level, each improved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .assembly import mean_edge_lengths, mesh_cells, wanted_edge_lengths
from .coarsening import MOST_LEVELS, Coarsening, coarsen
from .division import divide
from .gradation import Target
from .outlines import Outlines
from .refinement import Sizing, refine
from .remeshing import improve
from .roles import SHIPPED, THOROUGH, Roles
from .sizing import grade_from_edges
from .steps import Progress, Steps, within
from .stopwatch import Stopwatch


@dataclass(frozen=True)
class RegionMeshes:
    """vertices: (n, 2); triangles: (m, 3); region: (m,) of each triangle; fallbacks: (r,) by region.

    fixed: (f, 2) edges that stay, a point by itself too, or None where there are none.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    region: np.ndarray
    fallbacks: np.ndarray
    fixed: np.ndarray | None


def mesh_by_levels(
    outlines: Outlines,
    target: Target,
    corner_angle: float,
    passes: int,
    watch: Stopwatch,
    most: np.ndarray | None = None,
) -> Steps[RegionMeshes]:
    """Mesh what outlines bound, with vertices as wanted.

    corner_angle: in radians; passes: of relaxation, 0 for no improvement, without which levels are of no use; most:
    (d,) levels that each domain may have, at first as many as it can. Where a level's boundary does not fit the coarser
    mesh, the domain starts again with a level less.
    """
    if most is None:
        most = np.full(len(target.most), MOST_LEVELS if passes else 0)
    with watch("coarsening"):
        coarsening = coarsen(outlines, target, corner_angle, most)
    yield Progress("coarsening", 0.0)
    parts, done, domains = [], 0.0, outlines.domains
    # Domains of as many levels together, and with one target or several, so that each goes the way it would alone.
    kind = 2 * coarsening.levels + target.constant
    for number in np.unique(kind[domains]):
        some, regions = coarsening.of_domains(np.flatnonzero(kind == number))
        end = done + len(regions) / len(domains)
        steps = _mesh_levels(some, passes, watch)
        meshes, failed = yield from within(steps, done, end)
        parts.append((meshes, regions))
        done = end
        if len(failed):
            again, _, regions = outlines.of_domains(failed)
            most = np.where(np.isin(np.arange(len(most)), failed), coarsening.levels - 1, most)
            steps = mesh_by_levels(again, target, corner_angle, passes, watch, most)
            parts.append(((yield from within(steps, done, done)), regions))
    return _join(parts, len(domains))


def _join(parts: list[tuple[RegionMeshes, np.ndarray]], n_regions: int) -> RegionMeshes:
    """The meshes of several parts, each with the numbers of its regions among all."""
    fallbacks, first = np.zeros(n_regions, dtype=np.int64), 0
    triangles, regions, fixed = [], [], []
    for meshes, rows in parts:
        triangles.append(meshes.triangles + first)
        regions.append(rows[meshes.region])
        fallbacks[rows] += meshes.fallbacks
        if meshes.fixed is not None:
            fixed.append(meshes.fixed + first)
        first += len(meshes.vertices)
    vertices = np.concatenate([meshes.vertices for meshes, _ in parts])
    together = np.concatenate(fixed) if fixed else None
    return RegionMeshes(vertices, np.concatenate(triangles), np.concatenate(regions), fallbacks, together)


def _mesh_levels(coarsening: Coarsening, passes: int, watch: Stopwatch) -> Steps[tuple[RegionMeshes, np.ndarray]]:
    """The meshes of domains that have as many levels each, and the domains that failed on the way and have none."""
    domain, together = coarsening.outlines.domains, coarsening.outlines.together()
    top = int(coarsening.levels[domain[0]])
    # A level has about four times as many elements as the one before.
    ends = 0.25 ** np.arange(top, -1, -1.0)
    # Without improvement, in haste, NN2's passes go over cells once.
    roles = THOROUGH if passes else SHIPPED
    meshes, number = yield from within(_mesh_coarse(coarsening, top, watch, roles), 0.0, ends[0] / 4)
    vertices, triangles, region, fallbacks = meshes.vertices, meshes.triangles, meshes.region, meshes.fallbacks
    fixed, failed = meshes.fixed, []
    for level in range(top, -1, -1):
        middle, end = (0.5 if passes else 1.0) * ends[top - level], ends[top - level]
        number = np.concatenate([number, np.full(len(vertices) - len(number), -1)])
        arcs = coarsening.arcs(level, number) if level < top else None
        sizing = _sizing(coarsening, level)
        # The regions of one graph fail together.
        refinement = refine(vertices, triangles, together[region], sizing, watch, arcs, fixed, roles)
        refined = yield from within(refinement, end / 4, middle)
        np.add.at(fallbacks, region, refined.fallbacks)
        number = refined.number if arcs else number
        fixed = refined.fixed
        failed.append(np.unique(domain[refined.failed]))
        fallbacks[np.isin(domain, failed[-1])] = 0
        stay = ~np.isin(domain[region[refined.parent]], failed[-1])
        vertices, triangles, region = refined.vertices, refined.triangles[stay], region[refined.parent][stay]
        if not len(triangles):
            break
        if passes:
            improvement = improve(vertices, triangles, region, sizing, passes, watch, fixed, level == 0)
            vertices, triangles, region, more = yield from within(improvement, middle, end)
            fallbacks[: len(more)] += more
    return RegionMeshes(vertices, triangles, region, fallbacks, fixed), np.concatenate(failed)


@dataclass(frozen=True)
class _Wanted:
    """The edge length wanted at a level, at points (n, 2) of regions (n,)."""

    coarsening: Coarsening
    level: int
    domain: np.ndarray

    def __call__(self, points: np.ndarray, region: np.ndarray) -> np.ndarray:
        return self.coarsening.wanted(self.level, points, self.domain[region])


def _sizing(coarsening: Coarsening, level: int) -> Sizing:
    """The edge length at points (n, 2) of regions (n,), the same for both sides of an edge between two regions."""
    outlines = coarsening.at_level(level)
    sizing = grade_from_edges(*outlines.edges(), _Wanted(coarsening, level, outlines.domains))
    if not outlines.graphs:
        return sizing
    together = outlines.together()
    return lambda points, region: sizing(points, together[region])


def _mesh_coarse(
    coarsening: Coarsening, top: int, watch: Stopwatch, roles: Roles
) -> Steps[tuple[RegionMeshes, np.ndarray]]:
    """The mesh of the coarsest level, and the number of the outlines' point that each of its vertices is, or -1."""
    target, outlines = coarsening.target, coarsening.at_level(top)
    domain = outlines.domains
    with watch("division"):
        wanted = _Wanted(coarsening, top, domain)
        varying = None if target.constant[domain[0]] and top == 0 else wanted
        points, polygons, given = outlines.polygons(target.most[domain] * 2.0**top, varying)
        division = divide(points, polygons, target.most[domain] * 2.0**top, varying)
        if varying is None:
            lengths = mean_edge_lengths(division.points, division.cells)
        else:
            lengths = wanted_edge_lengths(division.points, division.cells, division.owner, wanted)
    yield Progress("division", 0.0)
    meshing = mesh_cells(division.points, division.cells, lengths, watch, roles=roles)
    vertices, triangles, cell, fallbacks = yield from meshing
    fallbacks = np.bincount(division.owner, fallbacks, minlength=len(domain)).astype(np.int64)
    number = np.full(len(vertices), -1)
    number[given] = np.flatnonzero(coarsening.level >= top)
    fixed = given[outlines.staying()] if outlines.graphs else None
    return RegionMeshes(vertices, triangles, division.owner[cell].astype(np.int64), fallbacks, fixed), number
