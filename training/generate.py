"""Generate the data: ``python -m training.generate [train|validation] [--shards N] [--processes N]``.

A shard is a file of contours, made from a seed of its own; a file that is there is not made again, and one that was
being made when the run was killed was never given its name.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
from pathlib import Path

import numpy as np
from tqdm import tqdm

from . import configuration, contours, meshing, reference


def solve(points: np.ndarray, l_s: float, sweeps: int) -> dict | None:
    """Reference and teacher of one transformed contour, or None where the mesh has no use as an example.

    Returns inner (N_I, 2), the teacher's vertices, and ``reference`` and ``teacher``, each (q_worst, q_mean).
    """
    n = len(points)
    vertices, elements = reference.mesh(points, l_s)
    if len(vertices) < n or not np.allclose(vertices[:n], points, atol=1e-9):
        return None
    total = len(vertices)
    opposite = np.full((total, total), -1, dtype=np.int64)
    for a, b, c in elements:
        meshing.add(opposite, a, b, c)
    before = meshing.qualities(vertices, opposite, total)
    if before[0] <= 0:
        return None
    meshing.improve(vertices, opposite, n, total, sweeps)
    return {
        "inner": vertices[n:],
        "reference": before,
        "teacher": meshing.qualities(vertices, opposite, total),
    }


def make_shard(seed: tuple[int, ...], size: int, config: dict, kinds: list[str]) -> dict[str, np.ndarray]:
    """Arrays of ``size`` examples: padded contours and inner vertices, their counts, l_s, kind, qualities."""
    rng = np.random.default_rng(seed)
    reference.start()
    most = config["largest_inner"]
    shares = np.array([config["shares"][kind] for kind in kinds])
    shard = {
        "contour": np.zeros((size, contours.LARGEST_CONTOUR, 2), np.float32),
        "inner": np.zeros((size, most, 2), np.float32),
        "n_contour": np.zeros(size, np.int8),
        "n_inner": np.zeros(size, np.int8),
        "l_s": np.zeros(size, np.float32),
        "kind": np.zeros(size, np.int8),
        "reference": np.zeros((size, 2), np.float32),
        "teacher": np.zeros((size, 2), np.float32),
    }
    row = 0
    while row < size:
        kind = int(rng.choice(len(kinds), p=shares / shares.sum()))
        points, l_s = contours.draw(rng, kinds[kind])
        solution = solve(points, l_s, config["sweeps"])
        if solution is None or len(solution["inner"]) > most:
            continue
        n, m = len(points), len(solution["inner"])
        shard["contour"][row, :n], shard["n_contour"][row] = points, n
        shard["inner"][row, :m], shard["n_inner"][row] = solution["inner"], m
        shard["l_s"][row], shard["kind"][row] = l_s, kind
        shard["reference"][row], shard["teacher"][row] = solution["reference"], solution["teacher"]
        row += 1
    return shard


def work(job: tuple[Path, tuple[int, ...], dict]) -> Path:
    """Make one shard's file, under another name until it is whole."""
    path, seed, config = job
    shard = make_shard(seed, config["shard"], config, list(contours.KINDS))
    unfinished = path.with_suffix(f".{os.getpid()}.part")
    with open(unfinished, "wb") as file:
        np.savez(file, **shard)
    unfinished.rename(path)
    return path


def main() -> None:
    """Make the shards that are missing."""
    config = configuration.read()["data"]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("split", nargs="?", default="train", choices=["train", "validation"])
    parser.add_argument("--shards", type=int, help="how many (default: the configuration's)")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    folder = configuration.ROOT / config["folder"] / arguments.split
    folder.mkdir(parents=True, exist_ok=True)
    seed = config["seeds"][arguments.split]
    count = arguments.shards or config["shards"][arguments.split]
    jobs = [(folder / f"{i:05d}.npz", (seed, i), config) for i in range(count)]
    jobs = [job for job in jobs if not job[0].exists()]
    with multiprocessing.get_context("spawn").Pool(arguments.processes) as pool:
        for _ in tqdm(pool.imap_unordered(work, jobs), total=len(jobs), unit="shard"):
            pass


if __name__ == "__main__":
    main()
