"""The evaluation on all cores: sets of contours in chunks, each drawn and meshed by one process."""

from __future__ import annotations

import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from tqdm import tqdm

from tessera.placement import place_inner_vertices
from tessera.scheme import join_vertices
from tessera.stopwatch import Stopwatch

from .. import contours, running, tables
from .sets import Contours, sector
from .stages import Results, find, join

SECTOR, REFINEMENT, REAL = "sector contours", "refinement's own contours", "real contours"


def find_all(test: dict, seed: int, processes: int) -> dict[str, Results]:
    """Results of the three sets, sector contours first.

    test: the configuration's section; counts of sector contours are rounded up to whole chunks. The teacher has all
    contours of the other two sets.
    """
    chunk = test["chunk"]
    close, count = -(-test["close"] // chunk), -(-test["contours"] // chunk)
    # Raises if a process is killed, instead of waiting for it.
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        others = {
            REFINEMENT: pool.submit(running.refinement_contours, seed, test["others"]),
            REAL: pool.submit(running.real_contours, test["others"]),
        }
        drawn = list(pool.map(sector, [chunk] * count, [(seed, number) for number in range(count)]))
        jobs = [(SECTOR, part, number < close, test["smooth"]) for number, part in enumerate(drawn)]
        for name, found in others.items():
            jobs += [(name, part, True, test["smooth"]) for part in _chunks(Contours(*found.result()), chunk)]
        parts: dict[str, list[Results]] = {name: [] for name in (SECTOR, *others)}
        for name, part in tqdm(pool.map(_work, jobs), total=len(jobs), unit="chunk"):
            parts[name].append(part)
    return {name: join(found) for name, found in parts.items()}


def _work(job: tuple[str, Contours, bool, int]) -> tuple[str, Results]:
    name, part, is_close, steps = job
    return name, find(part, is_close, steps)


def _chunks(whole: Contours, size: int) -> list[Contours]:
    return [whole.rows(slice(first, first + size)) for first in range(0, len(whole), size)]


def time_tables(seed: int, count: int = 200) -> float:
    """Mean milliseconds, on one core, of a connection table at 16 edges and 12 inner vertices."""
    rng = np.random.default_rng(seed)
    points = np.stack([contours.transformed_sector(rng, 16) for _ in range(count)])
    n_contour, n_inner = np.full(count, 16), np.full(count, 12)
    inner, placed = place_inner_vertices(points, n_contour, n_inner, Stopwatch())
    vertices = join_vertices(points, n_contour, inner, placed)
    tables.connection_tables(vertices[:1], n_contour[:1], placed[:1])
    start = time.perf_counter()
    tables.connection_tables(vertices, n_contour, placed)
    return 1e3 * (time.perf_counter() - start) / count
