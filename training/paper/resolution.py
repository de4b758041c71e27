"""Fig. 21: ``python -m training.paper.resolution``. NN2 for one inner vertex on grids of 10, 20 and 40."""

from __future__ import annotations

import numpy as np
import torch

from tessera.paper import score_patches
from tessera.paper_placement import decode

from . import settings
from .batches import from_groups
from .comparing import as_contours, populations, write
from .data import Group
from .networks import Network, nn2, one_of
from .train import chosen, run


def main() -> None:
    """Train, measure, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    compare_grids(config)


def compare_grids(config: dict) -> None:
    """The three grids side by side, for each N_C of which the reference makes enough meshes with one inner vertex."""
    torch.set_num_threads(1)
    wanted, found = config["resolution"], []
    grids = wanted["grids"]
    for n in config["data"]["train"]:
        trained, tested = populations(config, n)
        group, test = trained.group(1), tested.group(1).rows(slice(wanted["contours"]))
        if min(len(group), len(test)) < wanted["fewest"]:
            continue
        group = chosen(group, config["nn2"]["meshes"])
        net, notes = run(
            config,
            "nn2",
            f"resolution_{n}",
            lambda n=n: nn2(n, len(grids)),
            lambda group=group: (from_groups([group] * len(grids), grids), [len(group) * (g // 2) ** 2 for g in grids]),
            {"meshes": len(group)},
            wanted["steps"],
            wanted["seed"],
        )
        for number, grid in enumerate(grids):
            apart = squared_distances(one_of(net.state_dict(), nn2(n), number), test, grid)
            row = {"n": n, "grid": grid, "contours": len(test), "meshes": len(group), "error": float(apart.mean())}
            found.append({**row, "spread": float(apart.std() / len(apart) ** 0.5), "epochs": notes["epochs"][number]})
        print(f"N_C {n}: " + ", ".join(f"{row['error']:.4f}" for row in found if row["n"] == n), flush=True)
    write(config, "resolution", found)


def squared_distances(net: Network, group: Group, resolution: int) -> np.ndarray:
    """(k,) squared distance of the vertex that is placed to the reference's one."""

    def ask(rows: np.ndarray) -> np.ndarray:
        with torch.no_grad():
            return net(torch.as_tensor(rows, dtype=torch.float32)[None])[0].numpy()

    contours = as_contours(group.contour, group.l_s)
    given = np.concatenate([group.contour.reshape(len(group), -1), group.l_s[:, None]], axis=1)
    scores = score_patches(ask, given, resolution)
    inner, count = decode(scores, contours.points, contours.n_contour, np.ones(len(group), dtype=np.int64), group.l_s)
    return ((inner[:, 0] - group.inner[:, 0]) ** 2).sum(axis=-1)[count == 1]


if __name__ == "__main__":
    main()
