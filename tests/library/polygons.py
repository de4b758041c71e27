"""Polygons for the tests: hypothesis strategies of simple polygons (counter-clockwise), and some of fixed shape."""

import numpy as np
from hypothesis import strategies as st

seeds = st.integers(0, 2**32 - 1)


def star(n: int, inner: float = 0.4) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, 2 * n, endpoint=False)
    radius = np.where(np.arange(2 * n) % 2, inner, 1.0)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def circle(n: int) -> np.ndarray:
    return star(n, np.cos(np.pi / n))[::2]


def random_star_shaped(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 60))
    angle = (np.arange(n) + rng.uniform(0, 0.9, n)) * 2 * np.pi / n
    radius = rng.uniform(rng.choice([0.02, 0.3, 0.8]), 1, n)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def comb(teeth: int, height: float = 10.0, gap: float = 1.0) -> np.ndarray:
    points = [[0.0, 0.0], [teeth * (1 + gap) - gap, 0.0]]
    for i in reversed(range(teeth)):
        x = i * (1 + gap)
        points += [[x + 1, 1 + height], [x, 1 + height]]
        if i:
            points += [[x, 1.0], [x - gap, 1.0]]
    return np.array(points)


def spiral(n: int, turns: float = 3.0, width: float = 0.5) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi * turns, n)
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    radius = 1 + angle[:, None] / (2 * np.pi)
    return np.concatenate([unit * (radius + width), (unit * radius)[::-1]])


def needle(n: int, width: float) -> np.ndarray:
    x = np.linspace(0, 1, n)
    return np.concatenate([np.column_stack([x, np.zeros(n)]), np.column_stack([x, np.full(n, width)])[::-1]])


def staircase(seed: int) -> np.ndarray:
    """Right angles with collinear runs on a grid: exact degeneracies."""
    rng = np.random.default_rng(seed)
    heights = rng.integers(1, 6, size=int(rng.integers(1, 8)))
    points = [[x, 0] for x in range(len(heights) + 1)]
    for x in reversed(range(len(heights))):
        top = int(heights[x])
        right = int(heights[x + 1]) if x + 1 < len(heights) else 0
        step = 1 if top > right else -1
        points += [[x + 1, y] for y in range(right + step, top, step)] if top != right else []
        points += [[x + 1, top]] if top != right else []
        points += [[x, top]]
    points += [[0, y] for y in range(int(heights[0]) - 1, 0, -1)]
    keep = [i for i, p in enumerate(points) if p != points[i - 1]]
    return np.array(points, dtype=float)[keep]


def letter_s() -> np.ndarray:
    """A thick S: two arcs swept by a disk's diameter."""
    t = np.linspace(0.25 * np.pi, 1.5 * np.pi, 40)
    upper = np.column_stack([np.cos(t), 1 + np.sin(t)])
    t = np.linspace(0.5 * np.pi, -0.75 * np.pi, 40)
    middle = np.concatenate([upper, np.column_stack([np.cos(t), -1 + np.sin(t)])[1:]])
    tangent = np.gradient(middle, axis=0)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.linalg.norm(tangent, axis=1)[:, None]
    return np.concatenate([middle - 0.3 * normal, (middle + 0.3 * normal)[::-1]])


# fmt: off
LETTER_E = np.array([[0, 0], [5, 0], [5, 1.2], [1.4, 1.2], [1.4, 3], [4.5, 3], [4.5, 4.2], [1.4, 4.2], [1.4, 6], [5, 6],
                     [5, 7.2], [0, 7.2]])
LETTER_M = np.array([[0, 0], [1.2, 0], [1.2, 5], [3.4, 0], [4.2, 0], [6.4, 5], [6.4, 0], [7.6, 0], [7.6, 7.2], [6, 7.2],
                     [3.8, 2], [1.6, 7.2], [0, 7.2]])
# fmt: on

simple_polygons = st.one_of(
    seeds.map(random_star_shaped),
    seeds.map(staircase),
    st.integers(1, 12).map(comb),
    st.integers(40, 80).map(spiral),
    st.tuples(st.integers(2, 40), st.sampled_from([1.0, 0.05, 1e-4, 1e-7])).map(lambda a: needle(*a)),
    st.tuples(st.integers(2, 30), st.sampled_from([0.05, 0.4, 0.9])).map(lambda a: star(*a)),
    st.sampled_from([letter_s(), LETTER_E, LETTER_M]),
)
placements = st.tuples(st.sampled_from([1e-6, 1.0, 1e6]), st.sampled_from([0.0, 0.3]), st.sampled_from([0.0, 1.0]))


def placed(polygon: np.ndarray, placement) -> np.ndarray:
    """The polygon scaled, turned by an angle and moved by so many times its scale."""
    scale, angle, offset = placement
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return polygon @ turn * scale + offset * scale
