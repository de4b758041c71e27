"""Poor cavities are meshed again: still valid, never worse, each domain as it would be alone."""

import numpy as np
import pytest

from tessera import remeshing
from tessera.quality import element_quality
from tessera.remeshing import improve
from tessera.steps import finish
from tessera.stopwatch import Stopwatch
from tests.library.test_relaxation import disturbed_grid
from tests.validity import check_mesh


def compact(vertices, triangles):
    used, local = np.unique(triangles, return_inverse=True)
    return vertices[used], local.reshape(-1, 3)


def improved(vertices, triangles, domain, last=True):
    def sizing(points, domain):
        return np.zeros(len(points))

    return finish(improve(vertices, triangles, domain, sizing, 3, Stopwatch(), last=last))


@pytest.mark.parametrize("seed", range(4))
def test_a_disturbed_mesh_stays_valid_and_gets_better(seed):
    vertices, triangles, outline = disturbed_grid(9, seed)
    before = element_quality(vertices, triangles)
    vertices, triangles, domain, _ = improved(vertices, triangles, np.zeros(len(triangles), int))
    check_mesh(*compact(vertices, triangles), [outline])
    after = element_quality(vertices, triangles)
    assert after.min() > before.min() and after.mean() > before.mean() + 0.02
    assert len(domain) == len(triangles)


@pytest.mark.parametrize("last", [True, False])
@pytest.mark.parametrize("small", [0, 60, 1000])
def test_domains_do_not_see_each_other(small, last, monkeypatch):
    """Small and large ones, that have more or fewer turns and choices, in one batch."""
    monkeypatch.setattr(remeshing, "_SMALL", small)
    monkeypatch.setattr(remeshing, "_SMALL_BEFORE", small)
    monkeypatch.setattr(remeshing, "_MORE", (0,))
    grids = [disturbed_grid(size, seed) for size, seed in ((7, 10), (5, 11), (9, 12))]
    assert sorted(len(triangles) > 60 for _, triangles, _ in grids) == [False, True, True]
    alone = [improved(v, t, np.zeros(len(t), int), last) for v, t, _ in grids]
    first = np.cumsum([0] + [len(v) for v, _, _ in grids])
    triangles = np.vstack([t + n for (_, t, _), n in zip(grids, first[:-1], strict=True)])
    domain = np.repeat(np.arange(3), [len(t) for _, t, _ in grids])
    vertices, triangles, domain, fallbacks = improved(np.vstack([v for v, _, _ in grids]), triangles, domain, last)
    for number, (v, t, _, fell) in enumerate(alone):
        here, there = vertices[triangles[domain == number]], v[t]
        assert np.array_equal(*(np.unique(of.reshape(-1, 6), axis=0) for of in (here, there)))
        assert fallbacks[number] == fell[0]


def test_a_domain_without_triangles_changes_nothing():
    vertices, triangles, _ = disturbed_grid(5, 11)
    one, other = (improved(vertices, triangles, np.full(len(triangles), number)) for number in (0, 2))
    assert np.array_equal(one[0], other[0]) and np.array_equal(one[1], other[1])
