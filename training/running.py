"""Pools of the contours that the running system makes, for training, and of others like them, for evaluation.

Four kinds go through the scheme or through relaxation: *cells* of the division, *triangles* that refinement gave up to
five segments an edge (so with collinear vertices, or those of a curved boundary), *cavities* that are meshed again, and
*stars*, the rings around a vertex. The triangulation's recursion makes *sub-contours* of them, which only NN3 sees.

`python -m training.running 500` prints how many of each kind so many random domains make.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np

from .domains import Domain, random_domains, real_domains
from .recording import KINDS, LARGEST_CONTOUR, Pool, contours_of, join, record, rows_of, sub_contours_of

_BATCH = 24  # domains that are meshed together


def pool(rng: np.random.Generator, size: int) -> Pool:
    """At least ``size`` contours of random domains, shuffled, so that any part of them has the same shares.

    Kinds come in the shares in which they occur, but for stars, which are over twenty times as many as all others: only
    so many are left, drawn at random, as are a third of the others. What a domain makes several times (the teeth of a
    gear, a cavity that is tried again) is there once.
    """
    parts, count = [], 0
    while count < size:
        found = contours_of(record(random_domains(rng, _BATCH)))
        star = found.kind == KINDS.index("star")
        others = _once(rows_of(found, ~star))
        chosen = rng.permutation(np.flatnonzero(star))[: len(others) // 3]
        parts.append(join([others, _once(rows_of(found, chosen))]))
        count += len(parts[-1])
    return rows_of(join(parts), rng.permutation(count))


def refinement_contours(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells, triangles and cavities of random domains, for evaluation: contours (count, 16, 2), n_contour, l_s."""
    rng = np.random.default_rng(seed)
    return _through_the_scheme(iter(lambda: random_domains(rng, _BATCH), None), count)


def real_contours(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells, triangles and cavities of real domains, for evaluation: contours (count, 16, 2), n_contour, l_s.

    Always the same. Raises ValueError where there are not so many.
    """
    domains = real_domains()
    order = np.random.default_rng(0).permutation(len(domains))
    batches = np.array_split(order, len(order) // _BATCH)
    return _through_the_scheme(([domains[number] for number in batch] for batch in batches), count)


def _through_the_scheme(batches: Iterator[list[Domain]], count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    parts, found = [], 0
    while found < count:
        domains = next(batches, None)
        if domains is None:
            raise ValueError(f"all domains together make {found} contours, {count} were asked for")
        contours = contours_of(record(domains))
        parts.append(_once(rows_of(contours, contours.kind != KINDS.index("star"))))
        found += len(parts[-1])
    joined = join(parts)
    return joined.contour[:count], joined.n_contour[:count], joined.l_s[:count]


def _once(contours: Pool) -> Pool:
    """The contours without repetitions, to six digits."""
    digits = np.round(contours.contour, 6) + 0.0  # no -0
    _, first = np.unique(digits.reshape(len(digits), -1), axis=0, return_index=True)
    return rows_of(contours, np.sort(first))


def shares(rng: np.random.Generator, count: int) -> str:
    """Of what so many random domains make: how many of each kind, and their numbers of edges, as a Markdown table."""
    contours, sub_contours = [], []
    for first in range(0, count, _BATCH):
        found = record(random_domains(rng, min(_BATCH, count - first)))
        contours.append(contours_of(found))
        sub_contours.append(sub_contours_of(found).n_contour)
    contours = join(contours)
    once = [np.count_nonzero(_once(rows_of(contours, contours.kind == k)).kind == k) for k in range(len(KINDS))]
    edges = [contours.n_contour[contours.kind == k] for k in range(len(KINDS))]
    star = KINDS.index("star")
    others = sum(len(n) for n in edges) - len(edges[star])
    lines = [
        "| kind | contours | different | of all but stars | "
        + " | ".join(f"{n} edges" for n in range(3, LARGEST_CONTOUR + 1))
        + " | more |",
        "| --- |" + " --- |" * (LARGEST_CONTOUR + 2),
    ]
    rows = [
        (kind, n, str(different), f"{100 * len(n) / others:.0f} %" if kind != "star" else "")
        for kind, n, different in zip(KINDS, edges, once, strict=True)
    ]
    for kind, n, different, share in rows + [("sub-contour", np.concatenate(sub_contours), "", "")]:
        histogram = np.bincount(np.minimum(n, LARGEST_CONTOUR + 1), minlength=LARGEST_CONTOUR + 2)[3:]
        cells = [kind, str(len(n)), different, share] + [f"{100 * k / len(n):.0f} %" for k in histogram]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("domains", type=int, nargs="?", default=500)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(shares(np.random.default_rng(arguments.seed), arguments.domains))
