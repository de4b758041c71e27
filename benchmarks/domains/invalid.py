"""How many meshes of random domains are invalid, by the tests' own checker."""

from __future__ import annotations

import multiprocessing
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import tessera
from tests.validity import check_mesh

from .random_domains import random_domain

VALID, REFUSED, INVALID, CRASHED = "valid", "refused", "invalid", "crashed"
_CHUNK = 10


@dataclass(frozen=True)
class Outcomes:
    """triangles: of all meshes; kinds: how many domains came to what; bad: "kind: why" -> numbers of domains."""

    triangles: int
    kinds: Counter
    bad: dict[str, list[int]]


def count_invalid(count: int, processes: int) -> Outcomes:
    """Mesh and check the first so many random domains, in several processes."""
    # Raises if a process is killed, instead of waiting for it.
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        found = list(pool.map(_outcome, range(count), chunksize=_CHUNK))
    bad: dict[str, list[int]] = {}
    for number, (kind, why, _) in enumerate(found):
        if kind != VALID:
            bad.setdefault(f"{kind}: {why}", []).append(number)
    return Outcomes(sum(size for *_, size in found), Counter(kind for kind, *_ in found), bad)


def _outcome(number: int) -> tuple[str, str, int]:
    """What a domain came to, why, and its triangles. Whatever goes wrong in meshing is counted, and named."""
    domain = random_domain(number)
    try:
        mesh = tessera.mesh(domain.loops, domain.edge_length, **domain.options)
    except tessera.ContourError as error:
        return REFUSED, error.reason, 0
    except Exception as error:
        return CRASHED, f"{type(error).__name__}: {error}"[:100], 0
    try:
        check_mesh(mesh.vertices, mesh.triangles, domain.loops, keep="boundary" in domain.options)
    except AssertionError as error:
        return INVALID, str(error).split("\n")[0], len(mesh.triangles)
    return VALID, "", len(mesh.triangles)
