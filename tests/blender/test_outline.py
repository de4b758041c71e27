"""Wire edges to closed polylines, and the plane they lie in: numpy alone."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.blender.chains import outline_edges, polylines
from addon.blender.plane import fit_plane
from addon.tessera.errors import ContourError


@given(st.lists(st.tuples(st.integers(1, 9), st.booleans()), min_size=1, max_size=5), st.randoms())
def test_chains_come_back_whatever_the_order_of_their_edges(chains, random):
    edges, expected, first = [], [], 0
    for length, closed in chains:
        closed = closed and length >= 3
        around = list(range(first, first + length))
        pairs = list(zip(around, around[1:] + around[:1], strict=True))
        edges += pairs if closed else pairs[:-1]
        expected.append((set(around), closed))
        first += length
    edges = [pair if random.random() < 0.5 else pair[::-1] for pair in edges]
    random.shuffle(edges)

    found = polylines(first, np.array(edges, dtype=np.int32).reshape(-1, 2))

    assert [(set(chain.tolist()), closed) for chain, closed in found] == expected
    links = {frozenset(pair) for pair in edges}
    for chain, closed in found:
        steps = list(zip(chain, np.roll(chain, -1), strict=True))
        assert len(set(chain.tolist())) == len(chain)
        assert all(frozenset((int(a), int(b))) in links for a, b in (steps if closed else steps[:-1]))


def test_the_border_of_faces_is_their_outline():
    # Two triangles that share the edge 0-2.
    edges = np.array([[0, 1], [1, 2], [2, 0], [2, 3], [3, 0]], dtype=np.int32)
    face_edges = np.array([0, 1, 2, 2, 3, 4], dtype=np.int32)
    assert outline_edges(edges, face_edges).tolist() == [[0, 1], [1, 2], [2, 3], [3, 0]]


def rotations():
    quaternion = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)
    return quaternion.map(lambda q: _matrix(np.array(q) / np.linalg.norm(q)))


def _matrix(q):
    w, v = q[0], q[1:]
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


@settings(deadline=None)
@given(
    rotations(),
    rotations(),
    st.tuples(*[st.floats(0.05, 20.0)] * 3),
    st.tuples(*[st.sampled_from([-1.0, 1.0])] * 3),
    st.sampled_from([1e-6, 1.0, 1e6]),
)
def test_the_plane_has_the_worlds_lengths_and_goes_back(tilt, turn, scale, signs, size):
    generator = np.random.default_rng(7)
    flat = np.zeros((20, 3))
    flat[:, :2] = size * generator.normal(size=(20, 2))
    points = flat @ tilt.T + size * generator.normal(size=3)
    to_world = turn @ np.diag(np.array(scale) * signs)

    plane = fit_plane(points, to_world)
    in_plane = plane.flatten(points)

    extent = np.ptp(points, axis=0).max()
    assert np.abs(plane.lift(in_plane) - points).max() <= 2e-6 * extent  # flatter than single precision is flat
    in_world = points @ to_world.T
    for i, j in ((0, 1), (2, 9), (5, 13)):
        expected = np.linalg.norm(in_world[i] - in_world[j])
        assert np.linalg.norm(in_plane[i] - in_plane[j]) == pytest.approx(expected, rel=1e-6)


def test_counter_clockwise_in_the_plane_faces_the_curves_own_up():
    square = np.array([[0, 0, 0], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0]], dtype=float)  # tilted, seen from +Z
    for to_world in (np.eye(3), np.diag([-1.0, 1.0, 1.0]), np.diag([2.0, -3.0, -1.0])):
        x, y = fit_plane(square, to_world).flatten(square).T
        assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0


@pytest.mark.parametrize(
    ("points", "to_world", "reason"),
    [
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.01], [0, 1, 0]], np.eye(3), "not-planar"),
        ([[0, 0, 0], [1, 0, 1], [2, 0, 2]], np.eye(3), "zero-area"),
        ([[1, 2, 3]] * 4, np.eye(3), "zero-area"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.diag([1.0, 0.0, 1.0]), "zero-area"),
        ([[0, 0, 0], [1, 0, np.nan], [0, 1, 0]], np.eye(3), "not-finite"),
    ],
)
def test_points_without_a_plane_are_refused(points, to_world, reason):
    with pytest.raises(ContourError) as refusal:
        fit_plane(np.array(points, dtype=float), to_world)
    assert refusal.value.reason == reason
