"""What the paper claims of Figs. 22, 24, 25 and 27, and the answers."""

from __future__ import annotations

from collections.abc import Iterable

from ..evaluate.figures import STAGES
from .answers import CLOSE, ENOUGH, LIBRARY, Claim, answer, holds, number, only
from .comparing import OURS, PAPER

NAMED = {stage.figure: stage.paper for stage in STAGES if stage.paper}  # ē_worst by figure and group (N_C, N_I)
TITLES = {22: "NN2 alone", 24: LIBRARY, 25: "NN3 alone", 27: "the whole scheme"}
# The largest ē_worst and ē_mean, and the groups (N_C, N_I) that have them where the text says so.
LARGEST = {
    22: ((23.41, (12, 14)), (19.7, (12, 14))),
    24: ((1.9, (14, 10)), (1.5, (16, 16))),
    25: ((24.04, (8, 12)), None),
    27: ((27.3, (16, 18)), (15.2, None)),
}
# Fig. 25: from a group to one of more vertices, by so many per cent: the text's own, or those of the errors it names.
CHANGES = {((6, 4), (6, 6)): -23, ((10, 8), (10, 10)): -29, ((12, 6), (12, 8)): -25, ((12, 10), (12, 12)): 261}


def stage_claims(rows: list[dict]) -> Iterable[Claim]:
    """All four figures; rows: of `stages`."""
    for figure, limits in LARGEST.items():
        for key, paper in sorted(NAMED[figure].items()):
            yield _named(rows, figure, key, paper)
        for what, limit in zip(("worst", "mean"), limits, strict=True):
            if limit is not None:
                yield _largest(rows, figure, what, *limit)
        if figure == 22:
            yield _grows(rows)
        if figure == 25:
            yield from (_changed(rows, *groups, paper) for groups, paper in CHANGES.items())
    yield from _dearer(rows)


def _of(figure: int) -> str:
    return LIBRARY if figure == 24 else PAPER


def _row(rows: list[dict], figure: int, networks: str, key: tuple[int, int]) -> dict:
    same = (row for row in rows if (row["figure"], row["networks"], row["n"], row["m"]) == (figure, networks, *key))
    return only(row for row in same if row["worst"] is not None) or {"worst": None, "worst_spread": 0.0}


def _named(rows: list[dict], figure: int, key: tuple[int, int], paper: float) -> Claim:
    """The ē_worst of a group that the text names."""
    ours, shipped = (_row(rows, figure, name, key) for name in (PAPER, OURS))
    what = f"Fig. {figure}: {TITLES[figure]}, ē_worst of N_C {key[0]}, N_I {key[1]}"
    verdict = answer(ours["worst"], paper, ours["worst_spread"])
    theirs = "the same" if figure == 24 else number(shipped["worst"], "{:+.1f} %")
    if figure == 27 and shipped["worst"] is None:
        theirs = "not meshed here; by Gmsh's count in `docs/results/scheme.md`"
    rest = f" ({ours['rest by CDT']:+.1f} % with sub-contours by CDT)" if "rest by CDT" in ours else ""
    here = "not trained" if ours["worst"] is None else number(ours["worst"], "{:+.1f} %") + rest
    return Claim(what, f"{paper:g} %", here, verdict, theirs, _of(figure))


def _largest(rows: list[dict], figure: int, what: str, limit: float, where: tuple[int, int] | None) -> Claim:
    """The largest mean error of all groups.

    Where some N_C are not measured, it could be larger still: no answer, unless it is worse already.
    """
    found = {}
    for name in (PAPER, OURS):
        groups = [row for row in rows if (row["figure"], row["networks"]) == (figure, name)]
        groups = [row for row in groups if row["m"] and row["contours"] >= ENOUGH]
        found[name] = max(groups, key=lambda row: row[what], default=None)
    have = {row["n"] for row in rows if (row["figure"], row["networks"]) == (figure, PAPER) and row["contours"]}
    missing = sorted({row["n"] for row in rows} - have)
    shown = {name: _group_text(row, what) for name, row in found.items()}
    row = found[PAPER]
    verdict = answer(None if row is None else row[what], limit, 0 if row is None else row[f"{what}_spread"])
    if missing:
        verdict = verdict if verdict == "worse" else "not tested"
        left = f"; N_C {', '.join(map(str, missing))} not measured"
        shown[PAPER] += left
        shown[OURS] += left if figure == 27 else ""
    paper = f"{limit:g} %" + ("" if where is None else " ({}, {})".format(*where))
    theirs = "the same" if figure == 24 else shown[OURS]
    return Claim(
        f"Fig. {figure}: {TITLES[figure]}, largest ē_{what}", paper, shown[PAPER], verdict, theirs, _of(figure)
    )


def _group_text(row: dict | None, what: str) -> str:
    return "—" if row is None else f"{row[what]:+.1f} % ({row['n']}, {row['m']})"


def _grows(rows: list[dict]) -> Claim:
    """Whether NN2's ē_worst is larger with the most inner vertices than with the fewest, for every N_C."""
    shown, grows = {}, {}
    for name in (PAPER, OURS):
        of = {}
        for row in sorted(rows, key=lambda row: row["m"] or 0):
            if (row["figure"], row["networks"]) == (22, name) and row["m"] and row["contours"] >= ENOUGH:
                of.setdefault(row["n"], []).append(row["worst"])
        grows[name] = [errors[-1] > errors[0] for errors in of.values() if len(errors) > 1]
        shown[name] = f"{sum(grows[name])} of {len(grows[name])}" if grows[name] else "—"
    what = "Fig. 22: NN2 alone, ē_worst is larger with the most inner vertices than with the fewest, for every N_C"
    return Claim(what, "all", shown[PAPER], holds(bool(grows[PAPER]), all(grows[PAPER])), shown[OURS])


def _changed(rows: list[dict], before: tuple[int, int], after: tuple[int, int], paper: float) -> Claim:
    """By how much NN3's ē_worst changes from a group to a larger one, relative to the first."""
    errors = [_row(rows, 25, PAPER, key)["worst"] for key in (before, after)]
    what = f"Fig. 25: NN3 alone, N_C {before[0]}: change of ē_worst from N_I {before[1]} to {after[1]}"
    shipped = "errors near 0"
    if None in errors or not errors[0]:
        return Claim(what, f"{paper:+} %", "not trained", "not tested", shipped)
    change = 100 * (errors[1] / errors[0] - 1)
    close = abs(change - paper) <= CLOSE * abs(paper)
    verdict = "reproduced" if close else "better" if change < paper else "worse"
    return Claim(what, f"{paper:+} %", f"{change:+.0f} %", verdict, shipped)


def _dearer(rows: list[dict]) -> Iterable[Claim]:
    """Whether the whole scheme's errors are above those of its parts."""
    for kind in ("worst", "mean"):
        errors = {
            (row["figure"], row["n"], row["m"]): row[kind]
            for row in rows
            if row["networks"] == PAPER and row["m"] and row[kind] is not None
        }
        keys = [(n, m) for figure, n, m in errors if figure == 27 and {(22, n, m), (25, n, m)} <= errors.keys()]
        below = [key for key in keys if errors[27, *key] <= max(errors[22, *key], errors[25, *key])]
        what = f"Fig. 27: the whole scheme's ē_{kind} is above those of NN2 and of NN3 alone"
        here = f"{len(keys) - len(below)} of {len(keys)} groups" + (
            f", not ({'), ('.join('{}, {}'.format(*key) for key in below)})" if below else ""
        )
        yield Claim(what, "in every group", here, holds(bool(keys), not below))
