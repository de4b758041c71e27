"""The paper's own networks as `Roles`: one NN1 for each N_C, one NN2 and NN3 for each group (N_C, N_I).

They are not shipped; ``training/paper`` makes and describes them. Their files are in a folder beside the shipped ones:
``nn1_N_C.onnx``, ``nn2_N_C_N_I.onnx``, ``nn3_N_C_N_I.onnx`` and ``nn3_star_N_C_N_I.onnx``, each from rows of numbers
(B, n) to rows of numbers. Contours begin at their first vertex there (`Transformation.first`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .closing import MOST_EDGES
from .errors import ContourError
from .paper_placement import GRID, decode, grid_points, patches
from .roles import SHIPPED, Arrays, Roles
from .runtime import MODELS, open_session
from .stopwatch import Stopwatch
from .transform import superimpose

if TYPE_CHECKING:
    import onnxruntime

FOLDER = MODELS.parent / "paper_models"
CONNECTIONS = {"paper": "nn3", "paper*": "nn3_star"}
_ROWS = 1 << 14  # in one call of a network


def load(name: str = "paper", folder: Path = FOLDER) -> Roles:
    """The paper's networks of a folder: "paper" connects by NN3, "paper*" by NN3*.

    Raises ContourError "untrained-group" where the folder has none, and so do the roles for contours and groups that no
    network was trained for; sub-contours of such groups get no table (`triangulation`, point 4).
    """
    connection = CONNECTIONS[name]
    if not groups(name, folder):
        message = f"There are none of the networks that {name!r} asks for in {folder}. "
        raise ContourError(
            "untrained-group", message + "Train and export them (training/paper), or use the shipped ones."
        )
    return Roles(partial(_count, name, folder), partial(_place, name, folder), partial(_rate, connection, folder))


def roles_named(name: str) -> Roles:
    """The networks that a user names: "shipped", or those that `load` takes; ValueError for other names."""
    if name not in ("shipped", *CONNECTIONS):
        raise ValueError(f'networks is "shipped", "paper" or "paper*", not {name!r}')
    return SHIPPED if name == "shipped" else load(name)


def groups(name: str = "paper", folder: Path = FOLDER) -> dict[int, list[int]]:
    """The groups that the whole scheme has networks for: each N_C's numbers of inner vertices, ascending."""
    connected = _trained(CONNECTIONS[name], folder)
    found = {}
    for (n,) in sorted(_trained("nn1", folder)):
        placed = {m for of, m in _trained("nn2", folder) if of == n} | {0}
        # Small contours without inner vertices need no table (`closing`).
        numbers = sorted(m for m in placed if (n, m) in connected or (m == 0 and n <= MOST_EDGES))
        if any((n, m) in connected for m in numbers):
            found[n] = numbers
    return found


def is_trained(role: str, key: tuple[int, ...], folder: Path = FOLDER) -> bool:
    """Whether a network "nn1" (N_C,), "nn2", "nn3" or "nn3_star" (N_C, N_I) is there."""
    return key in _trained(role, folder)


@cache
def _trained(role: str, folder: Path) -> frozenset[tuple[int, ...]]:
    """The numbers in the names of a role's files."""
    names = (file.stem.removeprefix(f"{role}_").split("_") for file in folder.glob(f"{role}_*.onnx"))
    return frozenset(tuple(map(int, name)) for name in names if all(part.isdecimal() for part in name))


@cache
def _session(file: Path) -> onnxruntime.InferenceSession:
    return open_session(file)


def _ask(file: Path, rows: np.ndarray) -> np.ndarray:
    """A network's answers (B, outputs) to rows (B, inputs), rounded as a last bit may depend on the processor."""
    given = np.ascontiguousarray(rows, dtype=np.float32)
    parts = [given[first : first + _ROWS] for first in range(0, max(1, len(given)), _ROWS)]
    return np.round(np.concatenate([_session(file).run(None, {"rows": part})[0] for part in parts]), 4)


def _groups(n_contour: np.ndarray, n_inner: np.ndarray) -> Iterator[tuple[int, int, np.ndarray]]:
    """N_C, N_I and rows of each group in a batch."""
    for n, m in sorted(set(zip(n_contour.tolist(), n_inner.tolist(), strict=True))):
        yield n, m, np.flatnonzero((n_contour == n) & (n_inner == m))


def _begun(contour: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Contours (B, N_C, 2), from their first vertices (B,) on, as rows (B, 2 N_C)."""
    index = (np.arange(contour.shape[1]) + first[:, None]) % contour.shape[1]
    return np.take_along_axis(contour, index[..., None], axis=1).reshape(len(contour), -1)


def _count(name: str, folder: Path, contour: np.ndarray, n_contour: np.ndarray, l_s: np.ndarray) -> np.ndarray:
    """NN1 (section 2.3)."""
    first, count = superimpose(contour, n_contour).first, np.zeros(len(contour))
    for n, _, rows in _groups(n_contour, np.zeros_like(n_contour)):
        if (n,) not in _trained("nn1", folder):
            raise _untrained(name, folder, ["NN1"], n)
        given = np.concatenate([_begun(contour[rows, :n], first[rows]), l_s[rows, None]], axis=1)
        count[rows] = _ask(folder / f"nn1_{n}.onnx", given)[:, 0]
    return np.rint(np.maximum(np.nan_to_num(count), 0)).astype(np.int64)


def _place(
    name: str,
    folder: Path,
    contour: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    l_s: np.ndarray,
    watch: Stopwatch,
) -> Arrays:
    """NN2, for groups that can be connected, too."""
    known = groups(name, folder)
    for n, m, _ in _groups(n_contour, n_inner):
        if m not in known.get(n, ()):
            roles = {"NN2": "nn2", "NN3*" if name == "paper*" else "NN3": CONNECTIONS[name]}
            missing = [
                role for role, files in roles.items() if (m or role != "NN2") and not is_trained(files, (n, m), folder)
            ]
            raise _untrained(name, folder, missing, n, m)
    return place(folder, contour, n_contour, n_inner, l_s, watch)


def place(
    folder: Path,
    contour: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    l_s: np.ndarray,
    watch: Stopwatch,
) -> Arrays:
    """NN2 alone (section 2.4), for groups that it was trained for (`is_trained`): as `Roles.place`."""
    scores = score(folder, contour, n_contour, n_inner, l_s, watch)
    with watch("decoding"):
        return decode(scores, contour, n_contour, n_inner, l_s)


def score(
    folder: Path,
    contour: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    l_s: np.ndarray,
    watch: Stopwatch,
) -> np.ndarray:
    """(B, R²) NN2's scores of the grid points, patch by patch; 0 for contours without inner vertices."""
    first, scores = superimpose(contour, n_contour).first, np.zeros((len(contour), GRID * GRID))
    with watch("NN2"):
        for n, m, rows in _groups(n_contour, n_inner):
            if m:
                given = np.concatenate([_begun(contour[rows, :n], first[rows]), l_s[rows, None]], axis=1)
                scores[rows] = score_patches(partial(_ask, folder / f"nn2_{n}_{m}.onnx"), given, GRID)
    return scores


def score_patches(ask: Callable[[np.ndarray], np.ndarray], given: np.ndarray, resolution: int) -> np.ndarray:
    """(B, R²) scores of a grid's points by NN2, ``ask``, for contours and targets (B, 2 N_C + 1)."""
    number = patches(resolution)
    places = grid_points(resolution)[number].reshape(len(number), -1)
    rows = np.concatenate([np.repeat(given, len(places), axis=0), np.tile(places, (len(given), 1))], axis=1)
    scores = np.zeros((len(given), resolution * resolution))
    scores[:, number] = ask(rows).reshape(len(given), *number.shape)
    return scores


def _rate(
    connection: str,
    folder: Path,
    points: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    entries: np.ndarray,
) -> np.ndarray:
    """NN3 or NN3* (section 2.5)."""

    def ask(n: int, m: int, rows: np.ndarray) -> np.ndarray | None:
        trained = is_trained(connection, (n, m), folder)
        return table_network(folder, n, m, connection)(rows) if trained else None

    return rate(ask, connection == "nn3_star", points, n_contour, n_inner, entries)


def table_network(folder: Path, n: int, m: int, connection: str = "nn3") -> Callable[[np.ndarray], np.ndarray]:
    """The NN3 of a group, or its NN3* ("nn3_star"): rows (b, inputs) to tables or their rows (b, outputs)."""
    return partial(_ask, folder / f"{connection}_{n}_{m}.onnx")


def rate(
    ask: Callable[[int, int, np.ndarray], np.ndarray | None],
    by_row: bool,
    points: np.ndarray,
    n_contour: np.ndarray,
    n_inner: np.ndarray,
    entries: np.ndarray,
) -> np.ndarray:
    """What `Roles.rate` gives, from tables: q_worst of entries, and 0 for q_mean; both 0 where there is no table.

    ask: the tables of a group (N_C, N_I) for rows of contours and inner vertices (b, 2 (N_C + N_I)), or None where no
    network was trained; by_row: a table's rows one by one, for rows that end with the edge's index as 1 of N_C.
    """
    values = np.zeros((len(entries), 2))
    transformation = superimpose(points, n_contour)
    points, first = transformation.apply(points), transformation.first
    for n, m, rows in _groups(n_contour, n_inner):
        inner = points[rows, n : n + m].reshape(len(rows), -1)
        given = np.concatenate([_begun(points[rows, :n], first[rows]), inner], axis=1)
        if by_row:
            given = np.concatenate([np.repeat(given, n, axis=0), np.tile(np.eye(n), (len(given), 1))], axis=1)
        found = ask(n, m, given)
        if found is None:
            continue
        table = found.reshape(len(rows), n, n + m)
        place = np.full(len(points), -1)
        place[rows] = np.arange(len(rows))
        chosen = np.flatnonzero(place[entries[:, 0]] >= 0)
        row, facet, vertex = entries[chosen].T
        own = np.where(vertex < n, (vertex - first[row]) % n, vertex)
        values[chosen, 0] = table[place[row], (facet - first[row]) % n, own]
    return values


def _untrained(name: str, folder: Path, missing: list[str], n: int, m: int | None = None) -> ContourError:
    """missing: the roles that have no network for N_C = n and, where it is known, N_I = m."""
    trained = groups(name, folder)
    what = f"a contour of {n} edges" + ("" if m is None else f" with the {m} inner vertices that NN1 asks for")
    there = "; ".join(
        f"{of}{'' if i else ' edges'} with {_ranges(numbers)}{'' if i else ' inner vertices'}"
        for i, (of, numbers) in enumerate(trained.items())
    )
    other = (
        "" if m is None or n not in trained else f"a {'longer' if m > trained[n][0] else 'shorter'} edge length, or "
    )
    were = "was" if len(missing) == 1 else "were"
    return ContourError(
        "untrained-group",
        f"The paper's {' and '.join(missing)} {were} not trained for {what}. "
        f'There are networks for {there}. Take {other}networks="shipped".',
    )


def _ranges(numbers: list[int]) -> str:
    """0, 1, 2, 5 as 0 to 2 and 5."""
    starts = [k for k in range(len(numbers)) if not k or numbers[k] != numbers[k - 1] + 1]
    parts = [numbers[a:b] for a, b in zip(starts, [*starts[1:], len(numbers)], strict=True)]
    *first, last = [str(part[0]) if len(part) == 1 else f"{part[0]} to {part[-1]}" for part in parts]
    return f"{', '.join(first)} and {last}" if first else last
