"""Speed of the scheme beside the reference mesher's, on one core: ``python -m benchmarks.speed`` (`make bench`).

Prints the tables and writes them to ``benchmarks/results/speed.md``. Both meshers get the same contours in one process,
in turn; seconds are medians over the rounds.
"""

from __future__ import annotations

import datetime
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

import tessera
from tessera.boundary import resample_loops
from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch
from training import evaluate, reference

from . import contours, machine, memory

RESULTS = Path(__file__).parent / "results" / "speed.md"
BATCH, ROUNDS = 1_000, 7
LARGE_BATCH, SAMPLE, LARGE_ROUNDS = 100_000, 2_000, 3
SINGLE = 300
TARGETS = (0.1, 0.05)  # of a disk of radius 1


@dataclass(frozen=True)
class Goal:
    """A line of the table of goals."""

    what: str
    wanted: str
    found: str
    reached: bool

    def row(self) -> str:
        """As Markdown."""
        return f"| {self.what} | {self.wanted} | {self.found} | {'yes' if self.reached else '**no**'} |"


def in_turn(rounds: int, **calls: Callable[[Stopwatch], object]) -> list[dict[str, float]]:
    """For each call, median seconds of its stages and of the whole ("total"); the calls take turns."""
    found: list[list[dict[str, float]]] = [[] for _ in calls]
    for _ in range(rounds):
        for seconds, call in zip(found, calls.values(), strict=True):
            watch, start = Stopwatch(), time.perf_counter()
            call(watch)
            seconds.append(watch.seconds | {"total": time.perf_counter() - start})
    return [{stage: float(np.median([one[stage] for one in seconds])) for stage in seconds[0]} for seconds in found]


def by_reference(given: contours.Contours, watch: Stopwatch) -> None:
    """Gmsh's meshes of contours, one after the other."""
    for row, n, l_s in zip(*given, strict=True):
        reference.mesh(row[:n], l_s, watch)


def one_size() -> tuple[str, list[Goal]]:
    """A batch of contours of 16 edges and 12 inner vertices, by stage."""
    given = points, n_contour, _ = contours.sixteen_edges(BATCH)
    meshes = mesh_contours(*given, Stopwatch())
    quality, inner = evaluate.reference_meshes(*given)
    error = (quality - evaluate.qualities(points, meshes, n_contour)) / quality
    e_worst, e_mean = 100 * error.mean(axis=0)
    ours, theirs = in_turn(
        ROUNDS, ours=lambda watch: mesh_contours(*given, watch), theirs=lambda watch: by_reference(given, watch)
    )

    def row(name: str, seconds: float, triangles: int) -> str:
        return f"| {name} | {1e6 * seconds / BATCH:.0f} | {1e6 * seconds / triangles:.2f} |"

    n_ours, n_theirs = len(meshes.triangles), int((n_contour + 2 * inner - 2).sum())
    what = f"{BATCH:,} contours of 16 edges and 12 inner vertices"
    ratio, alone = theirs["total"] / ours["total"], 1e3 * ours["triangulation"] / BATCH
    text = [
        f"## {what}, in one batch",
        "",
        f"Medians of {ROUNDS} rounds. l_s 0.3 to 0.6; Gmsh puts exactly 12 vertices into each contour, Tessera "
        f"{meshes.n_inner.mean():.1f} on average. ē_worst {e_worst:+.1f} %, ē_mean {e_mean:+.1f} %: means of "
        "(q_Gmsh − q) / q_Gmsh, negative where Tessera's elements are better. A stage does not count what has a row of "
        "its own: triangulation is Algorithm 3 without NN3.",
        "",
        "| | µs a contour | µs a triangle |",
        "| --- | --- | --- |",
        *(row(stage, seconds, n_ours) for stage, seconds in ours.items() if stage != "total"),
        row("**Tessera**", ours["total"], n_ours),
        row("Gmsh, its `generate` call alone", theirs["generate"], n_theirs),
        row("**Gmsh**", theirs["total"], n_theirs),
    ]
    return "\n".join(text), [
        Goal(f"triangulation alone, {what} in one batch", "≤ 0.25 ms a contour", f"{alone:.2f} ms", alone <= 0.25),
        Goal("the whole scheme on them, against Gmsh", "≥ 4 × faster", f"{ratio:.1f} ×", ratio >= 4),
    ]


def mixed_sizes() -> tuple[str, list[Goal]]:
    """A hundred thousand contours of mixed sizes in one batch."""
    given = contours.mixed_sizes(LARGE_BATCH)
    gigabytes = memory.of_a_batch(contours.file_of_mixed_sizes(LARGE_BATCH)) / 1e9
    sample = tuple(values[:SAMPLE] for values in given)
    meshes = mesh_contours(*sample, Stopwatch())
    ours, theirs = in_turn(
        LARGE_ROUNDS, ours=lambda watch: mesh_contours(*given, watch), theirs=lambda watch: by_reference(sample, watch)
    )
    each, reference_each = ours["total"] / LARGE_BATCH, theirs["total"] / SAMPLE
    what = f"{LARGE_BATCH:,} contours of mixed sizes"
    text = [
        f"## {what}, in one batch",
        "",
        f"Medians of {LARGE_ROUNDS} rounds. N_C 4 to 16, l_s 0.3 to 1, {meshes.n_inner.mean():.1f} inner vertices on "
        f"average. Gmsh meshes the first {SAMPLE:,} of them, after each of our rounds. Memory is the most that a fresh "
        "process held which read the contours and meshed them, Python and all libraries included.",
        "",
        "| | µs a contour |",
        "| --- | --- |",
        *(f"| {s} | {1e6 * seconds / LARGE_BATCH:.0f} |" for s, seconds in ours.items() if s != "total"),
        f"| **Tessera** | {1e6 * each:.0f} |",
        f"| Gmsh, its `generate` call alone | {1e6 * theirs['generate'] / SAMPLE:.0f} |",
        f"| **Gmsh** | {1e6 * reference_each:.0f} |",
    ]
    ratio = reference_each / each
    return "\n".join(text), [
        Goal(f"the whole scheme on {what}, against Gmsh", "≥ 4 × faster", f"{ratio:.1f} ×", ratio >= 4),
        Goal("memory for them", "< 2 GB", f"{gigabytes:.2f} GB", gigabytes < 2),
    ]


def one_alone() -> tuple[str, list[Goal]]:
    """Contours one by one, from call to mesh."""
    text = [
        "## One contour alone, from call to mesh",
        "",
        f"`tessera.mesh_contour` on {SINGLE} contours, one call each, Gmsh in turn: milliseconds.",
        "",
        "| | median | 95th percentile | Gmsh, median |",
        "| --- | --- | --- | --- |",
    ]
    medians = []
    for name, given in (
        ("16 edges and 12 inner vertices", contours.sixteen_edges(BATCH)),
        ("mixed sizes", contours.mixed_sizes(LARGE_BATCH)),
    ):
        each = [(row[:n], l_s) for row, n, l_s in zip(*(values[:SINGLE] for values in given), strict=True)]
        tessera.mesh_contour(*each[0])
        calls = [
            in_turn(
                1, ours=lambda _, one=one: tessera.mesh_contour(*one), theirs=lambda _, one=one: reference.mesh(*one)
            )
            for one in each
        ]
        ours, theirs = 1e3 * np.array([[seconds["total"] for seconds in both] for both in calls]).T
        medians.append(float(np.median(ours)))
        text.append(f"| {name} | {medians[-1]:.1f} | {np.percentile(ours, 95):.1f} | {np.median(theirs):.1f} |")
    return "\n".join(text), [
        Goal("one contour alone, from call to mesh", "≤ 10 ms", f"{max(medians):.1f} ms", max(medians) <= 10)
    ]


def domains() -> tuple[str, list[Goal]]:
    """Whole domains, for information."""
    text = [
        "## Domains",
        "",
        "`tessera.mesh` on a disk of radius 1, Gmsh on the boundary that Tessera gave it; for information.",
        "",
        "| target | triangles | µs a triangle | Gmsh: triangles | µs a triangle |",
        "| --- | --- | --- | --- | --- |",
    ]
    angle = 2 * np.pi * np.arange(400) / 400
    disk = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for target in TARGETS:
        (boundary,) = resample_loops([disk], target, np.zeros(1, dtype=np.int64))
        ours, theirs = in_turn(
            LARGE_ROUNDS,
            ours=lambda _, target=target: tessera.mesh([disk], target),
            theirs=lambda _, target=target, boundary=boundary: reference.mesh(boundary, target),
        )
        counts = len(tessera.mesh([disk], target).triangles), len(reference.mesh(boundary, target)[1])
        cells = [f"{n:,} | {1e6 * s['total'] / n:.1f}" for n, s in zip(counts, (ours, theirs), strict=True)]
        text.append(f"| {target} | {' | '.join(cells)} |")
    return "\n".join(text), []


def main() -> None:
    """Measure, print and write."""
    reference.start()
    sections, goals = [], []
    for measure in tqdm((one_size, mixed_sizes, one_alone, domains), desc="measuring"):
        text, reached = measure()
        sections.append(text)
        goals += reached
    page = [
        "# Speed",
        "",
        f"Made by `make bench` on {datetime.date.today()}:",
        "",
        machine.describe(),
        "",
        "Everything runs in one process on one core, to which it binds itself before any library starts a thread; Gmsh "
        "has one thread too, and is called through its Python API with the options of `training/reference.py`. The "
        "contours are sector contours of seeds that training never uses, their edges kept whole. Gmsh's time is all "
        "that it takes from a contour's points to arrays of vertices and triangles.",
        "",
        "| | goal | measured | reached |",
        "| --- | --- | --- | --- |",
        *(goal.row() for goal in goals),
        "",
        "\n\n".join(sections),
        "",
    ]
    RESULTS.parent.mkdir(exist_ok=True)
    RESULTS.write_text("\n".join(page))
    print("\n".join(page))


if __name__ == "__main__":
    machine.bind_to_one_core("benchmarks.speed")
    main()
