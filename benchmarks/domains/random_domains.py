"""Random domains with holes: simple loops apart from each other, up to 500 vertices in all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from matplotlib.path import Path

import tessera

MOST_VERTICES, MOST_HOLES = 500, 5
SEED = 5_2026  # of nothing else
_TRIANGLES = 20, 800  # asked for, about


@dataclass(frozen=True)
class RandomDomain:
    """loops: (k, 2) arrays, the outer one first; options: further arguments of `tessera.mesh`."""

    loops: list[np.ndarray]
    edge_length: float
    options: dict = field(default_factory=dict)


def random_domain(number: int) -> RandomDomain:
    """The domain of a number, always the same."""
    rng = np.random.default_rng((SEED, number))
    left = int(np.exp(rng.uniform(np.log(4), np.log(MOST_VERTICES))))
    holes = int(rng.integers(0, min(MOST_HOLES, (left - 3) // 3) + 1))
    sort = _SORTS[int(rng.integers(len(_SORTS)))]
    loops = [sort(rng, max(3, left - holes * int(rng.integers(3, 2 + max(2, left // (2 * (holes + 1)))))))]
    for number_left in range(holes, 0, -1):
        spare = MOST_VERTICES - sum(map(len, loops)) - 3 * (number_left - 1)
        hole = _hole(rng, loops, int(rng.integers(3, max(4, min(spare, 1 + left // holes)))))
        if hole is not None:
            loops.append(hole)
    angle, size = rng.uniform(0, 2 * np.pi), 10 ** rng.uniform(-3, 3)
    turn = size * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    shift = size * rng.uniform(-2, 2, 2)
    loops = [(loop @ turn + shift)[:: rng.choice([-1, 1])] for loop in loops]
    area = abs(_area(loops[0])) - sum(abs(_area(loop)) for loop in loops[1:])
    wanted = np.exp(rng.uniform(*np.log(_TRIANGLES)))
    length = float(np.sqrt(4 * area / (np.sqrt(3) * wanted)))
    return RandomDomain(loops, length, _options(rng, length))


def _options(rng: np.random.Generator, length: float) -> dict:
    """Half keep their boundary; a third have a sizing."""
    options = {"boundary": "keep"} if rng.random() < 0.5 else {}
    sizings = tessera.by_thickness(2), tessera.by_curvature(0.4), tessera.by_distance(0.4 * length)
    if rng.random() < 1 / 3:
        options |= {"sizing": sizings[int(rng.integers(3))], "min_edge_length": 0.2 * length}
    return options


def _area(loop: np.ndarray) -> float:
    x, y = (loop - loop[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _star(rng: np.random.Generator, n: int) -> np.ndarray:
    """Spikes around a point, rough or nearly round."""
    angle = 2 * np.pi * (np.arange(n) + rng.uniform(0, 0.9, n)) / n
    radius = rng.uniform(rng.choice([0.1, 0.5, 0.95]), 1, n)
    return _polar(radius, angle) * [1, rng.choice([1.0, 0.3])]


def _blob(rng: np.random.Generator, n: int) -> np.ndarray:
    """Smooth, with waves."""
    angle, wave = 2 * np.pi * np.arange(n) / n, np.arange(2, 8)
    size = rng.normal(0, 0.5, len(wave)) / wave
    return _polar(np.exp((size * np.cos(angle[:, None] * wave + rng.uniform(0, 7, len(wave)))).sum(axis=1)), angle)


def _spiral(rng: np.random.Generator, n: int) -> np.ndarray:
    """A band that winds around itself."""
    n = max(6, n)
    # At most 0.4 in an edge, so that chords stay away from the next winding.
    angle = np.linspace(0, min(2 * np.pi * rng.uniform(0.3, 3), 0.4 * (n // 2 - 1)), n // 2)
    inner = 1 + angle / (2 * np.pi)
    return np.concatenate([_polar(inner + rng.uniform(0.1, 0.85), angle), _polar(inner, angle)[::-1]])


def _stairs(rng: np.random.Generator, n: int) -> np.ndarray:
    """Right angles on a grid, with vertices within straight sides."""
    top = np.repeat(rng.integers(1, 9, max(2, n // 4)), 2)
    x = np.repeat(np.arange(len(top) // 2 + 1), 2)[1:-1]
    upper = np.stack([x, top], axis=1)[::-1]
    upper = upper[np.any(upper != np.roll(upper, 1, axis=0), axis=1)]
    lower = np.stack([np.arange(len(top) // 2 + 1), np.zeros(len(top) // 2 + 1)], axis=1)
    return np.concatenate([lower, upper]).astype(np.float64)


def _tangle(rng: np.random.Generator, n: int) -> np.ndarray:
    """Random points joined to a polygon, and untangled: reversing a stretch between two crossing edges shortens it."""
    points = rng.uniform(-1, 1, (min(n, 60), 2))
    while True:
        after = np.roll(points, -1, axis=0)
        one, other = np.triu_indices(len(points), 2)
        crossing = _cross(points[one], after[one], points[other], after[other])
        crossing &= ~((one == 0) & (other == len(points) - 1))
        if not crossing.any():
            return points
        first, last = one[crossing][0], other[crossing][0]
        points = np.concatenate([points[: first + 1], points[last:first:-1], points[last + 1 :]])


def _cross(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        return (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])

    return (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)


_SORTS: tuple[Callable[[np.random.Generator, int], np.ndarray], ...] = _star, _blob, _spiral, _stairs, _tangle


def _hole(rng: np.random.Generator, loops: list[np.ndarray], n: int) -> np.ndarray | None:
    """A star somewhere within, that may come close to what is there: none where no place was found."""
    outer = Path(loops[0])
    for _ in range(60):
        place = rng.uniform(loops[0].min(axis=0), loops[0].max(axis=0))
        if outer.contains_point(place) and not any(Path(loop).contains_point(place) for loop in loops[1:]):
            reach = min(_distance(place, loop) for loop in loops)
            return place + reach * rng.choice([0.3, 0.8, 0.99]) * _star(rng, n)
    return None


def _distance(place: np.ndarray, loop: np.ndarray) -> float:
    edge, offset = np.roll(loop, -1, axis=0) - loop, place - loop
    along = np.clip((offset * edge).sum(axis=1) / (edge**2).sum(axis=1), 0, 1)
    return float(np.linalg.norm(offset - along[:, None] * edge, axis=1).min())


def _polar(radius: np.ndarray, angle: np.ndarray) -> np.ndarray:
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
