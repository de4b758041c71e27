"""What is found on test contours: every mesher's measures of each contour.

All contours have everything but the teacher, which takes ten times as long as all others together, what needs its
meshes, and Gmsh Frontal-Delaunay: those have the *close* contours only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tessera.flips import flip_edges
from tessera.scheme import mesh_contours
from tessera.smoothing import smooth
from tessera.stopwatch import Stopwatch

from . import meshers
from .meshes import MEASURES, Meshes, are_valid, measure, only_valid
from .sets import Contours

# Meshers, by what they are called in the report.
OURS, FLIPPED, SMOOTHED = "Tessera", "Tessera, flips", "Tessera, smoothed"
GMSH, FRONTAL, TEACHER = "Gmsh Delaunay", "Gmsh Frontal-Delaunay", "teacher"
# Stages alone, and the triangulations that they are compared with.
NN2, NN3, NN3_GMSH, TABLES = "NN2 alone", "NN3 alone", "NN3 alone on Gmsh's vertices", "calculated tables"
GMSH_CDT, TEACHER_CDT = "CDT of Gmsh's vertices", "CDT of the teacher's vertices"
MESHERS = (OURS, FLIPPED, SMOOTHED, GMSH, FRONTAL, TEACHER)


@dataclass(frozen=True)
class Results:
    """What was found on B contours."""

    n_contour: np.ndarray  # (B,) int64
    l_s: np.ndarray  # (B,) float64
    wanted: np.ndarray  # (B,) int64, NN1's number of inner vertices
    is_close: np.ndarray  # (B,) bool, whether the teacher had them
    fallbacks: np.ndarray  # (B,) int64, elements of `OURS` that NN3 had no say in
    valid: dict[str, np.ndarray]  # by mesher, (B,) bool
    n_inner: dict[str, np.ndarray]  # by mesher, (B,) float64, NaN where it has no valid mesh
    measures: dict[str, np.ndarray]  # by mesher, (B, 4) float64, as `meshes.MEASURES`, NaN where it has no valid mesh

    def __len__(self) -> int:
        return len(self.n_contour)

    @property
    def is_comparable(self) -> np.ndarray:
        """(B,) bool, whether all of `MESHERS` have a valid mesh."""
        return np.logical_and.reduce([self.valid[name] for name in MESHERS])

    def error(self, mesher: str, reference: str) -> np.ndarray:
        """(B, 2) e_worst and e_mean of a mesher's meshes against the reference's, NaN where one has none."""
        theirs = self.measures[reference][:, :2]
        return (theirs - self.measures[mesher][:, :2]) / theirs


def find(contours: Contours, is_close: bool, steps: int) -> Results:
    """Mesh contours by all meshers, if close also by the teacher; steps: of smoothing."""
    scheme = mesh_contours(contours.points, contours.n_contour, contours.l_s, Stopwatch())
    ours = meshers.of_scheme(contours, scheme)
    gmsh = only_valid(meshers.by_gmsh(contours), contours)
    made = {
        OURS: ours,
        FLIPPED: _with_triangles(ours, flip_edges(ours.points.reshape(-1, 2), ours.flat)),
        SMOOTHED: _smoothed(ours, steps),
        GMSH: gmsh,
        NN2: meshers.by_placement(contours, gmsh.n_inner),
        NN3_GMSH: meshers.by_connection(contours, gmsh.points, gmsh.n_inner),
        TABLES: meshers.by_calculation(contours, gmsh.points, gmsh.n_inner),
        GMSH_CDT: meshers.by_delaunay(contours, gmsh.points, gmsh.n_inner),
    }
    if is_close:
        taught = only_valid(meshers.by_teacher(contours), contours)
        made |= {
            FRONTAL: meshers.by_gmsh(contours, meshers.FRONTAL),
            TEACHER: taught,
            NN3: meshers.by_connection(contours, taught.points, taught.n_inner),
            TEACHER_CDT: meshers.by_delaunay(contours, taught.points, taught.n_inner),
        }
    valid = {name: are_valid(meshes, contours) for name, meshes in made.items()}
    return Results(
        contours.n_contour,
        contours.l_s,
        scheme.wanted,
        np.full(len(contours), is_close),
        scheme.fallbacks,
        valid,
        {name: np.where(valid[name], meshes.n_inner, np.nan) for name, meshes in made.items()},
        {name: np.where(valid[name][:, None], measure(m, contours.l_s), np.nan) for name, m in made.items()},
    )


def _with_triangles(meshes: Meshes, flat: np.ndarray) -> Meshes:
    """The same vertices with other triangles, of vertices in one array."""
    width = meshes.points.shape[1]
    return Meshes(meshes.points, meshes.n_contour, meshes.n_inner, flat - meshes.owner[:, None] * width, meshes.owner)


def _smoothed(meshes: Meshes, steps: int) -> Meshes:
    points = smooth(meshes.points.reshape(-1, 2), meshes.flat, steps, meshes.owner).reshape(meshes.points.shape)
    return Meshes(points, meshes.n_contour, meshes.n_inner, meshes.triangles, meshes.owner)


def join(parts: Sequence[Results]) -> Results:
    """Results of several batches of one set, filled up with NaN where a mesher had only close ones."""
    names = list(dict.fromkeys(name for part in parts for name in part.measures))
    plain = ("n_contour", "l_s", "wanted", "is_close", "fallbacks")

    def column(what: str, name: str, missing: np.ndarray) -> np.ndarray:
        return np.concatenate([getattr(part, what).get(name, np.repeat(missing, len(part), axis=0)) for part in parts])

    return Results(
        *(np.concatenate([getattr(part, what) for part in parts]) for what in plain),
        {name: column("valid", name, np.zeros(1, dtype=bool)) for name in names},
        {name: column("n_inner", name, np.full(1, np.nan)) for name in names},
        {name: column("measures", name, np.full((1, len(MEASURES)), np.nan)) for name in names},
    )
