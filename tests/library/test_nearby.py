"""What is looked for by trees and in rounds is what looking at everything would find."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera.bridges
from tessera.bridges import bridge_holes, segment_distances
from tessera.constraints import Domain, planar_domain
from tessera.contour import clean_loop
from tessera.cuts import graph_polygons
from tessera.nearby import along_curve, build_boxes, meeting
from tessera.predicates import segments_cross
from tessera.proposals import Net, Wanted, propose
from tessera.thickness import FACING, _tree, first_exits
from tests.library.polygons import circle, seeds
from tests.library.test_bridges import regions

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def random_boxes(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Boxes of very different sizes, half of them on a coarse grid so that many touch, in three groups."""
    low = rng.normal(size=(n, 2)) * 10 ** rng.uniform(-3, 1, (n, 1))
    high = low + rng.random((n, 2)) * 10 ** rng.uniform(-4, 1, (n, 1))
    coarse = rng.random(n) < 0.5
    low[coarse], high[coarse] = np.round(low[coarse]), np.round(high[coarse])
    return low, high, rng.integers(0, 3, n)


@settings(deadline=None, max_examples=50)
@given(seeds, st.integers(1, 300), st.integers(0, 60))
def test_a_tree_of_boxes_finds_all_that_meet(seed, n, n_asked):
    rng = np.random.default_rng(seed)
    low, high, group = random_boxes(rng, n)
    below, above, of = random_boxes(rng, n_asked)
    asked, found = meeting(build_boxes(low, high, group), below, above, of)
    meet = np.all((low <= above[:, None]) & (high >= below[:, None]), axis=2) & (group == of[:, None])
    assert np.array_equal(np.column_stack([asked, found]), np.argwhere(meet))


@settings(deadline=None, max_examples=20)
@given(seeds, st.integers(1, 200))
def test_the_order_along_a_curve_is_that_of_each_group_alone(seed, n):
    low, _, group = random_boxes(np.random.default_rng(seed), n)
    order = along_curve(low, group)
    alone = [
        rows[along_curve(low[rows], np.zeros(len(rows), dtype=int))]
        for rows in map(np.flatnonzero, group == np.arange(3)[:, None])
    ]
    assert order.tolist() == np.concatenate(alone).tolist()


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_distances_of_segments(seed):
    a, b, c, d = np.random.default_rng(seed).normal(size=(4, 20, 2))
    s = np.linspace(0, 1, 200)[:, None, None]
    first, second = a + s * (b - a), c + s * (d - c)
    brute = np.array([np.linalg.norm(first[:, None, k] - second[None, :, k], axis=2).min() for k in range(20)])
    found = segment_distances(a, b, c, d)
    assert (found <= brute + 1e-12).all() and (found >= brute - 0.05).all()
    assert ((found == 0) == segments_cross(a, b, c, d)).all()


def holes(seed: int, n: int, jitter: float = 0.4) -> list[np.ndarray]:
    """A square with n² round holes, somewhat out of line."""
    rng = np.random.default_rng(seed)
    centres = 1 + 2 * np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2)
    return [SQUARE * 2 * n] + [circle(8) * 0.5 + c for c in centres + rng.uniform(-jitter, jitter, (n * n, 2))]


@settings(deadline=None, max_examples=20)
@given(seeds, st.integers(2, 5))
def test_what_is_proposed_is_seen(seed, n):
    """Every bridge leads to the left and meets no edge, by all edges; and nothing much closer is seen."""
    loops = [clean_loop(loop) for loop in holes(seed, n)]
    points, size = np.concatenate(loops), np.array([len(loop) for loop in loops])
    after = np.concatenate([np.roll(np.arange(s), -1) + f for s, f in zip(size, np.cumsum(size) - size, strict=True)])
    net = Net(points, np.full(len(points), 0.4), np.zeros(len(points), int), np.arange(len(points)), after)
    first = np.cumsum(size) - size
    tips = np.array([f + np.lexsort(loop.T[::-1])[0] for f, loop in zip(first[1:], loops[1:], strict=True)])
    found = propose(net, tips, Wanted(np.array([0.4]), np.array([0]), None))
    assert np.array_equal(found.tip, tips) and (points[found.goal, 0] < points[tips, 0]).all()
    hidden = segments_cross(points[tips, None, None], points[None, :, None], points, points[after]).any(axis=2)
    assert not hidden[np.arange(len(tips)), found.goal].any()
    away = np.linalg.norm(points[tips, None] - points, axis=2)
    away[hidden | (points[:, 0] >= points[tips, 0][:, None])] = np.inf
    assert (away[np.arange(len(tips)), found.goal] <= 8 * away.min(axis=1)).all()


@pytest.mark.parametrize("n", [6, 24])
def test_few_rounds_find_the_bridges_of_many_holes(n, monkeypatch):
    """What is counted is work: rounds, and vertices that look for a bridge, of which most find one at once."""
    asked = []

    def counted(net, tips, wanted):
        asked.append(len(tips))
        return propose(net, tips, wanted)

    monkeypatch.setattr(tessera.bridges, "propose", counted)
    loops = [clean_loop(loop) for loop in holes(3, n)]
    bridge_holes(loops, *regions(loops), 0.4)
    assert len(asked) <= 10 and sum(asked) < 2.5 * n * n
    asked.clear()
    corners = [loop.mean(axis=0) for loop in loops[1:]]
    lines = [np.stack([c - [0.3, 0.1], c + [0.3, 0.1]]) for c in corners]
    graph_polygons(planar_domain(Domain([SQUARE * 2 * n], None, None, lines)).graph, np.array([1.0]))
    assert len(asked) <= 12 and sum(asked) < 3 * n * n


def test_a_fan_of_bridges_to_one_vertex():
    """Points in a column see the same corner, and their bridges are too near each other to come at once."""
    column = np.column_stack([np.full(40, 1.0), np.linspace(-0.5, 0.5, 40)])
    loop = np.array([[0.0, 0], [1.0, -3], [3, -3], [3, 3], [1.0, 3]])
    graph = planar_domain(Domain([loop], None, column, ())).graph
    points, polygons = graph_polygons(graph, np.array([3.0]))
    assert polygons.size.min() >= 3
    assert len(points) >= len(graph.points) == 45
    assert set(polygons.corners.tolist()) == set(range(len(points)))


@settings(deadline=None, max_examples=40)
@given(seeds, st.integers(1, 6))
def test_rays_leave_where_the_first_edge_is(seed, n):
    """Rays of any reach, by all edges: those that hit nothing near go on in steps, to the same end."""
    loops = [loop if k == 0 else loop[::-1] for k, loop in enumerate(holes(seed, n))]
    start = np.concatenate(loops)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 2 * np.pi, 50)
    origin, direction = rng.uniform(0, 2 * n, (50, 2)), np.column_stack([np.cos(angle), np.sin(angle)])
    reach = rng.uniform(0.1, 4 * n, 50)
    along, offset = end - start, start - origin[:, None]
    facing = direction[:, :1] * along[:, 1] - direction[:, 1:] * along[:, 0]
    far = (offset[..., 0] * along[:, 1] - offset[..., 1] * along[:, 0]) / facing
    at = (offset[..., 0] * direction[:, 1:] - offset[..., 1] * direction[:, :1]) / facing
    far[(facing <= 0) | (far <= 0) | (at < 0) | (at > 1) | (far > reach[:, None])] = np.inf
    first = far.argmin(axis=1)
    rows = np.arange(50)
    straight = facing[rows, first] >= np.cos(FACING) * np.linalg.norm(along[first], axis=1)
    expected = np.where(straight, far[rows, first], np.inf)
    found = first_exits(origin, direction, reach, start, end, _tree(start, end))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_rays_along_the_sides_of_boxes_are_followed():
    """From the vertices of one side of a square to those of the other, between which the boxes of the tree end."""
    n = 16
    side = np.column_stack([np.arange(n), np.zeros(n)])
    loop = np.concatenate([side, side[:, ::-1] + [n, 0], n - side, [0, n] - side[:, ::-1]])
    origin = np.column_stack([np.ones(n - 1), np.arange(1, n)])
    end = np.roll(loop, -1, axis=0)
    found = first_exits(origin, np.tile([1.0, 0], (n - 1, 1)), np.full(n - 1, 2.0 * n), loop, end, _tree(loop, end))
    assert (found == n - 1).all()
