"""Batches of the whole scheme: a contour's mesh depends on nothing but the contour, and nothing is kept."""

import gc
import sys
from functools import cache
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera.assembly import mean_edge_lengths, middles, wanted_edge_lengths
from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch
from tests.library.adversaries import padded, sector, with_straight_runs

COUNT = 60


@cache
def fixed_set() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Contours of 3 to 16 edges (COUNT, 16, 2), n_contour and edge lengths (COUNT,)."""
    polygons = [(sector, with_straight_runs)[seed % 2](seed) for seed in range(COUNT)]
    points, n_contour, _ = padded([(polygon, np.zeros((0, 2))) for polygon in polygons])
    return points, n_contour, np.random.default_rng(0).uniform(0.3, 1, COUNT)


def meshes(rows, flips: bool) -> list[tuple]:
    """Each row's inner vertices, triangles and fallbacks, of one batch of rows of the fixed set."""
    points, n_contour, edge_length = (values[rows] for values in fixed_set())
    points = points[:, : n_contour.max()]
    result = mesh_contours(points, n_contour, edge_length, Stopwatch(), flips)
    return [
        (result.inner[k, :n].tolist(), result.triangles[result.owner == k].tolist(), int(result.fallbacks[k]))
        for k, n in enumerate(result.n_inner)
    ]


@cache
def together(flips: bool) -> list[tuple]:
    return meshes(np.arange(COUNT), flips)


def test_the_fixed_set_is_of_all_sizes():
    assert set(fixed_set()[1]) >= set(range(3, 17)) and len({len(inner) for inner, _, _ in together(False)}) > 10
    assert together(True) != together(False)


@settings(deadline=None, max_examples=15)
@given(st.permutations(range(COUNT)), st.sets(st.integers(1, COUNT - 1), max_size=6), st.booleans())
def test_any_order_and_any_split_give_the_same_meshes(order, cuts, flips):
    parts = np.split(np.array(order), sorted(cuts))
    found = [mesh for part in parts for mesh in meshes(part, flips)]
    assert found == [together(flips)[row] for row in order]


def test_one_by_one_gives_the_same_meshes():
    assert [meshes([row], False)[0] for row in range(COUNT)] == together(False)


def resident() -> int:
    """Bytes of this process that are in memory."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.split("VmRSS:")[1].split()[0])


def test_memory_does_not_grow_over_calls():
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]

    def held_after(calls: int) -> tuple[int, int]:
        for _ in range(calls):
            tessera.mesh_contour(square, 0.7)
        gc.collect()
        return resident(), sys.getallocatedblocks()

    before = held_after(100)
    after = held_after(1000)
    assert after[0] - before[0] < 2e6, "bytes of the process, with all that onnxruntime holds"
    # What each call left behind would be 1 000 objects, an array being one; stores of small pieces fill with some 250.
    assert after[1] - before[1] < 500, "objects of Python"


def test_lengths_of_cells_do_not_depend_on_their_padding():
    """To the last bit: the widest cell of a batch is no matter of the others."""
    rng = np.random.default_rng(7)
    count = rng.integers(3, 16, 300)[:, None]
    angle = 2 * np.pi * (np.arange(20) + rng.uniform(-0.3, 0.3, (300, 20))) / count
    points = np.stack([np.cos(angle), np.sin(angle)], axis=-1).reshape(-1, 2)
    cells = np.where(np.arange(20) < count, np.arange(6000).reshape(300, 20), -1)
    owner = np.zeros(300, dtype=np.int64)

    def target(points, owner):
        return 1 + 0.1 * np.abs(points).sum(axis=1)

    for width in (15, 16, 17):
        narrow = cells[:, :width]
        np.testing.assert_array_equal(mean_edge_lengths(points, narrow), mean_edge_lengths(points, cells))
        np.testing.assert_array_equal(middles(points, narrow), middles(points, cells))
        one, other = (wanted_edge_lengths(points, of, owner, target) for of in (narrow, cells))
        np.testing.assert_array_equal(one, other)
