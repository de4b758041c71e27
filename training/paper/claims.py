"""What the paper claims, and the answer to each (`answers`). Those on Figs. 22, 24, 25 and 27 are in `stage_claims`."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from .answers import CLOSE, CLOSE_QUALITY, Claim, answer, holds, number
from .comparing import OURS, PAPER
from .stage_claims import stage_claims

COUNT_ERRORS = {(16, 0.2): 1.5, (14, 0.2): 1.3, (14, 1.0): 0.2}  # Fig. 19, by N_C and l_s
# Fig. 26: the confidence level that the paper compares at, how much better, and with how many fewer samples.
ADAPTIVE = {1: (96, 27, 35), 2: (90, 18, 22), 4: (90, 27, 17)}


def claims(found: dict) -> list[Claim]:
    """All claims; found: what the experiments have left, by name."""
    return [
        *_counts(found["counts"]),
        *_resolution(found["resolution"]),
        *stage_claims(found["stages"]),
        _population(found["learning"]),
        *_adaptive(found["adaptive"]),
        *_domains(found["domains"]),
        _speed(found["speed"]),
    ]


def _counts(rows: list[dict]) -> Iterable[Claim]:
    """Fig. 19: the errors that the text names, and how they depend on N_C and l_s."""
    errors = {name: {(r["n"], r["l_s"]): r["error"] for r in rows if r["networks"] == name} for name in (PAPER, OURS)}
    for key, paper in COUNT_ERRORS.items():
        ours, shipped = (errors[name].get(key) for name in (PAPER, OURS))
        what = f"Fig. 19: NN1's mean absolute error, N_C {key[0]}, l_s {key[1]:g}"
        yield Claim(what, f"{paper:g}", number(ours, "{:.2f}"), answer(ours, paper), number(shipped, "{:.2f}"))
    yield _largest_count(errors)
    a, b = (16, 0.2), (4, 0.2)
    ratios = {name: of[a] / of[b] if {a, b} <= of.keys() and of[b] else None for name, of in errors.items()}
    what = "Fig. 19: at l_s 0.2, the error with 16 edges over that with 4"
    texts = {name: number(ratio, "{:.1f} ×") for name, ratio in ratios.items()}
    yield Claim(what, "2.3 ×", texts[PAPER], answer(ratios[PAPER], 2.3), texts[OURS])
    yield from _growth(errors)
    yield _deviation(rows)


def _largest_count(errors: dict[str, dict]) -> Claim:
    largest = {name: max(of, key=of.get, default=None) for name, of in errors.items()}
    value = {name: None if key is None else errors[name][key] for name, key in largest.items()}
    texts = {
        name: "—" if key is None else f"{value[name]:.2f} ({key[0]}, l_s {key[1]:g})" for name, key in largest.items()
    }
    what = "Fig. 19: NN1's mean absolute error, the largest"
    return Claim(what, "1.5 (16, l_s 0.2)", texts[PAPER], answer(value[PAPER], 1.5), texts[OURS])


def _growth(errors: dict[str, dict]) -> Iterable[Claim]:
    """The error grows with N_C, and is larger at a small l_s."""
    numbers, targets = (sorted({key[i] for key in errors[PAPER]}) for i in (0, 1))

    def grows(of: dict, l_s: float) -> bool:
        line = [of[n, l_s] for n in numbers]
        return line == sorted(line)

    texts, every = {}, {}
    for name, of in errors.items():
        not_at = [f"{l_s:g}" for l_s in targets if of and not grows(of, l_s)]
        every[name] = not not_at
        texts[name] = f"{len(targets) - len(not_at)} of {len(targets)}" + (
            f", not {', '.join(not_at)}" if not_at else ""
        )
    what = "Fig. 19: the error grows with N_C, at every l_s"
    yield Claim(what, "all", texts[PAPER], holds(len(numbers) > 1, every[PAPER]), texts[OURS])
    if 0.2 in targets:
        lists = {name: ", ".join(f"{n}: {of[n, 0.2]:.2f}" for n in numbers if of) for name, of in errors.items()}
        what = "Fig. 19: the error grows with N_C, at l_s 0.2"
        yield Claim(what, "yes", lists[PAPER], holds(len(numbers) > 1, grows(errors[PAPER], 0.2)), lists[OURS])
    falls = {}
    for name, of in errors.items():
        pairs = [(of[n, 0.2], of[n, 1.0]) for n in numbers if {(n, 0.2), (n, 1.0)} <= of.keys()]
        falls[name] = (sum(small > large for small, large in pairs), len(pairs))
    what = "Fig. 19: the error is larger at l_s 0.2 than at 1, for every N_C"
    verdict = holds(falls[PAPER][1] > 0, falls[PAPER][0] == falls[PAPER][1])
    yield Claim(what, "all", "{} of {}".format(*falls[PAPER]), verdict, "{} of {}".format(*falls[OURS]))


def _deviation(rows: list[dict]) -> Claim:
    """Of Gmsh's count: no answer, as no network has a part in it, and the paper's size setting is another."""
    at = {row["l_s"]: row["deviation"] for row in rows if row["n"] == 14}
    fall = 100 * (1 - at[1.0] / at[0.2]) if {0.2, 1.0} <= at.keys() else None
    what = "Fig. 19: N_C 14, the standard deviation of N_I falls from l_s 0.2 to 1"
    text = "—" if fall is None else f"by {fall:.0f} %, from {at[0.2]:.1f} to {at[1.0]:.1f}, with another size setting"
    return Claim(what, "by 12 %", text, "not tested", "the same")


def _resolution(rows: list[dict]) -> Iterable[Claim]:
    """Means over N_C of the mean squared distances: is a grid worse than the next finer one by more than `CLOSE`?

    That there is no such gain is no finding where the errors could hide it: not tested.
    """
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
        known = gains or 2 * spread <= CLOSE * mean[coarse]
        shown = f"{text} (difference ± {spread:.3f}{'' if known else ', too much to tell'})"
        yield Claim(what, "yes", shown, holds(known, gains == expected))


def _spread(rows: list[dict]) -> float:
    """Standard error of the mean over N_C."""
    return float(np.sqrt(np.sum([row["spread"] ** 2 for row in rows])) / len(rows))


def _population(rows: list[dict]) -> Claim:
    """Not answered: of one group's networks, whose errors hardly change."""
    falls = {row["role"]: 100 * (1 - row["loss"][-1] / row["loss"][0]) for row in rows}
    text = ", ".join(f"{role} {-falls[role]:+.1f} %" for role in ("NN2", "NN3") if role in falls)
    what = "section 3.2.3: NN3 depends more than NN2 on the size of the population"
    text += " (root mean square, largest against smallest population), of one group each"
    return Claim(what, "yes", text, "not tested")


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
            close = abs(row[name] - paper) <= CLOSE_QUALITY
            verdict = "reproduced" if close else "better" if row[name] > paper else "worse"
            shown = f"{row[name]:.2f}"
            if name == "q_worst" and row["q_left_out"] is not None:
                shown += f" ({min(row['q_left_out'], row['q_worst']):.2f} with the element in the sharp tail)"
            what = f"Table 2: {row['name']}, {name} (by the shipped networks)"
            yield Claim(what, f"{paper:.2f}", "—", verdict, shown, OURS)


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
