"""The numbers to reach, beside the paper's, ours and Gmsh's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .cases import Case
from .growth import LARGE, Circle, exponents
from .invalid import REFUSED, VALID, Outcomes
from .measures import LONGEST, SHORTEST, Measures
from .meshers import DELAUNAY, FRONTAL, MESHERS, OURS

Results = list[tuple[Case, dict[str, Measures]]]
LEAST_SHARE = 90  # per cent of inner edges as long as they should be
MEAN_MARGIN, LEAST_PART = 0.01, 80  # q_mean may fall short of Frontal-Delaunay's; per cent of domains
MOST_BYTES = 2e9
_TIE = 1e-9  # qualities that a boundary forces on all meshers differ in their last bits


@dataclass(frozen=True)
class Goal:
    """A line of the table of goals: paper, goal, ours, Gmsh Delaunay's, Gmsh Frontal-Delaunay's."""

    what: str
    paper: str
    wanted: str
    ours: str
    delaunay: str
    frontal: str
    reached: bool

    def cells(self) -> list[str]:
        """As cells of a row."""
        measured = [self.ours, self.delaunay, self.frontal]
        return [self.what, self.paper, self.wanted, *measured, "met" if self.reached else "**missed**"]


def quality_goals(results: Results) -> list[Goal]:
    """The three domains of the paper, then the others together, then edge lengths."""
    own = [goal for case, found in results if case.goal for goal in _of_case(case, found)]
    others = [found for case, found in results if not case.goal]
    what = f"{len(others)} glyphs and outlines"
    mean = [{mesher: m.q_mean - found[FRONTAL].q_mean for mesher, m in found.items()} for found in others]
    least = [min(one[mesher] for one in mean) for mesher in MESHERS]
    lines = [
        Goal(
            f"{what}: q_mean less Gmsh Frontal-Delaunay's, at worst",
            "—",
            f"≥ {-MEAN_MARGIN:g}",
            *(f"{value:+.4f}" for value in least),
            least[0] >= -MEAN_MARGIN,
        )
    ]
    for reference in (FRONTAL, DELAUNAY):
        parts = [_no_worse(others, mesher, reference) for mesher in MESHERS]
        cells = [f"{part:.0f} %" for part in parts]
        wanted = f"≥ {LEAST_PART} % of them"
        title = f"{what}: q_worst no worse than {reference}'s"
        lines.append(Goal(title, "—", wanted, *cells, parts[0] >= LEAST_PART))
    return [*own, *lines, _edge_lengths(results)]


def _of_case(case: Case, found: dict[str, Measures]) -> list[Goal]:
    lines = []
    for number, measure in enumerate(("q_worst", "q_mean")):
        values = [getattr(found[mesher], measure) for mesher in MESHERS]
        wanted, digits = case.goal[number], 3 + number
        lines.append(
            Goal(
                f"{case.name}, {found[OURS].vertices} nodes: {measure}",
                f"{case.paper[number]:.2f}",
                f"≥ {wanted:g}",
                *(f"{value:.{digits}f}" for value in values),
                values[0] >= wanted,
            )
        )
    return lines


def _no_worse(results: list[dict[str, Measures]], mesher: str, reference: str) -> float:
    """Per cent of domains in which a mesher's worst element is no worse than another's."""
    return 100 * float(np.mean([found[mesher].q_worst >= found[reference].q_worst - _TIE for found in results]))


def _edge_lengths(results: Results) -> Goal:
    """The domain of the smallest share decides."""
    shares = [[found[mesher].share for _, found in results] for mesher in MESHERS]
    name = results[int(np.argmin(shares[0]))][0].name
    enough = sum(share >= LEAST_SHARE for share in shares[0])
    return Goal(
        f"inner edges within {SHORTEST} to {LONGEST} of the sizing function, in the worst of {len(results)} domains "
        f"({name}); {enough} reach it",
        "—",
        f"≥ {LEAST_SHARE} %",
        *(f"{min(part):.1f} %" for part in shares),
        min(shares[0]) >= LEAST_SHARE,
    )


def growth_goals(circles: list[Circle]) -> list[Goal]:
    """Time and memory of the large circle, and how the time grows."""
    large = max((circle for circle in circles if circle.triangles < 2 * LARGE), key=lambda circle: circle.triangles)
    what = f"circle of {large.triangles:,} triangles (Gmsh {large.their_triangles:,})"
    power, limit = exponents(circles)
    return [
        Goal(
            f"{what}: seconds of one core",
            "—",
            "≤ Gmsh Delaunay's",
            f"{large.seconds:.2f}",
            f"{large.their_seconds:.2f}",
            "—",
            large.seconds <= large.their_seconds,
        ),
        Goal(f"{what}: memory", "—", "≤ 2 GB", f"{large.peak / 1e9:.2f} GB", "—", "—", large.peak <= MOST_BYTES),
        Goal(
            f"power of n by which the time grows, to {max(circle.triangles for circle in circles):,} triangles",
            "—",
            f"≤ {limit:.2f}, that of n log n",
            f"{power:.2f}",
            "—",
            "—",
            power <= limit,
        ),
    ]


def validity_goal(outcomes: Outcomes) -> Goal:
    """Meshes that are not valid; none was made where meshing crashed, and none is to be refused."""
    count = sum(outcomes.kinds.values())
    bad = count - outcomes.kinds[VALID]
    refused = outcomes.kinds[REFUSED]
    what = f"invalid meshes, or none, in {count:,} random domains with up to 5 holes and 500 vertices"
    return Goal(what, "—", "0", f"{bad} ({refused} refused)" if bad else "0", "—", "—", bad == 0)
