"""Figs. 22, 24, 25 and 27: ``python -m training.paper.stages 22 [N_C ...]``. A stage alone (27: the whole scheme).

By groups (N_C, N_I) of test contours, by the paper's networks where the group was trained and by the shipped ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from tessera import paper
from tessera.placement import MOST_INNER
from tessera.roles import Roles
from tessera.scheme import connect, join_vertices, mesh_contours
from tessera.stopwatch import Stopwatch
from tessera.triangulation import Connect, triangulate

from .. import tables
from ..evaluate.meshers import by_delaunay, of_scheme
from ..evaluate.meshes import Meshes, measure
from . import settings
from .comparing import (
    PAPER,
    as_contours,
    asking,
    compared,
    errors,
    known,
    mean_errors,
    populations,
    test_group,
    write,
)
from .data import Group, Population

FIGURES = (22, 24, 25, 27)


def main() -> None:
    """Compare all stages, and keep what was found."""
    config, arguments = settings.from_command_line(
        __doc__,
        ("figure", {"type": int, "choices": FIGURES}),
        ("edges", {"nargs": "*", "type": int, "metavar": "N_C"}),
    )
    compare(config, arguments.figure, arguments.edges)


def compare_all(config: dict) -> None:
    """All four figures."""
    for figure in FIGURES:
        compare(config, figure)


def compare(config: dict, figure: int, edges: Sequence[int] = ()) -> None:
    """A figure's groups of some numbers of edges, or of all; what is there of others stays."""
    roles, edges = compared(config), edges or list(config["data"]["train"])
    found = [row for row in known(config, f"fig_{figure}") if row["n"] not in edges]
    for n in edges:
        rows = list(of_edges(config, roles, figure, n))
        found = sorted([*found, *rows], key=lambda row: row["n"])
        write(config, f"fig_{figure}", found)
        print(f"Fig. {figure}, N_C {n}: {len(rows)} rows", flush=True)


def of_edges(config: dict, roles: dict[str, Roles], figure: int, n: int) -> Iterator[dict]:
    """A figure's rows of one N_C."""
    trained, tested = populations(config, n)
    if figure == 27:
        yield from ({"n": n, **row} for row in whole(config, roles, tested))
        return
    stage = {22: placed, 24: calculated, 25: connected}[figure]
    for m in config["nn2"]["groups"][n]:
        group = test_group(config, trained, tested, m)
        if len(group):
            yield from ({"n": n, "m": m, "figure": figure, **row} for row in stage(config, roles, group))


def placed(config: dict, roles: dict[str, Roles], group: Group) -> list[dict]:
    """Fig. 22: NN2's places of as many vertices as the reference has, by CDT, against the reference's mesh."""
    contours, folder = as_contours(group.contour, group.l_s), config["folders"]["models"]
    m = group.inner.shape[1]
    asked, found = np.full(len(group), min(m, MOST_INNER)), []
    for name, role in roles.items():
        if name == PAPER and not paper.is_trained("nn2", (group.contour.shape[1], m), folder):
            continue
        place = partial(paper.place, folder) if name == PAPER else role.place
        places, count = place(contours.points, contours.n_contour, asked, group.l_s, Stopwatch())
        points = join_vertices(contours.points, contours.n_contour, places, count)
        error = errors(by_delaunay(contours, points, count), contours, group.quality)
        found.append({"networks": name, **mean_errors(error), "incomplete": int((count < m).sum())})
    return found


def calculated(config: dict, roles: dict[str, Roles], group: Group) -> list[dict]:
    """Fig. 24: the reference's vertices, connected by calculated tables, against CDT of them. No network is asked."""

    def table(points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, entries: np.ndarray) -> np.ndarray:
        return tables.connection_tables(points, n_contour, n_inner)[tuple(entries.T)]

    return [{"networks": PAPER, **_triangulated(group, table)}]


def connected(config: dict, roles: dict[str, Roles], group: Group) -> list[dict]:
    """Fig. 25: the reference's vertices, connected by NN3, against CDT of them.

    "rest by CDT": ē_worst where the paper's NN3 has no tables for sub-contours, so that CDT decides there.
    """
    found, folder = [], config["folders"]["models"]
    n, m = group.contour.shape[1], group.inner.shape[1]
    for name, role in roles.items():
        if name != PAPER:
            found.append({"networks": name, **given_connected(role, group)})
        elif paper.is_trained("nn3", (n, m), folder):
            rest = given_connected(asking(paper.table_network(folder, n, m), n, m, by_row=False), group)["worst"]
            found.append({"networks": name, **given_connected(role, group), "rest by CDT": rest})
    return found


def given_connected(role: Roles, group: Group) -> dict:
    """Mean errors of the reference's vertices connected by NN3, against CDT of them, and elements without a table."""
    return _triangulated(group, lambda *rest: connect(*rest, Stopwatch(), role))


def _triangulated(group: Group, table: Connect) -> dict:
    contours, n_inner = as_contours(group.contour, group.l_s), np.full(len(group), group.inner.shape[1])
    points = join_vertices(contours.points, contours.n_contour, group.inner, n_inner)
    reference = measure(by_delaunay(contours, points, n_inner), group.l_s)[:, :2]
    made = triangulate(points, contours.n_contour, n_inner, table)
    meshes = Meshes(points, contours.n_contour, n_inner, made.triangles.astype(np.int64), made.owner.astype(np.int64))
    fallbacks = made.fallbacks.sum() / max(1, len(group))
    return {**mean_errors(errors(meshes, contours, reference)), "fallbacks": float(fallbacks)}


def whole(config: dict, roles: dict[str, Roles], tested: Population) -> list[dict]:
    """Fig. 27: contours and target edge lengths alone, by the number of inner vertices that the paper's NN1 asks for.

    The shipped networks mesh the same contours, of whatever number of vertices they ask for.
    """
    n, targets = tested.contour.shape[1], len(tested.targets)
    contours = as_contours(np.repeat(tested.contour, targets, axis=0), np.tile(tested.targets, len(tested.contour)))
    wanted = roles[PAPER].count(contours.points, contours.n_contour, contours.l_s)
    quality, found = tested.quality.reshape(-1, 2), []
    share = {"meshes": len(contours), "in trained groups": 0}
    for m in paper.groups("paper", config["folders"]["models"]).get(n, ()):
        rows = np.flatnonzero(wanted == m)
        share["in trained groups"] += len(rows)
        rows = np.random.default_rng(m).permutation(rows)[: config["test"]["contours"]]
        for name, role in roles.items() if len(rows) else ():
            part = contours.rows(rows)
            made = mesh_contours(part.points, part.n_contour, part.l_s, Stopwatch(), roles=role)
            error = errors(of_scheme(part, made), part, quality[rows])
            row = {"figure": 27, "m": m, "networks": name, **mean_errors(error)}
            found.append({**row, "fallbacks": float(made.fallbacks.mean())})
    return [*found, {"figure": 27, "m": None, "networks": None, **share}]


if __name__ == "__main__":
    main()
