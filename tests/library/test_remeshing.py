"""Poor cavities are meshed again: still valid, never worse, each domain as it would be alone."""

import numpy as np
import pytest

from tessera.quality import element_quality
from tessera.remeshing import improve
from tessera.steps import finish
from tessera.stopwatch import Stopwatch
from tests.library.test_relaxation import disturbed_grid
from tests.validity import check_mesh


def compact(vertices, triangles):
    used, local = np.unique(triangles, return_inverse=True)
    return vertices[used], local.reshape(-1, 3)


def improved(vertices, triangles, domain):
    def sizing(points, domain):
        return np.zeros(len(points))

    return finish(improve(vertices, triangles, domain, sizing, 3, Stopwatch()))


@pytest.mark.parametrize("seed", range(4))
def test_a_disturbed_mesh_stays_valid_and_gets_better(seed):
    vertices, triangles, outline = disturbed_grid(9, seed)
    before = element_quality(vertices, triangles)
    vertices, triangles, domain, _ = improved(vertices, triangles, np.zeros(len(triangles), int))
    check_mesh(*compact(vertices, triangles), [outline])
    after = element_quality(vertices, triangles)
    assert after.min() > before.min() and after.mean() > before.mean() + 0.02
    assert len(domain) == len(triangles)


def test_domains_do_not_see_each_other():
    first, second = disturbed_grid(7, 10), disturbed_grid(5, 11)
    alone = [improved(v, t, np.zeros(len(t), int)) for v, t, _ in (first, second)]
    vertices = np.vstack([first[0], second[0] + 100])
    triangles = np.vstack([first[1], second[1] + len(first[0])])
    together = improved(vertices, triangles, np.repeat([0, 1], [len(first[1]), len(second[1])]))
    for number, (v, t, _, _) in enumerate(alone):
        part = together[1][together[2] == number]
        assert len(part) == len(t)
        offset = 100 * number
        key = np.sort(element_quality(together[0] - offset, part))
        np.testing.assert_allclose(key, np.sort(element_quality(v, t)), atol=1e-6)
