"""The report: Markdown and pictures in a folder, from the results of all sets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from .. import reference
from ..provenance import code_version, network_hashes
from .figures import STAGES, Stage
from .goals import BINS, ENOUGH, ENOUGH_CLOSE, Goal, count_groups, error_groups
from .groups import Groups, mean_and_spread
from .plots import draw_distributions, draw_groups
from .stages import FLIPPED, GMSH, MESHERS, OURS, SMOOTHED, TEACHER, Results

Pairs = dict[str, tuple[Groups, Groups]]  # ē_worst and ē_mean by stage


def write(folder: Path, sets: dict[str, Results], goals: Sequence[Goal], test: dict, seed: int) -> str:
    """Write ``scheme.md``, ``groups.md`` and the pictures; returns the text of the first. Sector contours come first.

    test: the configuration's section.
    """
    folder.mkdir(parents=True, exist_ok=True)
    sector = next(iter(sets.values()))
    pairs = {stage.name: error_groups(sector, stage.mesher, stage.against) for stage in STAGES}
    counts = {TEACHER: count_groups(sector, TEACHER), GMSH: count_groups(sector, GMSH)}
    _draw(folder, pairs, counts, sets)
    text = "\n\n".join(
        [
            "# The networks against the reference mesher",
            _table(["", "paper", "goal", "measured", "reached"], [goal.cells() for goal in goals]),
            _introduction(sets, test, seed),
            _stage(STAGES[0], pairs["scheme"]),
            _by_edges(sector),
            _counts(counts),
            *(_stage(stage, pairs[stage.name]) for stage in STAGES[1:]),
            "## Where the paper names a group's ē_worst",
            _paper(pairs),
            "## Distributions\n\n![Cumulative shares of contours](distributions.png)",
            *(_distribution(*item) for item in sets.items()),
        ]
    )
    (folder / "scheme.md").write_text(text + "\n")
    (folder / "groups.md").write_text(_all_groups(pairs, counts) + "\n")
    return text


def _table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (columns, ["---"] * len(columns), *rows))


def _draw(folder: Path, pairs: Pairs, counts: dict[str, Groups], sets: dict[str, Results]) -> None:
    for stage in STAGES:
        titles = [f"{stage.title}: {error} (%)" for error in ("ē_worst", "ē_mean")]
        draw_groups(folder / f"{stage.name}.png", titles, pairs[stage.name], "N_I", 15, signed=True)
    titles = [f"NN1: mean absolute error of the count, against {name}" for name in counts]
    draw_groups(folder / "nn1.png", titles, list(counts.values()), "l_s, from", 1.5, signed=False)
    draw_distributions(folder / "distributions.png", sets)


def _introduction(sets: dict[str, Results], test: dict, seed: int) -> str:
    sector, *others = sets.values()
    names = list(sets)
    more = " and ".join(f"{len(results):,} {name}" for name, results in zip(names[1:], others, strict=True))
    left_out = ", ".join(f"{(~results.valid[GMSH]).sum()} {name}" for name, results in sets.items())
    return (
        f"{len(sector):,} {names[0]} (N_C 4 to 16, l_s 0.3 to 1, seed {seed}), of which the teacher and Gmsh "
        f"Frontal-Delaunay had the first {sector.is_close.sum():,}; {more}. Gmsh "
        f"{reference.VERSION}, contour edges frozen, sizes as in `training/reference.py`; it changed the contour or "
        f"inverted elements, and is compared with nothing, in {left_out}. *Tessera* is the raw networks, nothing "
        f"after them; *flips* has `flips=True`, *smoothed* `smooth={test['smooth']}`.\n\n"
        "e = (q_reference − q) / q_reference: negative is better than the reference. ē is its mean over contours, "
        "± its standard error. Groups are by number of contour edges N_C and the reference's number of inner vertices "
        f"N_I; the worst one is that among groups of at least {ENOUGH} contours ({ENOUGH_CLOSE} where the teacher is "
        "the reference). NN1's error is against the teacher's count, which it is taught. All groups, with contours and "
        f"standard errors, are in [groups.md](groups.md). Made by `make evaluate` at {code_version()} with "
        + ", ".join(f"{name} {digest}" for name, digest in network_hashes().items())
        + "."
    )


def _stage(stage: Stage, pair: tuple[Groups, Groups]) -> str:
    text = []
    for what, groups in zip(("ē_worst", "ē_mean"), pair, strict=True):
        mean = np.nansum(groups.mean * groups.count) / max(groups.count.sum(), 1)
        worst = groups.worst(stage.enough)
        where = "" if worst is None else f", at worst {worst[2]:+.2f} ± {worst[3]:.2f} % ({worst[0]:g}, {worst[1]:g})"
        text.append(f"{what} {mean:+.2f} %{where}")
    picture = f"![By edges and inner vertices]({stage.name}.png)"
    count = f"{pair[0].count.sum():,} contours"
    return f"## {stage.title} (Fig. {stage.figure})\n\n{count}: {'; '.join(text)}.\n\n{picture}"


def _by_edges(sector: Results) -> str:
    """The whole scheme by N_C alone, with flips and smoothing beside it."""
    errors = [100 * sector.error(mesher, GMSH) for mesher in (OURS, FLIPPED, SMOOTHED)]
    apart = np.abs(sector.wanted - sector.n_inner[GMSH])
    columns = ["N_C", "contours", "ē_worst", "ē_mean", "flips: ē_worst", "ē_mean", "smoothed: ē_worst", "ē_mean"]
    rows = []
    every = [(str(n), sector.n_contour == n) for n in np.unique(sector.n_contour)]
    for name, chosen in [*every, ("all", slice(None))]:
        means = [_with_spread(error[chosen, column]) for error in errors for column in range(2)]
        fell = f"{(sector.fallbacks[chosen] > 0).sum()}"
        rows.append([name, f"{len(apart[chosen])}", *means, f"{np.nanmean(apart[chosen]):.2f}", fell])
    return _table([*columns, "N_I off Gmsh's", "with fallbacks"], rows)


def _counts(counts: dict[str, Groups]) -> str:
    taught, gmsh = counts[TEACHER], counts[GMSH]
    columns = ["N_C", *(f"{column:g}–{column + BINS:g}" for column in gmsh.columns)]
    rows = [
        [f"{n:g}", *(f"{taught.cell(n, column)[1]:.2f} / {gmsh.cell(n, column)[1]:.2f}" for column in gmsh.columns)]
        for n in gmsh.rows
    ]
    return (
        "## NN1 (Fig. 19)\n\nMean absolute error of the number of inner vertices, by l_s: against the teacher's count "
        "/ against Gmsh's. The paper's: at most 1.5 (N_C 16, l_s 0.2); N_C 14: 1.3 → 0.2 from l_s 0.2 to 1.\n\n"
        "![By edges and target edge length](nn1.png)\n\n" + _table(columns, rows)
    )


def _paper(pairs: Pairs) -> str:
    rows = []
    for stage in STAGES:
        for (n, m), value in stage.paper.items():
            count, mean = pairs[stage.name][0].cell(n, m)
            here = f"{mean:+.1f} %" if count else "—"
            rows.append([f"Fig. {stage.figure}, {stage.mesher}", str(n), str(m), f"{value:+.1f} %", here, str(count)])
    return _table(["", "N_C", "N_I", "paper", "here", "contours"], rows)


def _distribution(name: str, results: Results) -> str:
    chosen = results.is_comparable
    rows = []
    for mesher in MESHERS if chosen.any() else ():
        worst, mean, angle, deviation = results.measures[mesher][chosen].T
        error = 100 * results.error(mesher, GMSH)[chosen]
        rows.append(
            [
                mesher,
                *(f"{value:.3f}" for value in (worst.mean(), np.percentile(worst, 5), mean.mean())),
                *(f"{value:.1f}°" for value in (angle.mean(), np.percentile(angle, 5))),
                f"{deviation.mean():.3f}",
                f"{results.n_inner[mesher][chosen].mean():.2f}",
                *(_with_spread(error[:, column]) for column in range(2)),
            ]
        )
    columns = ["", "q_worst", "5th percentile", "q_mean", "smallest angle", "5th percentile", "deviation", "N_I"]
    return (
        f"### {name[0].upper()}{name[1:]}\n\n"
        f"{chosen.sum():,} contours of which every mesher made a valid mesh; deviation is the mean of |edge − l_s| / "
        f"l_s over inner edges. Of all {len(results):,}, {100 * (results.fallbacks > 0).mean():.2f} % had fallbacks "
        f"and {(~results.valid[OURS]).sum()} an invalid mesh.\n\n" + _table([*columns, "ē_worst", "ē_mean"], rows)
    )


def _all_groups(pairs: Pairs, counts: dict[str, Groups]) -> str:
    """A row for each group."""
    parts = ["# All groups", "Means in per cent, and their standard errors: see [scheme.md](scheme.md)."]
    for stage in STAGES:
        worst, mean = pairs[stage.name]
        rows = [
            [*_keys(worst, i, j), *(f"{value:+.2f} | {spread:.2f}" for value, spread in cells)]
            for i, j in np.argwhere(worst.count > 0)
            for cells in [[(part.mean[i, j], part.spread[i, j]) for part in (worst, mean)]]
        ]
        columns = ["N_C", "N_I", "contours", "ē_worst", "±", "ē_mean", "±"]
        parts.append(f"## {stage.title} (Fig. {stage.figure})\n\n{_table(columns, rows)}")
    for name, part in counts.items():
        rows = [
            [*_keys(part, i, j), f"{part.mean[i, j]:.2f}", f"{part.spread[i, j]:.2f}"]
            for i, j in np.argwhere(part.count > 0)
        ]
        columns = ["N_C", "l_s, from", "contours", "mean absolute error", "±"]
        parts.append(f"## NN1 against the count of {name} (Fig. 19)\n\n{_table(columns, rows)}")
    return "\n\n".join(parts)


def _keys(groups: Groups, i: int, j: int) -> list[str]:
    return [f"{groups.rows[i]:g}", f"{groups.columns[j]:g}", f"{groups.count[i, j]}"]


def _with_spread(error: np.ndarray) -> str:
    mean, spread = mean_and_spread(error)
    return f"{mean:+.1f} ± {spread:.1f} %"
