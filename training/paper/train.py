"""Train the paper's networks: ``python -m training.paper.train [nn1 nn2 nn3]``.

By N_C: NN1, then all NN2 side by side, then one NN3 after the other. A run that was killed goes on from the checkpoints
in ``runs/paper/``. Those of single figures are trained by the figures' own commands.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch

from tessera.paper_placement import GRID

from ..provenance import code_version
from . import settings
from .batches import count_rows, from_groups, from_rows, from_tables, mixed
from .data import Group, Population, load
from .fitting import BATCH, fit
from .networks import Network, nn1, nn2, nn3
from .sampling import drawn_in, kept_tables, random_tables, reference_tables

ROLES = ("nn1", "nn2", "nn3")


def main() -> None:
    """Train the roles of the command line, or all."""
    config, arguments = settings.from_command_line(__doc__, ("roles", {"nargs": "*", "metavar": "ROLE"}))
    train_all(config, arguments.roles or ROLES)


def train_all(config: dict, roles: tuple[str, ...] = ROLES) -> None:
    """Train what is not trained yet."""
    torch.set_num_threads(1)
    for n in config["data"]["train"]:
        population = load(config, "train", n)
        if "nn1" in roles:
            train_nn1(config, population)
        if "nn2" in roles:
            train_nn2(config, population)
        for n_inner in config["nn3"]["groups"].get(n, ()) if "nn3" in roles else ():
            train_nn3(config, population, n_inner)


def train_nn1(config: dict, population: Population) -> None:
    """Section 2.3, Algorithm 1."""
    n = population.contour.shape[1]
    run(
        config,
        "nn1",
        f"nn1_{n}",
        lambda: nn1(n),
        lambda: (from_rows([count_rows(population)]), [population.n_inner.size]),
    )


def train_nn2(config: dict, population: Population) -> None:
    """Section 2.4, Algorithm 2: all groups of a N_C side by side, each from its own meshes."""
    n = population.contour.shape[1]
    numbers = config["nn2"]["groups"][n]
    groups = [chosen(population.group(m), config["nn2"]["meshes"]) for m in numbers]
    numbers, groups = zip(*((m, group) for m, group in zip(numbers, groups, strict=True) if len(group)), strict=True)
    sizes = [len(group) for group in groups]
    run(
        config,
        "nn2",
        f"nn2_{n}",
        lambda: nn2(n, len(groups)),
        lambda: (from_groups(groups, [GRID] * len(groups)), [size * (GRID // 2) ** 2 for size in sizes]),
        {"numbers": list(numbers), "meshes": sizes},
    )


def train_nn3(config: dict, population: Population, n_inner: int) -> None:
    """Section 2.5, Algorithm 4."""
    n, wanted = population.contour.shape[1], config["nn3"]
    random, reference = tables_of(config, population, n_inner)
    run(
        config,
        "nn3",
        f"nn3_{n}_{n_inner}",
        lambda: nn3(n, n_inner),
        lambda: (
            from_tables([mixed(random, (reference, wanted["share"]))]),
            [len(random["points"]) + len(reference["points"])],
        ),
        {"numbers": [n_inner]},
        wanted["longer"].get(f"{n}_{n_inner}", wanted["steps"]),
    )


def tables_of(config: dict, population: Population, n_inner: int) -> tuple[dict, dict]:
    """What NN3 of a group learns from: tables of random vertices, made once, and of the reference's."""
    n, wanted = population.contour.shape[1], config["nn3"]
    rng = np.random.default_rng((wanted["seed"], n, n_inner))
    file = config["folders"]["data"] / f"tables-{n:02d}-{n_inner:02d}.npz"
    drawn = drawn_in(population, n_inner, wanted["meshes"])
    random = kept_tables(file, lambda: random_tables(rng, *drawn, n_inner))
    group = population.group(n_inner).rows(slice(0 if n_inner == 0 else None))
    return random, reference_tables(chosen(group, wanted["references"]))


def chosen(group: Group, most: int) -> Group:
    """At most so many meshes of a group, from everywhere in it."""
    return group.rows(np.random.default_rng(0).permutation(len(group))[:most])


def run(
    config: dict,
    role: str,
    name: str,
    make: callable,
    prepare: callable,
    notes: dict | None = None,
    steps: int | None = None,
    seed: int | None = None,
) -> tuple[Network, dict]:
    """A run's networks and notes; what is not trained is trained first. ValueError: begun with another population.

    make: the networks; prepare: batches, and each network's number of examples, which is what an epoch is.
    """
    steps, seed = steps or config[role]["steps"], seed or config[role]["seed"]
    file: Path = config["folders"]["runs"] / f"{name}.pt"
    torch.manual_seed(seed)
    net = make()
    begun = torch.load(file, weights_only=False) if file.exists() else None
    if begun is None or begun["step"] < steps:
        draw, examples = prepare()
        if begun is not None and begun["notes"]["examples"] != examples:
            raise ValueError(f"{file} was begun with another population: delete it, or set the population back")
        epochs = [steps * BATCH / count for count in examples]
        about = {"role": role, "seed": seed, "steps": steps, "examples": examples, "epochs": epochs}
        curve = fit(net, draw, steps, role, file, about | {"code": code_version()} | (notes or {}))
        print(f"{name}: {steps} steps, {min(epochs):.0f} to {max(epochs):.0f} epochs, loss {curve[-1][1]}", flush=True)
    state = torch.load(file, weights_only=False)
    net.load_state_dict(state["network"])
    return net.eval(), state["notes"] | {"curve": state["curve"]}


if __name__ == "__main__":
    main()
