"""Regions to meshes (paper, Algorithms 5 and 6): a coarse mesh, then finer ones level by level, each improved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arcs import Arcs
from .assembly import mean_edge_lengths, mesh_cells, wanted_edge_lengths
from .bridges import bridge_holes
from .coarsening import MOST_LEVELS, Coarsening, coarsen
from .division import divide
from .gradation import Target
from .refinement import refine
from .remeshing import improve
from .sizing import grade_from_edges
from .steps import Steps, within
from .stopwatch import Stopwatch


@dataclass(frozen=True)
class Regions:
    """What loops bound: polygons (k, 2), simple and counter-clockwise, that do not meet, with vertices as wanted.

    region: (l,) the number of the outer contour around each loop, its own for an outer one; is_hole: (l,) bool; domain:
    (l,) the number that the target knows each loop's domain by.
    """

    loops: list[np.ndarray]
    region: np.ndarray
    is_hole: np.ndarray
    domain: np.ndarray

    def of_domains(self, numbers: np.ndarray) -> tuple[Regions, np.ndarray]:
        """The regions of some domains by themselves, and the numbers of their loops here."""
        rows = np.flatnonzero(np.isin(self.domain, numbers))
        region = np.searchsorted(rows, self.region[rows])
        return Regions([self.loops[row] for row in rows], region, self.is_hole[rows], self.domain[rows]), rows


@dataclass(frozen=True)
class RegionMeshes:
    """vertices: (n, 2); triangles: (m, 3); region: (m,) of each triangle; fallbacks: (l,) by region."""

    vertices: np.ndarray
    triangles: np.ndarray
    region: np.ndarray
    fallbacks: np.ndarray


def mesh_by_levels(
    regions: Regions, target: Target, corner_angle: float, passes: int, watch: Stopwatch, most: np.ndarray | None = None
) -> Steps[RegionMeshes]:
    """Mesh regions.

    corner_angle: in radians; passes: of relaxation; most: (d,) levels that each domain may have, at first as many as it
    can. Where a level's boundary does not fit the coarser mesh, the domain starts again with a level less.
    """
    if most is None:
        most = np.full(len(target.most), MOST_LEVELS)
    with watch("coarsening"):
        coarsening = coarsen(regions.loops, regions.is_hole, regions.domain, target, corner_angle, most)
    meshes, failed = yield from within(_mesh_levels(regions, coarsening, passes, watch), 0.0, 0.9)
    if not len(failed):
        return meshes
    again, loops = regions.of_domains(failed)
    most = np.where(np.isin(np.arange(len(most)), failed), coarsening.levels - 1, most)
    more = yield from within(mesh_by_levels(again, target, corner_angle, passes, watch, most), 0.9, 1.0)
    stay = ~np.isin(regions.domain[meshes.region], failed)
    fallbacks = np.where(np.isin(regions.domain, failed), 0, meshes.fallbacks)
    fallbacks[loops] += more.fallbacks
    return RegionMeshes(
        np.concatenate([meshes.vertices, more.vertices]),
        np.concatenate([meshes.triangles[stay], more.triangles + len(meshes.vertices)]),
        np.concatenate([meshes.region[stay], loops[more.region]]),
        fallbacks,
    )


def _mesh_levels(
    regions: Regions, coarsening: Coarsening, passes: int, watch: Stopwatch
) -> Steps[tuple[RegionMeshes, np.ndarray]]:
    """The meshes, and the domains that failed on the way and have none."""
    top, domain = coarsening.top, regions.domain
    # A level has about four times as many elements as the one before.
    ends = 0.25 ** np.arange(top, -1, -1.0)
    meshes, failed = (yield from within(_mesh_coarse(regions, coarsening, watch), 0.0, ends[0] / 2)), []
    vertices, triangles, region, fallbacks = meshes.vertices, meshes.triangles, meshes.region, meshes.fallbacks
    number = np.flatnonzero(coarsening.level >= top)
    for level in range(top, -1, -1):
        middle, end = 0.5 * ends[top - level], ends[top - level]
        number = np.concatenate([number, np.full(len(vertices) - len(number), -1)])
        coarse, fine = coarsening.level >= level + 1, coarsening.level >= level
        arcs = Arcs(coarsening.points, coarsening.size, coarse, fine, number) if level < top else None
        sizing = grade_from_edges(coarsening.loops(level), regions.region, _Wanted(coarsening, level, domain))
        refined = yield from within(refine(vertices, triangles, region, sizing, watch, arcs), end / 4, middle)
        np.add.at(fallbacks, region, refined.fallbacks)
        number = refined.number if arcs else number
        failed.append(np.unique(domain[refined.failed]))
        stay = ~np.isin(domain[region[refined.parent]], failed[-1])
        triangles, region = refined.triangles[stay], region[refined.parent][stay]
        if not len(triangles):
            vertices = refined.vertices
            continue
        improvement = improve(refined.vertices, triangles, region, passes, watch)
        vertices, triangles, region, more = yield from within(improvement, middle, end)
        fallbacks[: len(more)] += more
    return RegionMeshes(vertices, triangles, region, fallbacks), np.concatenate(failed)


@dataclass(frozen=True)
class _Wanted:
    """The edge length wanted at a level, at points (n, 2) of regions (n,)."""

    coarsening: Coarsening
    level: int
    domain: np.ndarray

    def __call__(self, points: np.ndarray, region: np.ndarray) -> np.ndarray:
        return self.coarsening.wanted(self.level, points, self.domain[region])


def _mesh_coarse(regions: Regions, coarsening: Coarsening, watch: Stopwatch) -> Steps[RegionMeshes]:
    """The mesh of the coarsest level, whose boundary's vertices come first."""
    top, target = coarsening.top, coarsening.target
    with watch("division"):
        wanted = _Wanted(coarsening, top, regions.domain)
        longest = target.most[regions.domain] * 2.0 ** coarsening.levels[regions.domain]
        varying = None if target.constant and coarsening.room is None else wanted
        points, polygons = bridge_holes(coarsening.loops(top), regions.region, regions.is_hole, longest, varying)
        division = divide(points, polygons, longest, varying)
        if varying is None:
            lengths = mean_edge_lengths(division.points, division.cells)
        else:
            lengths = wanted_edge_lengths(division.points, division.cells, division.owner, wanted)
    vertices, triangles, cell, fallbacks = yield from mesh_cells(division.points, division.cells, lengths, watch)
    fallbacks = np.bincount(division.owner, fallbacks, minlength=len(regions.loops)).astype(np.int64)
    return RegionMeshes(vertices, triangles, division.owner[cell].astype(np.int64), fallbacks)
