"""The numbers to reach, beside the paper's and what was measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .groups import Groups, group, mean_and_spread
from .stages import FLIPPED, GMSH, GMSH_CDT, NN2, NN3, OURS, SMOOTHED, TABLES, TEACHER, Results

ENOUGH = 200  # contours that a group must have to be the worst,
ENOUGH_CLOSE = 50  # and of those contours that the teacher had
BINS = 0.1  # of target edge lengths


@dataclass(frozen=True)
class Goal:
    """A line of the table of goals: ``value`` is to be at most ``limit``."""

    what: str
    paper: str
    limit: float
    value: float
    form: str = "{:+.1f} %"  # of limit and value
    detail: str = ""

    def cells(self) -> list[str]:
        """A row of the table: what, paper, goal, measured, reached."""
        first = [self.what, self.paper, f"≤ {self.form.format(self.limit)}"]
        if np.isnan(self.value):
            return [*first, "too few contours", ""]
        return [*first, self.form.format(self.value) + self.detail, "yes" if self.value <= self.limit else "**no**"]


def error_groups(results: Results, mesher: str, reference: str) -> tuple[Groups, Groups]:
    """ē_worst and ē_mean, in per cent, by N_C and the reference's N_I."""
    error = 100 * results.error(mesher, reference)
    worst, mean = (group(results.n_contour, results.n_inner[reference], column) for column in error.T)
    return worst, mean


def count_groups(results: Results, reference: str) -> Groups:
    """NN1's mean absolute error, against a reference's number of inner vertices, by N_C and l_s (bins' lower ends)."""
    bins = np.round(np.floor(results.l_s / BINS + 1e-9) * BINS, 6)
    return group(results.n_contour, bins, np.abs(results.wanted - results.n_inner[reference]))


def goals(sets: dict[str, Results], table_time: float) -> list[Goal]:
    """All lines; sets: sector contours first; table_time: milliseconds a connection table."""
    sector = next(iter(sets.values()))
    total = sum(map(len, sets.values()))
    valid = [
        np.logical_and.reduce([found.valid[name] for name in (OURS, FLIPPED, SMOOTHED)]) for found in sets.values()
    ]
    invalid = total - sum(int(rows.sum()) for rows in valid)
    fallbacks = 100 * float((sector.fallbacks > 0).mean())
    teacher = max(_deviation(results, TEACHER) - _deviation(results, GMSH) for results in sets.values())
    whole, placed, connected, calculated = (
        error_groups(sector, *pair) for pair in ((OURS, GMSH), (NN2, GMSH), (NN3, TEACHER), (TABLES, GMSH_CDT))
    )
    counts = count_groups(sector, TEACHER)
    return [
        _mean("whole scheme against Gmsh Delaunay, ē_worst", sector, OURS, 0, -5),
        _worst("the same, worst (N_C, N_I) group", "+27.3 %", whole[0], 5),
        _mean("the same, ē_mean", sector, OURS, 1, 0),
        _worst("the same, ē_mean, worst group", "+15.2 %", whole[1], 2),
        _worst(
            f"NN1, mean absolute error, worst (N_C, l_s) cell; {_above(counts, 0.7)} are above 0.7",
            "1.5",
            counts,
            0.7,
            1,
            "{:.2f}",
        ),
        _worst("NN2 alone, ē_worst, worst group", "+23.4 %", placed[0], 3),
        _worst(
            "NN3 alone on the teacher's vertices, ē_worst, worst group of 50 contours",
            "+24.0 %",
            connected[0],
            2,
            ENOUGH_CLOSE,
        ),
        _worst("calculated tables, ē_worst, worst group", "+1.9 %", calculated[0], 1, form="{:+.2f} %"),
        _worst("calculated tables, ē_mean, worst group", "+1.5 %", calculated[1], 0.5, form="{:+.2f} %"),
        Goal(
            f"invalid meshes in {total:,} contours of all sets, also after flips or smoothing",
            "—",
            0,
            invalid,
            "{:.0f}",
        ),
        Goal("sector contours with fallbacks", "—", 0.1, fallbacks, "{:.2f} %"),
        _mean("whole scheme and smoothing, ē_worst", sector, SMOOTHED, 0, -10),
        Goal("teacher's edge-length deviation less Gmsh's, largest of the sets", "—", 0, teacher, "{:+.3f}"),
        Goal("a connection table of 16 edges and 12 inner vertices", "—", 5, table_time, "{:.1f} ms"),
    ]


def _mean(what: str, results: Results, mesher: str, column: int, limit: float) -> Goal:
    mean, spread = mean_and_spread(100 * results.error(mesher, GMSH)[:, column])
    return Goal(f"{what}, mean", "—", limit, mean, detail=f" ± {spread:.1f}")


def _worst(
    what: str, paper: str, groups: Groups, limit: float, at_least: int = ENOUGH, form: str = "{:+.1f} %"
) -> Goal:
    # Where nothing is inserted, there is nothing to get wrong.
    found = groups.without(0).worst(at_least)
    if found is None:
        return Goal(what, paper, limit, np.nan, form)
    row, column, mean, spread = found
    return Goal(what, paper, limit, mean, form, f" ± {spread:.2f} ({row:g}, {column:g})")


def _above(groups: Groups, limit: float) -> str:
    """How many of the cells are above a limit."""
    return f"{np.count_nonzero(groups.mean > limit)} of {np.count_nonzero(groups.count)} cells"


def _deviation(results: Results, mesher: str) -> float:
    return float(results.measures[mesher][results.is_comparable, 3].mean())
