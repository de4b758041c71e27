"""How a claim of the paper is answered: reproduced, better, worse or not tested, with the number."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from .comparing import OURS, PAPER

CLOSE = 0.15  # of the paper's number, or two standard errors if that is more: reproduced
CLOSE_QUALITY = 0.02  # of a quality: reproduced
ENOUGH = 50  # meshes of a group whose error is counted among the largest
LIBRARY = "the library's triangulation with calculated tables"
MEASURED = (PAPER, LIBRARY, OURS)  # whose number the answer is about


@dataclass(frozen=True)
class Claim:
    """A line of the table: what the paper says, by the paper's networks here, and by the shipped ones."""

    what: str
    paper: str
    ours: str
    answer: str
    shipped: str = "no counterpart"
    of: str = PAPER  # one of MEASURED


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


def holds(known: bool, true: bool) -> str:
    """The answer to a claim that is no number."""
    return "not tested" if not known else "reproduced" if true else "worse"


def only(values: Iterable) -> object | None:
    """The first of some values, None where there is none."""
    return next(iter(values), None)
