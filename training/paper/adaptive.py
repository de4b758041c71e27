"""Table 1 and Fig. 26: ``python -m training.paper.adaptive``. NN3* by adaptive and by random sampling.

For N_I = 1, 2 and 4, eight NN3* side by side: two samplings at four confidence levels, whose sizes are the paper's. A
sample is a contour with N_I inner vertices and one of its edges; what is learnt is that edge's row of the table.
"""

from __future__ import annotations

import numpy as np
import torch

from tessera.paper_placement import grid_points

from .. import tables
from . import settings
from .batches import from_rows
from .comparing import as_roles, populations, test_group, write
from .data import Group
from .export import star_sorts
from .networks import nn3_star, one_of
from .sampling import APART, GRID, kept_tables, random_groups
from .stages import given_connected
from .surfaces import APART_OF_SEVERAL, inside, quality_surfaces, sampled
from .train import chosen, run


def main() -> None:
    """Train, measure, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    compare_samplings(config)


def compare_samplings(config: dict) -> None:
    """All three numbers of inner vertices."""
    torch.set_num_threads(1)
    found = []
    for m in config["nn3_star"]["groups"]:
        found += of_number(config, m)
        own = [row for row in found if row["m"] == m]
        print(f"N_I {m}: " + ", ".join(f"{row['sampling']} {row['size']}: {row['worst']} %" for row in own), flush=True)
    write(config, "adaptive", found)


def of_number(config: dict, m: int) -> list[dict]:
    """The eight NN3* of a number of inner vertices, each measured on the test group."""
    star, n = config["nn3_star"], config["nn3_star"]["n_contour"]
    trained, tested = populations(config, n)
    group = chosen(trained.group(m), star["contours"])
    sorts, found = star_sorts(config), {}
    for sampling in ("random", "adaptive"):
        found[sampling] = samples_of(config, group, sampling)
    sizes = [star[sampling][str(m)][star["levels"].index(level)] for sampling, level in sorts]
    parts = [rows(found[sampling], n, size) for (sampling, _), size in zip(sorts, sizes, strict=True)]
    net, notes = run(
        config,
        "nn3_star",
        f"nn3_star_{n}_{m}",
        lambda: nn3_star(n, m, len(sorts)),
        lambda: (from_rows(parts), [len(part[0]) for part in parts]),
        {"sorts": sorts, "contours": len(group)},
    )
    test, results = test_group(config, trained, tested, m), []
    for number, ((sampling, level), size) in enumerate(zip(sorts, sizes, strict=True)):
        single = one_of(net.state_dict(), nn3_star(n, m), number)
        row = {"m": m, "sampling": sampling, "level": level, "size": size, "contours learnt from": len(group)}
        population = float(found[sampling]["population"].mean())
        row |= {"population": population, "epochs": notes["epochs"][number], "loss": notes["curve"][-1][1][number]}
        results.append(row | given_connected(as_roles(single, n, m, by_row=True), test))
    return results


def samples_of(config: dict, group: Group, sampling: str) -> dict[str, np.ndarray]:
    """The `samples` of a group at the highest confidence level, made once."""
    star, (n, m) = config["nn3_star"], (group.contour.shape[1], group.inner.shape[1])
    file = config["folders"]["data"] / f"star-{sampling}-{n:02d}-{m:02d}-{len(group)}.npz"
    return kept_tables(file, lambda: samples(star["seed"], group, sampling, star[sampling][str(m)][-1]))


def samples(seed: int, group: Group, sampling: str, size: int) -> dict[str, np.ndarray]:
    """So many samples of each contour: points (K, V, 2), edge (K,), that edge's row of the table (K, V), mesh (K,).

    population: (k,) of how many inner vertices a contour's samples were drawn.
    """
    n, m = group.contour.shape[1], group.inner.shape[1]
    rng = np.random.default_rng((seed, n, m, sampling == "adaptive"))
    inner, edge, mesh, population = [], [], [], []
    for row in range(len(group)):
        draw = adaptive_vertices if sampling == "adaptive" else random_vertices
        vertices, edges, of = draw(rng, group.contour[row], group.inner[row], group.l_s[row], size)
        inner.append(vertices)
        edge.append(edges)
        mesh.append(np.full(len(edges), row))
        population.append(of)
    edge, mesh = np.concatenate(edge), np.concatenate(mesh)
    points = np.concatenate([group.contour[mesh], np.concatenate(inner)], axis=1)
    table = np.concatenate(
        [
            tables.connection_tables(points[part], np.full(len(part), n), np.full(len(part), m))[
                np.arange(len(part)), edge[part], :, 0
            ]
            for part in np.array_split(np.arange(len(points)), -(-len(points) // 2000))
        ]
    )
    return {
        "points": points.astype(np.float32),
        "edge": edge,
        "row": table,
        "mesh": mesh,
        "population": np.array(population),
    }


def random_vertices(rng: np.random.Generator, contour: np.ndarray, inner: np.ndarray, l_s: float, size: int) -> tuple:
    """Random vertices (s, N_I, 2) of the grid, each with a random edge (s,), and how many there were to draw from."""
    places = grid_points(GRID)[inside(contour, l_s)]
    vertices = random_groups(rng, places, len(inner), size, APART * l_s)
    return vertices, rng.integers(0, len(contour), len(vertices)), len(inner) * len(places)


def adaptive_vertices(rng: np.random.Generator, contour: np.ndarray, inner: np.ndarray, l_s: float, size: int) -> tuple:
    """Vertices (s, N_I, 2) sampled from the surfaces S_ni of an edge each, those edges (s,), how many there were."""
    n, m, spots = len(contour), len(inner), inside(contour, l_s)
    numbers = [sampled(rng, quality_surfaces(contour, np.delete(inner, k, axis=0), spots), spots) for k in range(m)]
    places = grid_points(GRID)[np.stack(numbers, axis=1)]  # (N_C, N_I, 45, 2)
    each = places.shape[2]
    if m == 1:
        drawn = rng.permutation(n * each)[:size]
        edge = drawn // each
        return places[edge, 0, drawn % each][:, None], edge, n * each
    vertices, edges = np.zeros((0, m, 2)), np.zeros(0, dtype=np.int64)
    for _ in range(20):
        if len(edges) >= size:
            break
        edge = rng.integers(0, n, 3 * size)
        drawn = places[edge[:, None], np.arange(m), rng.integers(0, each, (3 * size, m))]
        away = np.linalg.norm(drawn[:, :, None] - drawn[:, None], axis=-1) + 10 * np.eye(m)
        apart = (away >= APART_OF_SEVERAL * l_s).all(axis=(1, 2))
        vertices, edges = np.concatenate([vertices, drawn[apart]]), np.concatenate([edges, edge[apart]])
    return vertices[:size], edges[:size], m * n * each


def rows(found: dict[str, np.ndarray], n_contour: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """NN3*'s rows, and the answers, of the first ``size`` samples of each contour."""
    first = np.searchsorted(found["mesh"], found["mesh"])
    kept = np.flatnonzero(np.arange(len(first)) - first < size)
    edges = np.eye(n_contour)[found["edge"][kept]]
    given = np.concatenate([found["points"][kept].reshape(len(kept), -1), edges], axis=1)
    return given.astype(np.float32), found["row"][kept].astype(np.float32)


if __name__ == "__main__":
    main()
