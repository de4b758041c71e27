"""Learning curves over populations: ``python -m training.paper.learning``. What larger populations would give.

For one NN1, NN2, NN3 and NN3* each, networks of shares of the population are trained side by side for as many steps,
and measured on the test population.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch

from tessera.paper_placement import GRID, grid_points, patches

from . import settings
from .adaptive import rows, samples_of
from .batches import count_rows, from_groups, from_rows, from_tables, mixed, scores
from .comparing import populations, test_group, write
from .data import Group
from .networks import Network, nn1, nn2, nn3, nn3_star
from .sampling import reference_tables
from .train import chosen, run, tables_of


def main() -> None:
    """Train, measure, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    measure_curves(config)


def measure_curves(config: dict) -> None:
    """All four curves: contours or meshes learnt from, and the loss on test contours."""
    torch.set_num_threads(1)
    found = [curve(config) for curve in (count_curve, score_curve, table_curve, star_curve)]
    for row in found:
        print(
            f"{row['role']}: "
            + ", ".join(f"{a}: {b:.4g}" for a, b in zip(*(row[k] for k in ("size", "loss")), strict=True))
        )
    write(config, "learning", found)


def count_curve(config: dict) -> dict:
    """NN1: contours, and the mean absolute error of N_I."""
    wanted, shares = config["learning"]["nn1"], config["learning"]["shares"]
    n = wanted["n_contour"]
    trained, tested = populations(config, n)
    sizes = [max(1, round(share * len(trained.contour))) for share in shares]
    net, notes = run(
        config,
        "nn1",
        f"learning_nn1_{n}",
        lambda: nn1(n, len(shares)),
        lambda: (
            from_rows([count_rows(trained.head(size)) for size in sizes]),
            [size * trained.n_inner.shape[1] for size in sizes],
        ),
        None,
        wanted["steps"],
        config["learning"]["seed"],
    )
    given, answer = count_rows(tested)
    loss = _asked(net, given, lambda out: np.abs(out - answer).mean())
    return {
        "role": "NN1",
        "n": n,
        "what": "mean absolute error of N_I",
        "of": "contours",
        "size": sizes,
        "loss": loss,
    } | by_steps(notes)


def score_curve(config: dict) -> dict:
    """NN2: meshes of the group, and the root mean square error of the scores."""
    wanted, shares = config["learning"]["nn2"], config["learning"]["shares"]
    n, m = wanted["n_contour"], wanted["n_inner"]
    trained, tested = populations(config, n)
    group = chosen(trained.group(m), len(trained.contour))
    parts = [group.rows(slice(max(1, round(share * len(group))))) for share in shares]
    sizes = [len(part) for part in parts]
    net, notes = run(
        config,
        "nn2",
        f"learning_nn2_{n}_{m}",
        lambda: nn2(n, len(shares)),
        lambda: (from_groups(parts, [GRID] * len(parts)), [size * (GRID // 2) ** 2 for size in sizes]),
        None,
        wanted["steps"],
        config["learning"]["seed"],
    )
    given, answer = score_rows(test_group(config, trained, tested, m))
    loss = _asked(net, given, lambda out: np.sqrt(np.square(out - answer).mean()))
    what = "root mean square error of the scores"
    return {
        "role": "NN2",
        "n": n,
        "m": m,
        "what": what,
        "of": "meshes of the group",
        "size": sizes,
        "loss": loss,
    } | by_steps(notes)


def score_rows(group: Group) -> tuple[np.ndarray, np.ndarray]:
    """All rows of NN2 for a group, and their answers."""
    number = patches(GRID)
    places = grid_points(GRID)[number].reshape(len(number), -1)
    given = np.concatenate([group.contour.reshape(len(group), -1), group.l_s[:, None]], axis=1)
    rows = np.concatenate([np.repeat(given, len(places), axis=0), np.tile(places, (len(given), 1))], axis=1)
    return rows.astype(np.float32), scores(group, GRID)[:, number].reshape(len(rows), -1)


def table_curve(config: dict) -> dict:
    """NN3: meshes of the group, each with its random vertices, and the root mean square error of the table."""
    wanted, shares = config["learning"]["nn3"], config["learning"]["shares"]
    n, m = wanted["n_contour"], wanted["n_inner"]
    trained, tested = populations(config, n)
    found = tables_of(config, trained, m)
    parts = [[first_meshes(part, share) for part in found] for share in shares]
    sizes = [len(reference["points"]) for _, reference in parts]
    net, notes = run(
        config,
        "nn3",
        f"learning_nn3_{n}_{m}",
        lambda: nn3(n, m, len(shares)),
        lambda: (
            from_tables([mixed(random, (reference, config["nn3"]["share"])) for random, reference in parts]),
            [sum(len(tables["points"]) for tables in part) for part in parts],
        ),
        None,
        wanted["steps"],
        config["learning"]["seed"],
    )
    test = reference_tables(test_group(config, trained, tested, m))
    given, answer = (test[name].reshape(len(test["mesh"]), -1) for name in ("points", "table"))
    loss = _asked(net, given, lambda out: np.sqrt(np.square(out - answer).mean()))
    what = "root mean square error of the table's entries"
    return {
        "role": "NN3",
        "n": n,
        "m": m,
        "what": what,
        "of": "meshes of the group",
        "size": sizes,
        "loss": loss,
    } | by_steps(notes)


def star_curve(config: dict) -> dict:
    """NN3*: contours, each with its adaptive samples, and the root mean square error of the table's rows."""
    wanted, star, shares = config["learning"]["nn3_star"], config["nn3_star"], config["learning"]["shares"]
    n, m = star["n_contour"], wanted["n_inner"]
    trained, tested = populations(config, n)
    group = chosen(trained.group(m), star["contours"])
    found = {name: part for name, part in samples_of(config, group, "adaptive").items() if name != "population"}
    parts = [rows(first_meshes(found, share), n, star["adaptive"][str(m)][-1]) for share in shares]
    net, notes = run(
        config,
        "nn3_star",
        f"learning_nn3_star_{n}_{m}",
        lambda: nn3_star(n, m, len(shares)),
        lambda: (from_rows(parts), [len(given) for given, _ in parts]),
        None,
        wanted["steps"],
        config["learning"]["seed"],
    )
    test = reference_tables(test_group(config, trained, tested, m))
    each = {"points": np.repeat(test["points"], n, axis=0), "mesh": np.arange(n * len(test["mesh"]))}
    each["edge"] = np.tile(np.arange(n), len(test["mesh"]))
    each["row"] = test["table"].reshape(len(each["mesh"]), -1)
    given, answer = rows(each, n, 1)
    loss = _asked(net, given, lambda out: np.sqrt(np.square(out - answer).mean()))
    return {
        "role": "NN3*",
        "n": n,
        "m": m,
        "what": "root mean square error of the table's rows",
        "of": "contours",
        "size": [max(1, round(share * len(group))) for share in shares],
        "loss": loss,
    } | by_steps(notes)


def first_meshes(found: dict[str, np.ndarray], share: float) -> dict[str, np.ndarray]:
    """The tables of the first meshes, so large a share of them."""
    kept = found["mesh"] < max(1, round(share * (found["mesh"].max() + 1)))
    return {name: array[kept] for name, array in found.items()}


def by_steps(notes: dict) -> dict:
    """The training loss of the network of the largest population, over the batches that it has seen."""
    return {"steps": [step for step, _ in notes["curve"]], "training": [loss[-1] for _, loss in notes["curve"]]}


def _asked(net: Network, given: np.ndarray, measure) -> Sequence[float]:
    """A measure of each network's answers."""
    count = next(net.parameters()).shape[0]
    with torch.no_grad():
        out = net(torch.as_tensor(given).float().expand(count, -1, -1)).numpy()
    return [float(measure(part)) for part in out]


if __name__ == "__main__":
    main()
