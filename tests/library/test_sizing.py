"""Sizing functions: what they give, that meshes and boundaries follow them, and a clear error for what is no length."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera.boundary import resample_loops
from tessera.contour import clean_loop
from tessera.edges import inner_edges
from tessera.gradation import prepare
from tessera.sampling import neighbours, sample_domain
from tessera.sizing import checked_limits
from tests.library.polygons import LETTER_E, circle, letter_s, seeds, simple_polygons, star
from tests.validity import check_mesh, on_the_loops, polygon_area

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
BAR = np.array([[0.0, 0], [3, 0], [3, 0.2], [0, 0.2]])
NOSE = [(0.3, 0.4)]


def jump(points: np.ndarray) -> np.ndarray:
    return np.where(points[:, 0] + 0.3 * points[:, 1] < 0.5, 0.02, 1.0)


def target_of(loop, sizing, edge_length=0.2, min_edge_length=None, gradation=1.3, most=5_000_000):
    """The graded sizing of a domain as a function of points alone."""
    limits = checked_limits(edge_length, min_edge_length, gradation, np.radians(32.0))
    target, errors = prepare({0: [clean_loop(loop)]}, [(sizing, limits)], most)
    if errors:
        raise errors[0]
    return lambda points: target(points, np.zeros(len(points), dtype=np.int64))


def relative_lengths(mesh: tessera.Mesh, target) -> np.ndarray:
    """Lengths of the inner edges over what is wanted in their middle."""
    edges, inner = inner_edges(mesh.triangles)
    a, b = np.moveaxis(mesh.vertices[edges[inner]], 1, 0)
    return np.linalg.norm(b - a, axis=1) / target(0.5 * (a + b))


SIZINGS = [
    jump,
    tessera.by_distance(0.01, NOSE),
    tessera.by_distance(0.02),
    tessera.by_distance(0.02, NOSE, reach=2),
    tessera.by_curvature(0.2),
    tessera.by_thickness(4),
    tessera.from_values(SQUARE * 0.8 + 0.1, [0.02, 0.1, 0.05, 0.2]),
    tessera.smallest(jump, tessera.by_distance(0.01, NOSE)),
    lambda points: 0.02 + np.abs(points[:, 0] - 0.4),
]


@settings(deadline=None, max_examples=40)
@given(seeds, st.sampled_from(SIZINGS), st.sampled_from([1.1, 1.3, 2.0]))
def test_the_gradation_holds_between_any_two_points(seed, sizing, gradation):
    target = target_of(SQUARE, sizing, gradation=gradation)
    rng = np.random.default_rng(seed)
    one = rng.random((500, 2))
    wanted = target(one)
    # An element farther on, in any direction, and anywhere.
    angle = rng.uniform(0, 2 * np.pi, 500)
    beside = np.clip(one + wanted[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), 0, 1)
    for other in (beside, rng.random((500, 2))):
        apart = np.linalg.norm(other - one, axis=1)
        # Where a function jumps, samples lie half an element apart.
        assert (target(other) <= 1.25 * wanted + 1.1 * np.log(gradation) * apart).all()


@pytest.mark.parametrize("sizing", SIZINGS)
def test_bounds_hold(sizing):
    points = np.random.default_rng(1).random((2000, 2))
    wanted = target_of(SQUARE, sizing, min_edge_length=0.05)(points)
    assert wanted.min() >= 0.05 and wanted.max() <= 0.2


@settings(deadline=None, max_examples=20)
@given(st.lists(st.sampled_from(SIZINGS[1:6]), min_size=2, max_size=3))
def test_combinations_are_the_smallest(sizings):
    outline, points = star(12, 0.8), np.random.default_rng(2).uniform(-0.5, 0.5, (1000, 2))
    each = [target_of(outline, sizing)(points) for sizing in sizings]
    together = target_of(outline, tessera.smallest(*sizings))(points)
    assert together == pytest.approx(np.min(each, axis=0), rel=0.01)
    assert target_of(SQUARE, tessera.smallest(*sizings, 0.011))(points).max() <= 0.011


def test_what_the_built_in_ones_give():
    points = np.random.default_rng(3).random((300, 2))
    away = np.linalg.norm(points - NOSE, axis=1)
    slope = np.log(1.3)
    near = target_of(SQUARE, tessera.by_distance(0.01, NOSE))(points)
    assert near == pytest.approx(np.minimum(0.01 + slope * away, 0.2), rel=0.02)
    far = target_of(SQUARE, tessera.by_distance(0.02, NOSE, reach=2))(points)
    assert far == pytest.approx(0.02 + (0.2 - 0.02) / 2 * away, rel=0.02)
    inside = np.minimum(points, 1 - points).min(axis=1)
    contour = target_of(SQUARE, tessera.by_distance(0.02))(points)
    assert contour == pytest.approx(np.minimum(0.02 + slope * inside, 0.2), rel=0.02)
    outline = circle(200)
    assert target_of(outline, tessera.by_curvature(0.1))(outline) == pytest.approx(0.1, rel=0.01)
    square = target_of(SQUARE, tessera.by_curvature(0.1))(points)
    assert square == pytest.approx(0.2)  # corners have no curvature
    bar = target_of(BAR, tessera.by_thickness(4), edge_length=0.5)(points * [2, 0.2] + [0.5, 0])
    assert bar == pytest.approx(0.05, rel=0.1)


def test_values_at_points_are_met_there_and_kept_to_between():
    rng = np.random.default_rng(4)
    points, values = rng.random((60, 2)), rng.uniform(0.1, 0.2, 60)
    sizing = tessera.from_values(points, values)
    assert sizing(points) == pytest.approx(values)
    between = sizing(rng.uniform(-1, 2, (500, 2)))
    assert between.min() >= values.min() - 1e-12 and between.max() <= values.max() + 1e-12
    assert tessera.from_values([(0, 0), (1, 0)], [0.1, 0.3])(np.array([[0.5, 3.0]])) == pytest.approx(0.2)


@pytest.mark.parametrize("elements", [2, 3, 5])
def test_thin_parts_have_so_many_elements_across(elements):
    mesh = tessera.mesh([BAR], 0.5, sizing=tessera.by_thickness(elements))
    check_mesh(mesh.vertices, mesh.triangles, [BAR], keep=False)
    x = mesh.vertices[mesh.triangles][..., 0]
    across = [np.count_nonzero((x.min(axis=1) < at) & (x.max(axis=1) > at)) for at in np.linspace(0.4, 2.6, 60)]
    assert min(across) >= elements


def test_a_corner_is_no_thin_part_and_a_wedge_is():
    corner = np.array([[0.0, 0], [1, 0], [0.5, 0.8]])
    assert target_of(corner, tessera.by_thickness(1))(corner) == pytest.approx(0.2)
    wedge = np.array([[0.0, 0], [1, -0.1], [1, 0.1]])
    wanted = target_of(wedge, tessera.by_thickness(3))(np.array([[0.6, 0.0], [0.02, 0.0]]))
    assert wanted == pytest.approx([0.04, 0.002], rel=0.2)


@pytest.mark.parametrize("loop", [circle(300), letter_s(), LETTER_E / 5], ids=["o", "S", "E"])
@pytest.mark.parametrize("sizing", [tessera.by_distance(0.01, NOSE), jump, tessera.by_curvature(0.2)])
def test_the_boundary_follows_the_sizing_and_stays_on_the_curve(loop, sizing):
    target = target_of(loop, sizing)
    (found,) = resample_loops([loop], lambda points, domain: target(points))
    on_the_loops(found, [loop])
    assert polygon_area(found) == pytest.approx(polygon_area(loop), rel=0.05)
    after = np.roll(found, -1, axis=0)
    share = np.linspace(0.05, 0.95, 10)[:, None, None]
    wanted = target(((1 - share) * found + share * after).reshape(-1, 2)).reshape(10, -1)
    edges = np.linalg.norm(after - found, axis=1) * (1 / wanted).mean(axis=0)
    # Between corners there is a whole number of edges, and round bends an edge is shorter than the curve.
    assert np.median(edges) == pytest.approx(1, abs=0.1) and edges.min() > 0.6 and edges.max() < 1.5
    if loop[0, 0] == 0:
        assert {tuple(p) for p in loop} <= {tuple(p) for p in found}


def test_the_corner_angle():
    polygon = circle(12)  # turns by 30 degrees at each vertex
    # Without corners there are 32 vertices, of which every eighth is one of the 12.
    for angle, kept in ((25.0, 12), (35.0, 4)):
        found = tessera.mesh([polygon], 0.2, corner_angle=angle).vertices
        assert sum((np.abs(found - p).max(axis=1) < 1e-9).any() for p in polygon) == kept


def test_keep_keeps_exactly_the_given_vertices():
    loop = circle(40)
    mesh = tessera.mesh([loop], 0.3, sizing=tessera.by_distance(0.03, [(0, 0)]), boundary="keep")
    check_mesh(mesh.vertices, mesh.triangles, [loop])
    assert mesh.report.n_triangles > 150


@pytest.mark.parametrize(
    ("loop", "edge_length", "sizing"),
    [
        (circle(200), 0.2, tessera.by_distance(0.02, NOSE)),
        (circle(200), 0.25, tessera.by_distance(0.05)),
        (SQUARE * [2, 1], 0.2, jump),
        (star(12, 0.8), 0.25, tessera.smallest(tessera.by_thickness(3), tessera.by_curvature(0.3))),
        (letter_s(), 0.5, tessera.by_thickness(3)),
    ],
    ids=["point", "contour", "jump", "star", "S"],
)
def test_inner_edges_are_as_long_as_wanted(loop, edge_length, sizing):
    mesh = tessera.mesh([loop], edge_length, sizing=sizing)
    check_mesh(mesh.vertices, mesh.triangles, [loop], keep=False)
    ratio = relative_lengths(mesh, target_of(loop, sizing, edge_length))
    assert np.mean((ratio > 0.7) & (ratio < 1.4)) > 0.85 and 0.85 < ratio.mean() < 1.1
    assert mesh.report.q_worst > 0.4 and mesh.report.q_mean > 0.9


@pytest.mark.parametrize("boundary", ["resample", "keep"])
def test_around_holes(boundary):
    loops = [SQUARE * 4, circle(80) * 0.6 + 1.5, circle(50) * 0.4 + [2.8, 2.9], circle(30) * 0.2 + [2.8, 2.9]]
    sizing = tessera.smallest(tessera.by_curvature(0.3), tessera.by_thickness(3))
    mesh = tessera.mesh(loops, 0.5, sizing=sizing, boundary=boundary)
    check_mesh(mesh.vertices, mesh.triangles, loops, keep=boundary == "keep")
    assert mesh.report.q_mean > (0.9 if boundary == "resample" else 0.8)
    # Between the second hole and its island, the ring is 0.2 wide.
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    away = np.linalg.norm(middle - [2.8, 2.9], axis=1)
    assert np.count_nonzero((away > 0.4) & (away < 0.5)) > 25


def test_a_constant_sizing_is_an_edge_length():
    for loop in (LETTER_E / 5, circle(100)):
        plain = tessera.mesh([loop], 0.15)
        for edge_length, sizing in ((0.15, 0.2), (0.3, 0.15), (0.15, lambda points: np.full(len(points), 9.0))):
            mesh = tessera.mesh([loop], edge_length, sizing=sizing)
            np.testing.assert_array_equal(mesh.triangles, plain.triangles)
            np.testing.assert_allclose(mesh.vertices, plain.vertices, atol=1e-9)
        assert tessera.mesh([loop], 0.15, sizing=0.01, min_edge_length=0.15).report.n_triangles == len(plain.triangles)


@settings(deadline=None, max_examples=30)
@given(simple_polygons, seeds, st.sampled_from([1e-6, 1.0, 1e6]), st.sampled_from(["resample", "keep"]))
def test_meshes_are_valid_for_any_sizing(polygon, seed, scale, boundary):
    polygon, rng = polygon * scale, np.random.default_rng(seed)
    outline = np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).sum()
    longest = max(np.sqrt(abs(polygon_area(polygon)) / 30), outline / 100)
    waves, phase = rng.uniform(0, 30, (3, 2)) / np.ptp(polygon, axis=0).max(), rng.uniform(0, 6, 3)

    def wavy(points):
        return longest * np.exp(np.sin(points @ waves.T + phase).sum(axis=1) - 1)

    def broken(points):
        return np.where(np.sin(points @ waves[0]) > 0, longest / 3, np.inf)

    sizing = [
        wavy,
        broken,
        tessera.smallest(wavy, tessera.by_distance(longest / 10, polygon[:1])),
        tessera.smallest(tessera.by_curvature(0.3), tessera.by_thickness(2)),
    ][rng.integers(4)]
    least = {"min_edge_length": longest / 5, "gradation": float(rng.uniform(1.05, 3))}
    mesh = tessera.mesh([polygon], longest, sizing=sizing, boundary=boundary, **least)
    check_mesh(mesh.vertices, mesh.triangles, [polygon], keep=boundary == "keep")


def test_a_batch_is_each_domain_alone():
    def sizing(points):
        return np.where(points[:, 0] > 5, np.nan, 0.05 + 0.1 * np.abs(points[:, 1]))

    sizing = tessera.smallest(sizing, tessera.by_curvature(0.3), tessera.by_distance(0.03, NOSE))
    domains = [[SQUARE], [circle(50)], [SQUARE + [5.5, 0]], [circle(60), circle(40) + [0, 3]], [letter_s()]]
    together = tessera.mesh_many(domains, 0.3, sizing=sizing)
    assert together[2].reason == "sizing"
    for domain, mesh in zip(domains, together, strict=True):
        if isinstance(mesh, tessera.Mesh):
            alone = tessera.mesh(domain, 0.3, sizing=sizing)
            np.testing.assert_array_equal(alone.triangles, mesh.triangles)
            np.testing.assert_array_equal(alone.vertices, mesh.vertices)


@pytest.mark.parametrize(
    ("sizing", "message"),
    [
        (lambda points: np.zeros(len(points)), "0 at"),
        (lambda points: np.where(points[:, 0] > 0.7, np.nan, 0.1), "nan at"),
        (lambda points: points[:, 1] - 0.5, "-0"),
        (lambda points: points, "shape"),
        (lambda points: np.ones((len(points), 1)), "shape"),
        (lambda points: 0.1, "float"),
        (lambda points: "long", "str"),
        (lambda points: None, "NoneType"),
        (lambda points: np.full(len(points), 0.1 + 0.1j), "complex128"),
        (lambda points: np.full(len(points), np.timedelta64(1)), "timedelta64"),
    ],
)
def test_a_function_that_gives_no_lengths(sizing, message):
    for whole in (sizing, tessera.smallest(0.3, sizing)):
        with pytest.raises(tessera.ContourError, match=message) as error:
            tessera.mesh([SQUARE], 0.2, sizing=whole)
        x, y = error.value.place
        assert error.value.reason == "sizing" and 0 <= x <= 1 and 0 <= y <= 1
        assert f"({x:g}, {y:g})" in str(error.value) and str(error.value).endswith(".")
    if message == "nan at":
        assert error.value.place[0] > 0.7


def test_a_function_that_fails_only_while_meshing():
    asked = []

    def sizing(points):
        if points.max() < 2:
            asked.append(len(points))
        return np.where((points.max() > 2) | (len(asked) < 6), 0.1 + 0.05 * points[:, 0], np.nan)

    broken, sound = tessera.mesh_many([[SQUARE], [SQUARE + 3]], 0.3, sizing=sizing)
    assert broken.reason == "sizing" and 0 <= min(broken.place) and max(broken.place) <= 1
    np.testing.assert_array_equal(sound.vertices, tessera.mesh([SQUARE + 3], 0.3, sizing=sizing).vertices)


@pytest.mark.parametrize(
    "make",
    [
        lambda: 0,
        lambda: "short",
        lambda: tessera.by_curvature(0),
        lambda: tessera.by_thickness(np.nan),
        lambda: tessera.by_distance(-1),
        lambda: tessera.by_distance(1, [1, 2, 3]),
        lambda: tessera.from_values([(0, 0), (1, 0)], [1]),
        lambda: tessera.from_values([(0, 0), (1, 0)], [1, 0]),
    ],
)
def test_numbers_that_are_no_sizing(make):
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh([SQUARE], 0.2, sizing=make())
    assert error.value.reason == "sizing" and str(error.value).endswith(".")


def test_limits_that_are_none():
    for wrong in ({"min_edge_length": 0.3}, {"min_edge_length": -1}, {"min_edge_length": np.nan}):
        with pytest.raises(tessera.ContourError) as error:
            tessera.mesh([SQUARE], 0.2, **wrong)
        assert error.value.reason == "edge-length"
    for wrong in ({"gradation": 1.0}, {"gradation": np.inf}, {"corner_angle": 0}, {"corner_angle": 180}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            tessera.mesh([SQUARE], 0.2, **wrong)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("length", [5e-324, 1e-300, 1e-9, 1e-5, 3e-4])
def test_too_many_triangles_are_seen_before_they_are_made(length):
    asked = []

    def sizing(points):
        asked.append(len(points))
        return np.full(len(points), length)

    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh([SQUARE], 0.2, sizing=sizing)
    assert error.value.reason == "too-many-triangles" and error.value.place is not None and sum(asked) < 200_000


@pytest.mark.parametrize("sizing", [lambda p: np.full(len(p), 1e-5), lambda p: 1e-5 + 1e-4 * p[:, 0]])
def test_the_remedy_for_too_many_triangles_is_one(sizing):
    factor = 1.0
    while factor < 1e4:
        try:
            target_of(SQUARE, lambda points, by=factor: by * sizing(points), most=20_000)
            break
        except tessera.ContourError as error:
            factor *= float(str(error).split("Multiply it by ")[1].split()[0])
    with pytest.raises(tessera.ContourError):
        target_of(SQUARE, lambda points: factor / 1.3 * sizing(points), most=20_000)


@settings(deadline=None, max_examples=30)
@given(simple_polygons)
def test_samples_cover_the_domain(polygon):
    polygon = clean_loop(polygon)
    size = np.ptp(polygon, axis=0).max()
    middle = polygon[0]

    def function(points):
        return size / 100 + 0.3 * np.linalg.norm(points - middle, axis=1)

    samples = sample_domain([polygon], function, lambda samples: samples.size > samples.values)
    assert (samples.size <= samples.values).all()
    covered = np.sum(samples.size[samples.inside] ** 2)
    assert covered == pytest.approx(polygon_area(polygon), abs=np.sum(samples.size[samples.boundary() > 0] ** 2))
    outline = np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).sum()
    assert samples.boundary().sum() == pytest.approx(outline)
    one, other = neighbours(samples)
    assert (samples.size[one] <= samples.size[other]).all()
    low, side = samples.corner * samples.size[:, None], samples.size[:, None]
    gap = np.maximum(low[one] - (low + side)[other], low[other] - (low + side)[one])
    assert (np.abs(gap.max(axis=1)) <= 1e-9 * size).all(), "cells that do not touch"
