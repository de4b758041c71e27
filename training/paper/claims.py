"""What the paper claims, and the answer to each: reproduced, better, worse or not tested, with the number.

A claim that is no number is reproduced, or else worse.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..evaluate.figures import STAGES
from .comparing import OURS, PAPER

CLOSE = 0.15  # of the paper's number, or two standard errors if that is more: reproduced
ENOUGH = 50  # contours of a group whose error is counted among the largest
NAMED = {stage.figure: stage.paper for stage in STAGES if stage.paper}  # ē_worst by figure and group (N_C, N_I)
COUNT_ERRORS = {(16, 0.2): 1.5, (14, 0.2): 1.3, (14, 1.0): 0.2}  # Fig. 19, by N_C and l_s
# Fig. 26: the confidence level that the paper compares at, how much better, and with how many fewer samples.
ADAPTIVE = {1: (96, 27, 35), 2: (90, 18, 22), 4: (90, 27, 17)}


@dataclass(frozen=True)
class Claim:
    """A line of the table: what the paper says, by the paper's networks here, and by the shipped ones."""

    what: str
    paper: str
    ours: str
    answer: str
    shipped: str = "—"


def number(value: float | None, form: str = "{:.1f} %") -> str:
    """A number, or a dash."""
    return "—" if value is None else form.format(value)


def answer(value: float | None, paper: float, spread: float = 0.0, larger_is_better: bool = False) -> str:
    """Reproduced where a number is close to the paper's, else better or worse."""
    if value is None:
        return "not tested"
    if abs(value - paper) <= max(CLOSE * abs(paper), 2 * spread):
        return "reproduced"
    return "better" if (value > paper) == larger_is_better else "worse"


def claims(found: dict) -> list[Claim]:
    """All claims; found: what the experiments have left, by name."""
    return [
        *_counts(found["counts"]),
        *_resolution(found["resolution"]),
        *_stages(found["stages"]),
        *_adaptive(found["adaptive"]),
        *_domains(found["domains"]),
        _speed(found["speed"]),
    ]


def _counts(rows: list[dict]) -> Iterable[Claim]:
    def error(networks: str, n: int, l_s: float) -> float | None:
        return _only(row["error"] for row in rows if (row["networks"], row["n"], row["l_s"]) == (networks, n, l_s))

    for (n, l_s), paper in COUNT_ERRORS.items():
        ours, shipped = error(PAPER, n, l_s), error(OURS, n, l_s)
        what = f"Fig. 19: NN1's mean absolute error, N_C {n}, l_s {l_s:g}"
        yield Claim(what, f"{paper:g}", number(ours, "{:.2f}"), answer(ours, paper), number(shipped, "{:.2f}"))
    ratios = {
        name: a / b if (a := error(name, 16, 0.2)) is not None and (b := error(name, 4, 0.2)) else None
        for name in (PAPER, OURS)
    }
    what = "Fig. 19: at l_s 0.2, the error with 16 edges over that with 4"
    yield Claim(
        what, "2.3 ×", number(ratios[PAPER], "{:.1f} ×"), answer(ratios[PAPER], 2.3), number(ratios[OURS], "{:.1f} ×")
    )
    falls = {}
    for name in (PAPER, OURS):
        pairs = [(error(name, n, 0.2), error(name, n, 1.0)) for n in sorted({row["n"] for row in rows})]
        pairs = [pair for pair in pairs if None not in pair]
        falls[name] = (sum(small > large for small, large in pairs), len(pairs))
    what = "Fig. 19: the error is larger at l_s 0.2 than at 1, for every N_C"
    every = "reproduced" if falls[PAPER][0] == falls[PAPER][1] > 0 else "worse"
    yield Claim(what, "all", "{} of {}".format(*falls[PAPER]), every, "{} of {}".format(*falls[OURS]))


def _resolution(rows: list[dict]) -> Iterable[Claim]:
    """Means over N_C of the mean squared distances: is a grid worse than the next finer one by more than `CLOSE`?"""
    grids = sorted({row["grid"] for row in rows})
    mean = {grid: float(np.mean([row["error"] for row in rows if row["grid"] == grid])) for grid in grids}
    text = ", ".join(f"{grid}: {value:.3f}" for grid, value in mean.items())
    for coarse, fine, expected in ((20, 40, False), (10, 20, True)):
        what = f"Fig. 21: {fine}×{fine} grid points are {'' if expected else 'not '}better than {coarse}×{coarse}"
        if not {coarse, fine} <= mean.keys():
            yield Claim(what, "yes", "—", "not tested")
            continue
        spread = np.hypot(*(_spread([row for row in rows if row["grid"] == grid]) for grid in (coarse, fine)))
        gains = mean[coarse] - mean[fine] > max(CLOSE * mean[coarse], 2 * spread)
        yield Claim(what, "yes", f"{text} (± {spread:.3f})", "reproduced" if gains == expected else "worse")


def _spread(rows: list[dict]) -> float:
    """Standard error of the mean over N_C."""
    return float(np.sqrt(np.sum([row["spread"] ** 2 for row in rows])) / len(rows))


def _stages(rows: list[dict]) -> Iterable[Claim]:
    def group(figure: int, networks: str, key: tuple[int, int]) -> dict:
        same = (row for row in rows if (row["figure"], row["networks"], row["n"], row["m"]) == (figure, networks, *key))
        return _only(row for row in same if row["worst"] is not None) or {"worst": None, "worst_spread": 0.0}

    largest = {22: (23.41, 19.7), 24: (1.9, 1.5), 25: (24.04, None), 27: (27.3, 15.2)}
    titles = {22: "NN2 alone", 24: "calculated tables", 25: "NN3 alone", 27: "the whole scheme"}
    for figure, limits in largest.items():
        for key, paper in sorted(NAMED[figure].items()):
            ours, shipped = group(figure, PAPER, key), group(figure, OURS, key)
            what = f"Fig. {figure}: {titles[figure]}, ē_worst of N_C {key[0]}, N_I {key[1]}"
            verdict = answer(ours["worst"], paper, ours["worst_spread"])
            theirs = number(shipped["worst"], "{:+.1f} %") if figure != 24 else "—"
            rest = f" ({ours['rest by CDT']:+.1f} % with sub-contours by CDT)" if "rest by CDT" in ours else ""
            yield Claim(what, f"{paper:g} %", number(ours["worst"], "{:+.1f} %") + rest, verdict, theirs)
        for what, limit in zip(("worst", "mean"), limits, strict=True):
            if limit is not None:
                yield _largest(rows, figure, titles[figure], what, limit)
    yield _dearer(rows)


def _largest(rows: list[dict], figure: int, title: str, what: str, limit: float) -> Claim:
    """The largest mean error of all groups."""
    found = {}
    for name in (PAPER, OURS):
        groups = [row for row in rows if (row["figure"], row["networks"]) == (figure, name)]
        groups = [row for row in groups if row["m"] and row["contours"] >= ENOUGH]
        found[name] = max(groups, key=lambda row: row[what], default=None)
    texts = {name: _group_text(row, what) for name, row in found.items()}
    row = found[PAPER]
    verdict = answer(None if row is None else row[what], limit, 0 if row is None else row[f"{what}_spread"])
    return Claim(f"Fig. {figure}: {title}, largest ē_{what}", f"{limit:g} %", texts[PAPER], verdict, texts[OURS])


def _group_text(row: dict | None, what: str) -> str:
    return "—" if row is None else f"{row[what]:+.1f} % ({row['n']}, {row['m']})"


def _dearer(rows: list[dict]) -> Claim:
    """Whether the whole scheme's errors are above those of its parts."""
    errors = {
        (row["figure"], row["n"], row["m"]): row["worst"]
        for row in rows
        if row["networks"] == PAPER and row["m"] and row["worst"] is not None
    }
    keys = [(n, m) for figure, n, m in errors if figure == 27 and {(22, n, m), (25, n, m)} <= errors.keys()]
    above = sum(errors[27, *key] > max(errors[22, *key], errors[25, *key]) for key in keys)
    what = "Fig. 27: the whole scheme's ē_worst is above those of NN2 and of NN3 alone, in nine of ten groups"
    verdict = "not tested" if not keys else "reproduced" if above >= 0.9 * len(keys) else "worse"
    return Claim(what, "all", f"{above} of {len(keys)} groups", verdict)


def _adaptive(rows: list[dict]) -> Iterable[Claim]:
    """By how much adaptive samples are better; a gain that could be none, within two standard errors, is worse."""
    for m, (level, better, fewer) in ADAPTIVE.items():
        pair = {row["sampling"]: row for row in rows if (row["m"], row["level"]) == (m, level)}
        what = f"Fig. 26: NN3*, N_I {m}, {level} % confidence: adaptive sampling is better by (with fewer samples)"
        if len(pair) < 2 or None in (pair["random"]["worst"], pair["adaptive"]["worst"]):
            yield Claim(what, f"{better} % ({fewer} % fewer)", "—", "not tested")
            continue
        random, adaptive = pair["random"], pair["adaptive"]
        gain = 100 * (1 - adaptive["worst"] / random["worst"])
        spread = 100 * float(np.hypot(random["worst_spread"], adaptive["worst_spread"])) / random["worst"]
        fewer_here = 100 * (1 - adaptive["size"] / random["size"])
        text = f"{gain:+.0f} ± {spread:.0f} % ({fewer_here:.0f} % fewer)"
        verdict = answer(gain, better, spread, larger_is_better=True) if gain > 2 * spread else "worse"
        yield Claim(what, f"{better} % ({fewer} % fewer)", text, verdict)


def _domains(rows: list[dict]) -> Iterable[Claim]:
    """q_worst is judged without the element that a sharp tail forces on every mesher, and shown with it."""
    for row in rows:
        for name, paper in zip(("q_worst", "q_mean"), row["paper"], strict=True):
            close = abs(row[name] - paper) <= 0.02
            verdict = "reproduced" if close else "better" if row[name] > paper else "worse"
            shown = f"{row[name]:.2f}"
            if name == "q_worst" and row["q_left_out"] is not None:
                shown += f" ({min(row['q_left_out'], row['q_worst']):.2f} with the element in the sharp tail)"
            what = f"Table 2: {row['name']}, {name} (by the shipped networks)"
            yield Claim(what, f"{paper:.2f}", "—", verdict, shown)


def _speed(rows: list[dict]) -> Claim:
    """The scheme's time over the reference's, one contour after the other as the paper has it: mean over N_C."""
    what = "section 5: slower than Gmsh, contours one by one"
    if not rows:
        return Claim(what, "4 ×", "—", "not tested")
    ratio = {name: float(np.mean([row[f"{name}, alone"] / row["Gmsh"] for row in rows])) for name in (PAPER, OURS)}
    verdict = answer(ratio[PAPER], 4)
    batch = {name: float(np.mean([row[f"{name}, batch"] / row["Gmsh"] for row in rows])) for name in (PAPER, OURS)}
    ours, shipped = (f"{ratio[name]:.1f} × ({batch[name]:.1f} × in a batch)" for name in (PAPER, OURS))
    return Claim(what, "about 4 ×", ours, verdict, shipped)


def _only(values: Iterable) -> object | None:
    """The first of some values, None where there is none."""
    return next(iter(values), None)
