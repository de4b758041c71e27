"""The lower envelope of cones, and the edge length that long edges leave beside them, against asking all."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tessera.cones import Places, build_cones, lowest
from tessera.sizing import GRADATION, LONG, grade_from_edges
from tests.library.polygons import seeds


@settings(deadline=None, max_examples=30)
@given(seeds, st.sampled_from([1, 7, 8, 9, 100, 500]))
def test_the_lowest_of_cones_is_exact(seed, n):
    rng = np.random.default_rng(seed)
    start = rng.random((n, 2))
    end = np.where(rng.random((n, 1)) < 0.5, start, rng.random((n, 2)))
    places = Places(start, end, rng.random(n) * 0.2, rng.uniform(0, 0.5, n), rng.integers(0, 3, n))
    points, domain = rng.uniform(-0.5, 1.5, (200, 2)), rng.integers(0, 4, 200)
    along = end - start
    share = ((points[:, None] - start) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-300)
    away = np.linalg.norm(points[:, None] - start - np.clip(share, 0, 1)[..., None] * along, axis=-1)
    values = np.where(domain[:, None] == places.domain, places.value + places.slope * away, np.inf)
    found = lowest(build_cones(places), points, domain, np.full(200, 0.3))
    assert found == pytest.approx(np.minimum(values.min(axis=1), 0.3), abs=1e-12)


def test_beside_long_edges_the_target_is_what_the_longest_near_ones_leave():
    rng = np.random.default_rng(5)
    starts = rng.uniform(-1, 1, (60, 2))
    ends = starts + rng.normal(scale=0.3, size=(60, 2))
    of, points, owner = rng.integers(0, 3, 60), rng.uniform(-1, 1, (300, 2)), rng.integers(0, 3, 300)
    graded = grade_from_edges(starts, ends, of, lambda x, _: 0.1 + 0.1 * x[:, 0] ** 2)(points, owner)
    wanted = 0.1 + 0.1 * points[:, 0] ** 2
    along, length = ends - starts, np.linalg.norm(ends - starts, axis=1)
    middle = 0.5 * (starts + ends)
    for edge in np.flatnonzero(length > LONG * (0.1 + 0.1 * middle[:, 0] ** 2)):
        offset = points - starts[edge]
        share = np.clip(offset @ along[edge] / length[edge] ** 2, 0, 1)
        away = np.linalg.norm(offset - share[:, None] * along[edge], axis=1)
        wanted = np.where(owner == of[edge], np.maximum(wanted, length[edge] - GRADATION * away), wanted)
    np.testing.assert_allclose(graded, wanted, rtol=1e-12)
