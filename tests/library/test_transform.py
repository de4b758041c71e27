"""The feature transformation: onto the regular polygon, wherever, however large and from whichever vertex."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tessera.transform import superimpose

contours = st.integers(3, 16).flatmap(
    lambda n: st.lists(st.tuples(st.floats(0.3, 1), st.floats(0, 0.9)), min_size=n, max_size=n)
)


def polygon(draws) -> np.ndarray:
    radius, share = np.array(draws).T
    angle = 2 * np.pi * (np.arange(len(radius)) + share) / len(radius)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def transformed(points):
    transformation = superimpose(points[None], np.array([len(points)]))
    return transformation.apply(points[None])[0], transformation


@given(contours, st.floats(-4, 4), st.floats(1e-3, 1e3), st.floats(-10, 10))
def test_similar_contours_transform_alike(draws, turn, scale, shift):
    points = polygon(draws)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    here, _ = transformed(points)
    there, _ = transformed(scale * points @ rotation.T + shift)
    np.testing.assert_allclose(here, there, atol=1e-6)


@given(contours, st.integers(0, 15))
def test_the_first_vertex_does_not_matter(draws, start):
    points = polygon(draws)
    radius = np.sort(np.linalg.norm(points - points.mean(axis=0), axis=1))
    if radius[-1] - radius[-2] < 1e-6:
        return  # as far from the centre as another: either may be the first
    start %= len(points)
    here, _ = transformed(points)
    there, _ = transformed(np.roll(points, -start, axis=0))
    np.testing.assert_allclose(np.roll(here, -start, axis=0), there, atol=1e-9)


@given(contours)
def test_inverse_and_scale(draws):
    points = polygon(draws)
    there, transformation = transformed(points)
    np.testing.assert_allclose(transformation.invert(there[None])[0], points, atol=1e-12)
    lengths, scaled = (np.linalg.norm(np.diff(p, axis=0), axis=1) for p in (points, there))
    np.testing.assert_allclose(scaled, transformation.scale[0] * lengths, atol=1e-12)


def test_regular_polygon_fits_the_unit_circle():
    for n in range(3, 17):
        angle = 2 * np.pi * np.arange(n) / n + 0.3
        there, _ = transformed(5 + 7 * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        np.testing.assert_allclose(np.linalg.norm(there, axis=1), 1, atol=1e-12)


def test_rotation_is_the_best_one():
    rng = np.random.default_rng(0)
    points = polygon(np.stack([rng.uniform(0.3, 1, 9), rng.uniform(0, 0.9, 9)], axis=1))
    there, transformation = transformed(points)
    there = np.roll(there, -transformation.first[0], axis=0)
    regular = np.exp(2j * np.pi * np.arange(9) / 9)
    z = there[:, 0] + 1j * there[:, 1]
    residual = np.sum(np.abs(z - regular) ** 2)
    for turn in np.linspace(-0.2, 0.2, 41):
        for scale in (0.95, 1.0, 1.05):
            assert np.sum(np.abs(scale * z * np.exp(1j * turn) - regular) ** 2) >= residual - 1e-12


def test_a_batch_of_mixed_sizes_is_each_alone():
    rng = np.random.default_rng(1)
    sizes = np.array([3, 7, 16, 7, 4])
    batch = np.zeros((5, 16, 2))
    for row, n in enumerate(sizes):
        batch[row, :n] = polygon(np.stack([rng.uniform(0.3, 1, n), rng.uniform(0, 0.9, n)], axis=1))
    together = superimpose(batch, sizes)
    for row, n in enumerate(sizes):
        alone = superimpose(batch[row : row + 1, :n], sizes[row : row + 1])
        assert alone.factor[0] == together.factor[row] and alone.centre[0] == together.centre[row]
