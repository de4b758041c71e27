"""What a user calls: curves to a mesh, of one domain, of regions that share edges, of a batch, of one contour."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .constraints import Domain
from .contour import clean_loop, edges_of
from .domains import domains_in_steps, mesh_domains
from .errors import ContourError
from .mesh import Mesh, make_mesh
from .notices import long_edge_warnings
from .paper import roles_named
from .placement import MOST_INNER
from .scheme import LARGEST_CONTOUR, join_vertices, mesh_contours
from .settings import Request, Settings
from .sizing import Sizing, checked_edge_length
from .smoothing import checked_steps
from .smoothing import smooth as move_downhill
from .steps import Steps, finish
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
    target edge length, keeping their corners, which turn by more than corner_angle degrees (of those nearer to each
    other than a twentieth of the target, one); "keep" keeps exactly the given vertices and adds none on the contour.
    passes: how often in a row NN2 is asked for better places of all inner vertices; 0 makes a draft, whose poor patches
    are not meshed again either. flips: a last pass exchanges edges where that raises the worse quality of the two
    elements beside them. smooth: how often every inner vertex may move after that, to better the poorest elements.

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
    request = Request(_domain(loops, points, lines), edge_length, sizing, min_edge_length)
    return finish(_one_in_steps(request, Settings(gradation, boundary, corner_angle, passes, flips, smooth)))


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
    request = Request(_domain(loops, points, lines), edge_length, sizing, min_edge_length)
    return _one_in_steps(request, Settings(gradation, boundary, corner_angle, passes, flips, smooth))


def _domain(
    loops: Sequence[ArrayLike], points: ArrayLike | None, lines: Sequence[ArrayLike]
) -> Sequence[ArrayLike] | Domain:
    """What `domains_in_steps` takes."""
    loops, lines = list(loops), list(lines)
    return Domain(loops, None, points, lines) if points is not None or len(lines) > 0 else loops


def _one_in_steps(request: Request, settings: Settings) -> Steps[Mesh]:
    (result,) = yield from domains_in_steps([request], settings)
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
    regions = [list(region) for region in regions]
    loops = [loop for region in regions for loop in region]
    of = [number for number, region in enumerate(regions) for _ in region]
    request = Request(Domain(loops, of, points, lines), edge_length, sizing, min_edge_length)
    return finish(_one_in_steps(request, Settings(gradation, boundary, corner_angle, passes, flips, smooth)))


def mesh_many(
    domains: Sequence[Sequence[ArrayLike]],
    edge_length: float | Sequence[float],
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

    edge_length: one for all domains, or one for each. Raises ContourError "edge-length" where no domain could be meshed
    at the one, ValueError where there is not one for each.
    """
    domains = [list(loops) for loops in domains]
    settings = Settings(gradation, "resample", corner_angle, passes, flips, smooth)
    if np.ndim(edge_length) == 0:
        Request((), edge_length, sizing, min_edge_length).checked(settings)
        edge_length = [edge_length] * len(domains)
    if len(edge_length) != len(domains):
        raise ValueError(f"there are {len(domains)} domains and {len(edge_length)} edge lengths: give one for each")
    pairs = zip(domains, edge_length, strict=True)
    return mesh_domains([Request(domain, length, sizing, min_edge_length) for domain, length in pairs], settings)


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
