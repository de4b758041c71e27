"""Points that must be vertices and lines that must be edges: they are, in a valid mesh, or there is a clear error."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera.edges import among
from tessera.flips import flip_edges
from tests.library.polygons import LETTER_E, circle, placed, placements, seeds, staircase
from tests.library.test_bridges import random_domain
from tests.validity import check_line, check_mesh, check_points, distances, side

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def inside(points: np.ndarray, loops) -> np.ndarray:
    """(n,) which points are inside an odd number of loops."""
    count = np.zeros(len(points), dtype=int)
    for loop in loops:
        (ax, ay), (bx, by) = loop.T, np.roll(loop, -1, axis=0).T
        for n, (x, y) in enumerate(points):
            spans = (ay > y) != (by > y)
            count[n] += np.sum(ax[spans] + (y - ay[spans]) / (by[spans] - ay[spans]) * (bx[spans] - ax[spans]) > x)
    return count % 2 == 1


def segments(curve: np.ndarray, closed: bool) -> list[tuple[np.ndarray, np.ndarray]]:
    curve = np.asarray(curve, dtype=float)
    ends = np.roll(curve, -1, axis=0) if closed else curve[1:]
    return list(zip(curve[: len(ends)], ends, strict=True))


def cross(one, other) -> bool:
    """Whether two segments in general position cross."""
    (a, b), (c, d) = one, other
    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def random_constraints(seed: int, loops) -> tuple[np.ndarray, list[np.ndarray]]:
    """Points and lines in a domain, away from contours and each other; some lines end where others, or contours, do."""
    rng = np.random.default_rng(seed)
    low, high = loops[0].min(axis=0), loops[0].max(axis=0)
    size = float((high - low).max())
    taken = [pair for loop in loops for pair in segments(loop, True)]
    points, lines = [], []
    for _ in range(25):
        places = rng.uniform(low, high, (int(rng.integers(1, 6)), 2))
        places[1:] = places[:1] + (places[1:] - places[:1]) * rng.choice([0.05, 0.3, 1.0])
        if lines and rng.random() < 0.3 and len(places) > 1:
            places[-1] = lines[rng.integers(len(lines))][rng.choice([0, -1])]
        if len(places) > 3 and rng.random() < 0.3:
            places = np.concatenate([places, places[:1]])
        new = segments(places, False)
        start, end = (np.array([pair[k] for pair in taken]) for k in (0, 1))
        shared = [len(lines) > 0 and any((p == q).all() for line in lines for q in line) for p in places]
        clear = [s or distances(p, start, end).min() > 1e-3 * size for p, s in zip(places, shared, strict=True)]
        others = np.concatenate([loops[0], *points, *lines]).reshape(-1, 2)
        for a, b in new:
            away = others[np.any(others != a, axis=1) & np.any(others != b, axis=1)]
            clear += [min(distances(p, a[None], b[None])[0] for p in away) > 1e-3 * size]
        crossed = any(cross(pair, other) for pair in new for other in taken)
        itself = any(cross(one, other) for k, one in enumerate(new) for other in new[:k])
        touching = any(
            distances(p, a[None], b[None])[0] < 1e-3 * size
            for a, b in new
            for p in places
            if (p != a).any() and (p != b).any()
        )
        if not all(clear) or crossed or itself or touching or not inside(places[:1], loops).all():
            continue
        if len(places) == 1:
            points.append(places)
            taken += [(places[0], places[0] + 1e-9 * size)]
        else:
            lines.append(places)
            taken += new
    return np.array(points).reshape(-1, 2), lines


@settings(deadline=None, max_examples=25)
@given(seeds, placements, st.sampled_from(["resample", "keep"]), st.sampled_from([0.05, 0.2, 2.0]))
def test_any_points_and_lines_in_any_domain(seed, placement, boundary, edge_length):
    loops = random_domain(seed)
    points, lines = random_constraints(seed, loops)
    loops = [placed(loop, placement) for loop in loops]
    points, lines = placed(points, placement), [placed(line, placement) for line in lines]
    h = edge_length * placement[0]
    mesh = tessera.mesh(loops, h, points=points, lines=lines, boundary=boundary, flips=bool(seed % 2), smooth=seed % 3)
    check_mesh(mesh.vertices, mesh.triangles, loops, keep=boundary == "keep")
    check_points(mesh.vertices, points)
    for line in lines:
        check_line(mesh.vertices, mesh.triangles, line, np.ptp(loops[0], axis=0).max(), boundary == "keep")


@settings(deadline=None, max_examples=15)
@given(seeds, st.sampled_from([0.03, 0.1, 0.3]))
def test_lines_on_a_grid(seed, edge_length):
    """Exact degeneracies: points under each other, lines that share ends, bend in right angles and end on contours."""
    rng = np.random.default_rng(seed)
    polygon = staircase(seed) / 8
    grid = np.stack(np.meshgrid(np.arange(1, 56), np.arange(1, 56)), axis=-1).reshape(-1, 2) / 64
    grid = grid[inside(grid + [1e-7, 2e-7], [polygon])]
    start, end = polygon, np.roll(polygon, -1, axis=0)
    grid = np.array([p for p in grid if distances(p, start, end).min() > 1e-9])
    points = grid[rng.permutation(len(grid))[: int(rng.integers(1, 20))]]
    lines = []
    for x in rng.choice(np.arange(1, 8), 2, replace=False) / 64:
        column = np.unique(points[:, 1])
        on = [p for p in grid if p[0] == x and p[1] in column]
        lines += [np.array(on)] if len(on) > 1 else []
    lines = [line for line in lines if inside(0.5 * (line[1:] + line[:-1]) + [1e-9, 0], [polygon]).all()]
    mesh = tessera.mesh([polygon], edge_length, points=points, lines=lines)
    check_mesh(mesh.vertices, mesh.triangles, [polygon], keep=False)
    check_points(mesh.vertices, points)
    for line in lines:
        check_line(mesh.vertices, mesh.triangles, line, 1.0)


def test_lines_may_end_at_contours_at_each_other_and_share_vertices():
    lines = [
        [[0, 0.5], [1, 0.5]],
        [[0.3, 0.5], [0.5, 0.9]],
        [[0.5, 1.0], [0.5, 0.9], [0.7, 0.7]],
        [[0.5, 0.5], [0.5, 0]],
    ]
    mesh = tessera.mesh([SQUARE], 0.1, lines=lines, points=[[0.8, 0.5]])
    check_mesh(mesh.vertices, mesh.triangles, [SQUARE], keep=False)
    for line in lines:
        check_line(mesh.vertices, mesh.triangles, line, 1.0, keep=True)
    check_points(mesh.vertices, [[0.8, 0.5]])
    assert mesh.report.q_mean > 0.93 and mesh.report.warnings == ()


def test_repeated_points_of_lines_are_warned_of():
    line = [[0.2, 0.5], [0.2, 0.5], [0.6, 0.5], [0.8, 0.7], [0.8, 0.7], [0.8, 0.7]]
    mesh = tessera.mesh([SQUARE], 0.3, lines=(part for part in [line]))
    check_line(mesh.vertices, mesh.triangles, line, 1.0)
    assert mesh.report.warnings == ("3 repeated points of lines are left out",)
    closed = tessera.mesh([SQUARE], 0.3, lines=[SQUARE[[0, 1, 2, 0]] / 2 + 0.2])
    assert closed.report.warnings == ()


def test_a_curved_line_is_sampled_at_the_target_and_keeps_its_corners():
    x = np.linspace(-0.7, 0.7, 200)
    line = np.concatenate([np.column_stack([x, 0.3 * np.sin(5 * x)]), [[0.7, 0.6]]])
    mesh = tessera.mesh([circle(60)], 0.08, lines=[line])
    check_line(mesh.vertices, mesh.triangles, line, 2.0)
    check_points(mesh.vertices, line[[0, -2, -1]])
    on = [v for v in mesh.vertices if distances(v, line[:-1], line[1:]).min() < 1e-12]
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert len(on) == pytest.approx(length / 0.08 + 1, rel=0.1)
    assert mesh.report.q_worst > 0.5


def test_a_closed_line_is_sampled_like_a_contour():
    mesh = tessera.mesh([SQUARE * 4 - 2], 0.2, lines=[np.concatenate([circle(100), circle(1 + 99)[:1]])])
    radius = np.linalg.norm(mesh.vertices, axis=1)
    assert np.count_nonzero(np.abs(radius - 1) < 1e-2) == 32  # near 2 π / 0.2, and easily halved


def test_the_sizing_function_holds_for_lines():
    line = [[-0.9, 0.0], [0.9, 0.0]]
    mesh = tessera.mesh([circle(60)], 0.2, lines=[line], sizing=lambda p: 0.04 + 0.1 * np.abs(p[:, 0]))
    check_line(mesh.vertices, mesh.triangles, line, 2.0)
    x = np.sort(mesh.vertices[mesh.vertices[:, 1] == 0, 0])
    assert np.diff(x).min() < 0.05 and np.diff(x).max() > 0.1


def test_many_points_at_once():
    grid = np.stack(np.meshgrid(np.arange(30), np.arange(30)), axis=-1).reshape(-1, 2) / 31 + 1 / 31
    mesh = tessera.mesh([SQUARE], 1 / 31, points=grid)
    check_mesh(mesh.vertices, mesh.triangles, [SQUARE], keep=False)
    check_points(mesh.vertices, grid)


@pytest.mark.parametrize(
    ("reason", "place", "points", "lines"),
    [
        ("outside", (2, 2), [[2, 2]], []),
        ("outside", (0.5, 0.5), [[0.5, 0.5]], []),  # in the hole
        ("outside", (-1e300, 0), [[-1e300, 0]], []),
        ("on-contour", (0.5, 0), [[0.5, 0]], []),
        ("on-contour", (1, 1), [[1, 1]], []),
        ("not-finite", None, [[np.nan, 0.5]], []),
        ("outside", (3, 0.1), None, [[[3, 0.1], [4, 0.1]]]),
        ("outside", (0.5, 0.5), None, [[[0.4, 0.5], [0.6, 0.5]]]),  # across the hole, from side to side
        ("crossing", (0.4, 0.5), None, [[[0.1, 0.5], [0.5, 0.5]]]),
        ("crossing", (0.2, 0.2), None, [[[0.1, 0.1], [0.3, 0.3]], [[0.1, 0.3], [0.3, 0.1]]]),
        ("crossing", (0.2, 0.2), None, [[[0.1, 0.1], [0.3, 0.3], [0.3, 0.1], [0.1, 0.3]]]),
        ("on-contour", (0.4, 0), None, [[[0.2, 0], [0.6, 0]]]),
        ("too-few-points", (0.1, 0.1), None, [[[0.1, 0.1]]]),
        ("too-few-points", (0.1, 0.1), None, [[[0.1, 0.1], [0.1, 0.1]]]),
        ("not-finite", None, None, [[[0.1, 0.1], [np.inf, 0.1]]]),
    ],
)
def test_bad_points_and_lines(reason, place, points, lines):
    loops = [SQUARE, SQUARE / 5 + 0.4]
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh(loops, 0.1, points=points, lines=lines)
    assert error.value.reason == reason
    assert error.value.place is None if place is None else error.value.place == pytest.approx(place)
    assert str(error.value).endswith(".") and len(str(error.value)) > 40


def test_wrong_shapes_are_plain_value_errors():
    for wrong in ({"points": [0.5, 0.5]}, {"lines": [[0.2, 0.2], [0.4, 0.4]]}, {"points": np.zeros((2, 3))}):
        with pytest.raises(ValueError, match="shape") as error:
            tessera.mesh([SQUARE], 0.2, **wrong)
        assert not isinstance(error.value, tessera.ContourError)


def test_points_given_twice_are_one_vertex_and_warned_of():
    mesh = tessera.mesh([SQUARE], 0.2, points=[[0.5, 0.5], [0.5, 0.5], [0.2, 0.2]])
    assert "more than once" in mesh.report.warnings[0]
    check_points(mesh.vertices, [[0.5, 0.5], [0.2, 0.2]])


def test_fixed_edges_are_not_flipped():
    rhombus = np.array([[-2.0, 0], [0, -0.5], [2, 0], [0, 0.5]])
    flat = np.array([[0, 1, 2], [0, 2, 3]])
    assert not np.array_equal(flip_edges(rhombus, flat), flat)
    assert np.array_equal(flip_edges(rhombus, flat, np.array([[2, 0]])), flat)
    assert among(np.array([[0, 2], [0, 1]]), np.array([[2, 0]])).tolist() == [True, False]


def test_constraints_in_a_letter():
    lines = [LETTER_E[[1]] / 7 * [0, 1] + [[0.1, 0.1], [0.1, 0.9]]]
    mesh = tessera.mesh([LETTER_E / 7], 0.08, lines=lines, boundary="resample", flips=True, smooth=3)
    check_line(mesh.vertices, mesh.triangles, lines[0], 1.0)
    assert mesh.report.q_worst > 0.4


@pytest.mark.parametrize(
    ("points", "lines"),
    [
        ([[0.5, 2e-5]], []),  # beside the contour
        ([[0.5, 0.5], [0.5, 0.5 + 2e-5]], []),
        ([[0.5, 0.5 + 2e-5]], [[[0.2, 0.5], [0.8, 0.5]]]),
    ],
)
@pytest.mark.parametrize("boundary", ["resample", "keep"])
def test_points_that_are_nearly_on_something_are_warned_of(points, lines, boundary):
    mesh = tessera.mesh([SQUARE], 0.1, points=points, lines=lines, boundary=boundary)
    check_points(mesh.vertices, points)
    assert any("near to each other as 2e-05 at (0.5" in warning for warning in mesh.report.warnings)


def test_loops_and_lines_may_be_any_iterable():
    mesh = tessera.mesh((loop for loop in [SQUARE]), 0.2, lines=(line for line in [[[0.2, 0.5], [0.8, 0.5]]]))
    check_line(mesh.vertices, mesh.triangles, [[0.2, 0.5], [0.8, 0.5]], 1.0)
    assert tessera.mesh((loop for loop in [SQUARE]), 0.5).report.n_triangles > 4
