"""What NN3 learns from (section 2.5.2): ``python -m training.paper.mixture``. The share of vertices of good meshes.

By the paper a contour has the reference's vertices once, and 50 to 200 groups of random ones beside, which may be as
close to each other as 0.1 l_s, so that hardly any could belong to a good mesh. Four NN3 of one group see as many
batches: with the paper's share of the reference's vertices, with the share that is trained with, with no others, and
with half of that share placed by NN2, as those are that it meets in use.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from tessera import paper
from tessera.stopwatch import Stopwatch

from . import settings
from .batches import from_tables, mixed
from .comparing import as_contours, as_roles, populations, test_group, write
from .data import Group
from .networks import nn3, one_of
from .sampling import groups_per_contour, reference_tables
from .stages import given_connected
from .train import chosen, run, tables_of


def main() -> None:
    """Train, measure, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    compare_shares(config)


def compare_shares(config: dict) -> None:
    """ē_worst of NN3 alone by share, on the reference's vertices and on those that NN2 places, of the test group.

    Beside it, of the tables that are learnt from, the mean of what each facet's best entry is.
    """
    torch.set_num_threads(1)
    wanted = config["mixture"]
    n, m = wanted["n_contour"], wanted["n_inner"]
    trained, tested = populations(config, n)
    tables = dict(zip(("random", "reference"), tables_of(config, trained, m), strict=True))
    tables["placed"] = reference_tables(placed(config, chosen(trained.group(m), config["nn3"]["references"])))
    shares = shares_of(config, m)
    net, _ = run(
        config,
        "nn3",
        f"mixture_{n}_{m}",
        lambda: nn3(n, m, len(shares)),
        lambda: (
            from_tables([mixed(tables["random"], *((tables[k], v) for k, v in share.items())) for share in shares]),
            [sum(len(part["points"]) for part in tables.values())] * len(shares),
        ),
        None,
        wanted["steps"],
        wanted["seed"],
    )
    group, rows = test_group(config, trained, tested, m), []
    groups = {"the reference's": group, "NN2's": placed(config, group)}
    for number, share in enumerate(shares):
        role = as_roles(one_of(net.state_dict(), nn3(n, m), number), n, m, by_row=False)
        of = {name: given_connected(role, part) for name, part in groups.items()}
        rows.append({"share": share, "vertices": of})
        print(f"{share}: " + ", ".join(f"{name} {part['worst']} %" for name, part in of.items()), flush=True)
    best = {name: float(part["table"].max(axis=2).mean(dtype=np.float64)) for name, part in tables.items()}
    write(config, "mixture", {"n": n, "m": m, "steps": wanted["steps"], "best": best, "shares": rows})


def shares_of(config: dict, n_inner: int) -> list[dict[str, float]]:
    """The shares of the reference's vertices, and of NN2's, that are compared; the rest are random."""
    share = config["nn3"]["share"]
    paper_share = 1 / (1 + groups_per_contour(n_inner))
    return [
        {"reference": paper_share},
        {"reference": share},
        {"reference": 1.0},
        {"reference": share / 2, "placed": share / 2},
    ]


def placed(config: dict, group: Group) -> Group:
    """A group with NN2's vertices for the reference's, without the meshes that NN2 places fewer in."""
    contours, m = as_contours(group.contour, group.l_s), group.inner.shape[1]
    asked = np.full(len(group), m), group.l_s, Stopwatch()
    inner, count = paper.place(config["folders"]["models"], contours.points, contours.n_contour, *asked)
    return replace(group, inner=inner).rows(np.flatnonzero(count == m))


if __name__ == "__main__":
    main()
