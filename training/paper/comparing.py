"""What the experiments share: test groups, the errors of meshes against the reference's, and the networks compared."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import torch

from tessera import paper
from tessera.roles import SHIPPED, Roles

from ..evaluate.meshes import Meshes, are_valid, measure
from ..evaluate.sets import Contours
from .data import Group, Population, load, sample_size
from .networks import Network

PAPER, OURS = "the paper's networks", "the shipped networks"


def compared(config: dict) -> dict[str, Roles]:
    """The networks that every experiment asks: the paper's, from the folder they were exported to, and the shipped."""
    return {PAPER: paper.load("paper", config["folders"]["models"]), OURS: SHIPPED}


def as_roles(net: Network, n: int, m: int, by_row: bool) -> Roles:
    """The shipped networks with a NN3, or a NN3* (by_row), for the group (n, m) in place of theirs."""

    def ask(given: np.ndarray) -> np.ndarray:
        with torch.no_grad():
            return net(torch.as_tensor(given, dtype=torch.float32)[None])[0].numpy()

    return asking(ask, n, m, by_row)


def asking(ask: Callable[[np.ndarray], np.ndarray], n: int, m: int, by_row: bool) -> Roles:
    """As `as_roles`, with a function of rows; contours and sub-contours of other groups have no table."""

    def of_group(n_contour: int, n_inner: int, given: np.ndarray) -> np.ndarray | None:
        return ask(given) if (n_contour, n_inner) == (n, m) else None

    return Roles(SHIPPED.count, SHIPPED.place, partial(paper.rate, of_group, by_row))


def test_group(config: dict, trained: Population, tested: Population, n_inner: int) -> Group:
    """Meshes of the test population, as many as 95 % confidence and 5 % interval ask for (section 3.2.2)."""
    size = min(sample_size(int((trained.n_inner == n_inner).sum())), config["test"]["contours"])
    group = tested.group(n_inner)
    return group.rows(np.random.default_rng(1).permutation(len(group))[:size])


def as_contours(contour: np.ndarray, l_s: np.ndarray) -> Contours:
    """Contours (k, N_C, 2) of one N_C as the evaluation has them."""
    points = np.zeros((len(contour), 16, 2))
    points[:, : contour.shape[1]] = contour
    return Contours(points, np.full(len(contour), contour.shape[1]), l_s)


def errors(meshes: Meshes, contours: Contours, reference: np.ndarray) -> np.ndarray:
    """e_worst and e_mean (k, 2) of section 3.1.1 in per cent, against qualities (k, 2); NaN of invalid meshes."""
    found = np.where(are_valid(meshes, contours)[:, None], measure(meshes, contours.l_s)[:, :2], np.nan)
    return 100 * (reference - found) / reference


def mean_errors(error: np.ndarray) -> dict:
    """ē_worst and ē_mean of errors (k, 2), their standard errors, and of how many contours at their targets.

    Meshes of one contour at several targets are counted apart (`populations.of_test` says how many those are).
    """
    known = error[np.isfinite(error).all(axis=1)]
    if not len(known):
        return {"contours": 0, "worst": None, "mean": None, "worst_spread": None, "mean_spread": None}
    (worst, mean), spread = known.mean(axis=0), known.std(axis=0) / np.sqrt(len(known))
    return {
        "contours": len(known),
        "worst": float(worst),
        "mean": float(mean),
        "worst_spread": float(spread[0]),
        "mean_spread": float(spread[1]),
    }


def populations(config: dict, n: int) -> tuple[Population, Population]:
    """The training and the test population of N_C = n."""
    return load(config, "train", n), load(config, "test", n)


def write(config: dict, name: str, found: object) -> None:
    """Keep what an experiment found for the report (training/paper/results/, in the repository)."""
    file: Path = config["folders"]["results"] / f"{name}.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(found, indent=1))


def known(config: dict, name: str) -> list:
    """The rows that an experiment has left, none where it has not been made."""
    return read(config, name) if (config["folders"]["results"] / f"{name}.json").exists() else []


def read(config: dict, name: str) -> object:
    """What an experiment has left."""
    file: Path = config["folders"]["results"] / f"{name}.json"
    if not file.exists():
        raise FileNotFoundError(f"no {file}: run the experiments first, see training/paper/__init__.py")
    return json.loads(file.read_text())
