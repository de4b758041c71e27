"""What NN3 is told of entries: the same however the contour lies, and what an independent reading of it says."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import tessera
from tessera.elements import describe
from tests.library.adversaries import inner_vertices, sector


def described(seed, angle=0.0, scale=1.0, shift=(0.0, 0.0)):
    """A few contours of one batch, turned, scaled and moved, and all entries that are triangles turned left."""
    rng = np.random.default_rng(seed)
    contours = [sector(int(rng.integers(10**6)), int(rng.integers(4, 10))) for _ in range(3)]
    inner = [inner_vertices(contour, int(rng.integers(10**6)), int(rng.integers(0, 4))) for contour in contours]
    n_contour, n_inner = (np.array([len(one) for one in of]) for of in (contours, inner))
    points, entries = np.zeros((3, int((n_contour + n_inner).max()), 2)), []
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    for row, (own, n) in enumerate(zip(map(np.concatenate, zip(contours, inner, strict=True)), n_contour, strict=True)):
        points[row, : len(own)] = scale * own @ turn + shift
        for facet in range(n):
            a, b = own[facet], own[(facet + 1) % n]
            side = (b - a)[0] * (own - a)[:, 1] - (b - a)[1] * (own - a)[:, 0]
            entries += [(row, facet, v) for v in np.flatnonzero(side > 1e-3)]
    return points, n_contour, n_inner, np.array(entries).reshape(-1, 3)


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.floats(0, 6.3), st.sampled_from([1e-6, 0.3, 1e5]))
def test_the_same_wherever_and_however_large(seed, angle, scale):
    (told, here), (told_there, there) = (
        describe(*described(seed, *how)) for how in ((), (angle, scale, (7 * scale, -3 * scale)))
    )
    assume(np.array_equal(told, told_there))  # but for one in a thousand, whose cotangent is next to the limit
    for name, value in vars(here).items():
        np.testing.assert_allclose(value, getattr(there, name), atol=2e-3, rtol=2e-3, err_msg=name)


@pytest.mark.parametrize("seed", range(5))
def test_qualities_and_indices(seed):
    points, n_contour, n_inner, entries = described(seed)
    told, found = describe(points, n_contour, n_inner, entries)
    first = np.cumsum(n_contour) - n_contour
    for k, (row, facet, vertex) in enumerate(entries[told]):
        n = n_contour[row]
        own = tessera.element_quality(points[row], np.array([[facet, (facet + 1) % n, vertex]]))[0]
        assert found.elements[0, k] == pytest.approx(own, abs=1e-5)
        assert found.facets[k] == first[row] + facet
        assert found.following[found.facets[k]] == first[row] + (facet + 1) % n
        assert found.apexes[k] == (first[row] + vertex if vertex < n else n_contour.sum())
    for facet in np.unique(found.facets):
        beside = found.elements[6:, found.facets == facet]
        assert beside.min(axis=1) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("seed", range(5))
def test_it_is_told_of_the_bluntest_apexes(seed):
    points, n_contour, n_inner, entries = described(seed)
    told, _ = describe(points, n_contour, n_inner, entries)
    end = np.where(entries[:, 1] + 1 < n_contour[entries[:, 0]], entries[:, 1] + 1, 0)
    a, b, c = (points[entries[:, 0], vertex] for vertex in (entries[:, 1], end, entries[:, 2]))
    left, right = np.linalg.norm(a - c, axis=1), np.linalg.norm(b - c, axis=1)
    cotangent = 1 / np.tan(np.arccos(((a - c) * (b - c)).sum(axis=1) / (left * right)))
    for facet in np.unique(entries[:, :2], axis=0):
        (own,) = np.nonzero((entries[:, :2] == facet).all(axis=1))
        beyond = cotangent[own] - cotangent[own].min()
        clear = np.abs(beyond - 1) > 1e-3
        assert (np.isin(own, told) == (beyond < 1))[clear].all() and np.isin(own, told).any()


def test_no_entries():
    points, n_contour, n_inner, entries = described(0)
    told, found = describe(points, n_contour, n_inner, entries[:0])
    assert not len(told) and found.elements.shape == (8, 0) and len(found.vertices) == n_contour.sum() + 1
