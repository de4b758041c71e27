"""All cases meshed and measured, in several processes."""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import tessera

from .cases import Case, all_cases, circle, target_of
from .measures import Measures, measure
from .meshers import Meshed, mesh_all

# One length more or less moves every element of a circle: those around the one of `cases.paper_cases`.
LENGTHS = np.linspace(0.096, 0.104, 9)

# Cases, with meshes and measures by mesher.
Found = list[tuple[Case, dict[str, Meshed], dict[str, Measures]]]


def mesh_cases(numbers: Sequence[int], processes: int) -> Found:
    """Some of `all_cases`, meshed and measured in several processes."""
    cases = all_cases()
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        # The last take longest.
        parts = list(pool.map(mesh_case, list(numbers)[::-1]))[::-1]
    return [(cases[number], *part) for number, part in zip(numbers, parts, strict=True)]


def mesh_case(number: int) -> tuple[dict[str, Meshed], dict[str, Measures]]:
    """One of `all_cases`, by its number, as a case cannot go to another process: meshes and measures by mesher."""
    case = all_cases()[number]
    meshes, target = mesh_all(case), target_of(case)
    return meshes, {name: measure(mesh, target, case.left_out) for name, mesh in meshes.items()}


def mesh_circles() -> list[tessera.Report]:
    """What is reported of our meshes of the circle at each of LENGTHS."""
    return [tessera.mesh(case.loops, case.edge_length).report for case in map(circle, LENGTHS)]
