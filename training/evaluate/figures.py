"""The paper's figures of errors by numbers of edges and of inner vertices: what is compared with what in each."""

from __future__ import annotations

from dataclasses import dataclass

from .goals import ENOUGH, ENOUGH_CLOSE
from .stages import GMSH, GMSH_CDT, NN2, NN3, NN3_GMSH, OURS, TABLES, TEACHER, TEACHER_CDT


@dataclass(frozen=True)
class Stage:
    """A part of the scheme, or the whole, by N_C and N_I."""

    name: str  # of the picture
    figure: int  # of the paper
    mesher: str
    against: str
    title: str
    paper: dict[tuple[int, int], float]  # ē_worst in per cent of the groups (N_C, N_I) that the paper's text names
    enough: int = ENOUGH  # contours of a group that counts


STAGES = (
    Stage("scheme", 27, OURS, GMSH, "The whole scheme, against Gmsh Delaunay", {(16, 18): 27.3, (10, 8): 19.4}),
    Stage(
        "nn2",
        22,
        NN2,
        GMSH,
        "NN2 alone: given Gmsh's number of vertices, its places connected by CDT, against Gmsh Delaunay",
        {(12, 14): 23.41, (6, 1): 1.6, (6, 2): 10.5, (10, 8): 17.3},
    ),
    Stage(
        "tables",
        24,
        TABLES,
        GMSH_CDT,
        "The triangulation with calculated tables: on Gmsh's vertices, against CDT of them",
        {(14, 10): 1.9},
    ),
    Stage(
        "nn3",
        25,
        NN3,
        TEACHER,
        "NN3 alone: on the teacher's vertices, against the teacher's mesh",
        {},
        ENOUGH_CLOSE,
    ),
    Stage(
        "nn3_cdt",
        25,
        NN3,
        TEACHER_CDT,
        "NN3 alone: on the teacher's vertices, against CDT of them",
        {},
        ENOUGH_CLOSE,
    ),
    Stage(
        "nn3_gmsh",
        25,
        NN3_GMSH,
        GMSH_CDT,
        "NN3 alone: on Gmsh's vertices, against CDT of them, as in the paper",
        {(8, 12): 24.04, (10, 8): 10, (12, 6): 10.7, (12, 8): 8, (12, 10): 3.6, (12, 12): 13},
    ),
)
