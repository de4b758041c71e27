"""Contours, inner vertices and tables that are meant to break the triangulation, and what must hold nevertheless.

The tests and `benchmarks.guarantee` draw from the same strategies and check the same property. An example is a contour
with its inner vertices and a table. They are drawn in batches, because a call for one contour takes nearly as long as
one for ten; of a batch that fails, the one contour that is to blame is named.
"""

import numpy as np
from hypothesis import strategies as st

from tessera.closing import MOST_EDGES
from tessera.entries import FLAT
from tessera.quality import element_quality
from tessera.triangulation import triangulate
from tests.library.polygons import circle, comb, needle, placed, seeds, spiral, staircase, star
from tests.validity import check_many, polygon_area, polygon_is_simple, signs_of_areas

Members = list[tuple[np.ndarray, np.ndarray]]  # contours (n, 2), counter-clockwise, and their inner vertices (m, 2)


def sector(seed: int, n: int | None = None) -> np.ndarray:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 17)) if n is None else n
    angle = (np.arange(n) + rng.uniform(0, 0.95, n)) * 2 * np.pi / n
    points = rng.uniform(rng.choice([0.05, 0.3, 0.8]), 1, n)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    return points if polygon_area(points) > 0 else points[::-1]  # three vertices may leave half a turn between two


def with_straight_runs(seed: int) -> np.ndarray:
    """A polygon of few corners, its sides divided: straight to the last bit only where the sides are axis-parallel."""
    rng = np.random.default_rng(seed)
    corners = sector(seed, int(rng.integers(3, 6)))
    if rng.random() < 0.5:
        corners = np.array([[0, 0], [4, 0], [4, rng.integers(1, 4)], [0, 3]], dtype=float)
    parts = rng.integers(1, 4, len(corners))
    sides = zip(corners, np.roll(corners, -1, axis=0), parts, strict=True)
    return np.concatenate([a + np.arange(k)[:, None] / k * (b - a) for a, b, k in sides])


contours = st.one_of(
    seeds.map(sector),
    seeds.map(with_straight_runs),
    seeds.map(staircase),
    st.integers(3, 16).map(circle),
    st.integers(1, 4).map(comb),
    st.integers(8, 12).map(lambda n: spiral(n, turns=1.2)),
    st.tuples(st.integers(2, 8), st.sampled_from([1.0, 0.05, 1e-4, 1e-7])).map(lambda a: needle(*a)),
    st.tuples(st.integers(3, 8), st.sampled_from([0.05, 0.4, 0.9])).map(lambda a: star(*a)),
)
# Scale, angle, and offset in scales: 1e6 leaves coordinates only ten digits.
placements = st.tuples(st.sampled_from([1e-6, 1.0, 1e6]), st.sampled_from([0.0, 0.3]), st.sampled_from([0.0, 1.0, 1e6]))


def is_contour(polygon: np.ndarray) -> bool:
    """Whether rounding, far from the origin, has left the polygon simple and counter-clockwise."""
    return polygon_area(polygon) > 0 and polygon_is_simple(polygon)


placed_contours = st.builds(placed, contours, placements).filter(is_contour)


def strictly_inside(points: np.ndarray, polygon: np.ndarray) -> np.ndarray:
    """(k,) which of the points (k, 2) lie inside a polygon (n, 2) and not on it, exactly."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    upward = (a[:, 1] <= b[:, 1])[:, None]
    low, high, point = np.where(upward, a, b), np.where(upward, b, a), points[:, None]
    turn = signs_of_areas(low, high, point)
    on = (turn == 0) & np.all((np.minimum(a, b) <= point) & (point <= np.maximum(a, b)), axis=-1)
    passed = (low[:, 1] <= point[..., 1]) & (point[..., 1] < high[:, 1]) & (turn > 0)
    return (np.count_nonzero(passed, axis=1) % 2 == 1) & ~on.any(axis=1)


def inner_vertices(polygon: np.ndarray, seed: int, wanted: int) -> np.ndarray:
    """Up to so many distinct points inside: anywhere, halfway between two vertices, on a grid, and next to each other.

    Next to each other means with no number between their coordinates.
    """
    rng = np.random.default_rng(seed)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    anywhere = rng.uniform(low, high, (3 * wanted, 2))
    halfway = polygon[rng.integers(len(polygon), size=(3 * wanted, 2))].mean(axis=1)
    on_grid = low + (high - low) * rng.integers(1, 8, (3 * wanted, 2)) / 8
    candidates = np.concatenate([anywhere, halfway, on_grid][rng.integers(3) :])
    beside = np.nextafter(candidates[: wanted // 4], rng.choice([-np.inf, np.inf]))
    candidates = np.unique(np.concatenate([candidates, beside]), axis=0)
    return rng.permutation(candidates[strictly_inside(candidates, polygon)])[:wanted]


members = st.builds(
    lambda polygon, seed, wanted: (polygon, inner_vertices(polygon, seed, wanted)),
    placed_contours,
    seeds,
    st.integers(0, 24),
)
batches = st.lists(members, min_size=30, max_size=60)


def padded(members: Members, extra: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A batch as `triangulate` takes it: points (B, V, 2), n_contour and n_inner (B,)."""
    width = max(len(contour) + len(inner) for contour, inner in members) + extra
    points = np.full((len(members), width, 2), 7.0)
    for row, member in zip(points, members, strict=True):
        joined = np.concatenate(member)
        row[: len(joined)] = joined
    n_contour, n_inner = np.array([[len(contour), len(inner)] for contour, inner in members]).T
    return points, n_contour, n_inner


def corners(points, n_contour, entries):
    """Corners (P, 3, 2) of the elements of entries."""
    row, facet, vertex = entries.T
    return points[row[:, None], np.stack([facet, (facet + 1) % n_contour[row], vertex], axis=1)]


def scattered(points, n_contour, n_inner, entries):
    """Entries that look random, but depend on the contour's own points alone."""
    # Element by element: a product of matrices may round differently from one size of batch to another.
    x, y = np.moveaxis(corners(points, n_contour, entries), 2, 0)
    a, b, c = (12.9898 * x + 78.233 * y).T
    value = np.sin(1e4 * (a + 3 * b + c)) * 43758.5453
    return np.stack([value % 1, (7 * value) % 1], axis=-1)


def own_quality(points, n_contour, n_inner, entries):
    elements = corners(points, n_contour, entries).reshape(-1, 2)
    quality = element_quality(elements, np.arange(len(elements)).reshape(-1, 3))
    return np.repeat(quality[:, None], 2, axis=1)


def filled(value):
    return lambda points, n_contour, n_inner, entries: np.full((len(entries), 2), value)


TABLES = {
    "zero": filled(0.0),
    "constant": filled(0.5),
    "one": filled(1.0),
    "negative": filled(-1.0),
    "nan": filled(np.nan),
    "infinite": filled(np.inf),
    "huge": filled(1e300),
    "random": scattered,
    "few": lambda *a: np.maximum(scattered(*a) - 0.9, 0),
    "holed": lambda *a: np.where(scattered(*a) > 0.5, np.nan, scattered(*a)),
    "own quality": own_quality,
    "inverted": lambda *a: 1 - own_quality(*a),
}
tables = st.sampled_from(sorted(TABLES))


def check_guarantee(batch: Members, table: str) -> None:
    """Assert that every contour is covered exactly once, by all its vertices, and that fallbacks are counted."""
    try:
        _check(batch, table)
    except Exception as error:
        if len(batch) > 1:
            for member in batch:
                check_guarantee([member], table)
        else:
            contour, inner = batch[0]
            error.add_note(f"contour {contour.tolist()}, inner vertices {inner.tolist()}, table {table!r}")
        raise


def _check(batch: Members, table: str) -> None:
    points, n_contour, n_inner = padded(batch, extra=2)
    result = triangulate(points, n_contour, n_inner, TABLES[table])
    check_many(points, n_contour, n_inner, result.triangles, result.owner)
    if table in ("zero", "negative", "nan", "infinite"):
        needs_table = (n_inner > 0) | (n_contour > MOST_EDGES)
        assert (result.fallbacks[needs_table] > 0).all(), "fallbacks that were not counted"
    if table in ("constant", "one", "huge", "own quality"):
        # Straight runs that are bent by rounding alone may leave nothing but flat elements.
        quality = element_quality(points.reshape(-1, 2), result.triangles + result.owner[:, None] * points.shape[1])
        flat = np.isin(np.arange(len(batch)), result.owner[quality <= FLAT])
        assert not result.fallbacks[~flat].any(), "a fallback where the table had an element"
