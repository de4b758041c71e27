"""Several regions as one mesh: shared edges have the same vertices, every triangle knows its region."""

import tracemalloc
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera.constraints import Domain, planar_domain
from tests.library.polygons import circle, placed, placements, seeds, simple_polygons
from tests.validity import check_mesh, check_partition, check_regions, polygon_area

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def bricks(seed: int) -> list[list[np.ndarray]]:
    """Rows of four-sided regions whose joints are not above each other: vertices of one amid edges of another.

    Some have a hole, which another region fills, or nothing does; and some are left out.
    """
    rng = np.random.default_rng(seed)
    heights = np.cumsum(np.append(0, rng.uniform(0.3, 1.0, rng.integers(1, 4))))
    tilt = rng.uniform(-0.3, 0.3, 2)
    regions = []
    for low, high in pairwise(heights):
        joints = np.sort(np.append(rng.uniform(0.1, 2.9, rng.integers(0, 4)), [0, 3]))
        joints = joints[np.append(True, np.diff(joints) > 0.05)]
        for left, right in pairwise(joints):
            brick = np.array([[left, low], [right, low], [right, high], [left, high]])
            size = 0.3 * min(right - left, high - low)
            inner = circle(int(rng.integers(3, 9))) * size + [0.5 * (left + right), 0.5 * (low + high)]
            kind = rng.integers(5)
            if kind == 0:
                regions += [[brick, inner], [inner[::-1]]]
            elif kind < 4 or not regions:
                regions.append([brick, inner] if kind == 1 else [brick])
    shear = np.array([[1, tilt[0]], [tilt[1], 1]])
    return [[loop @ shear for loop in loops] for loops in regions]


@settings(deadline=None, max_examples=30)
@given(seeds, placements, st.sampled_from(["resample", "keep"]), st.sampled_from([0.2, 0.6, 5.0]))
def test_bricks(seed, placement, boundary, edge_length):
    regions = [[placed(loop, placement) for loop in loops] for loops in bricks(seed)]
    mesh = tessera.mesh_regions(regions, edge_length * placement[0], boundary=boundary, corner_angle=1.0)
    # Whatever turns is a corner, so that the loops are covered however they are sampled.
    check_regions(mesh.vertices, mesh.triangles, mesh.region, regions, keep=True)


def halves(polygon: np.ndarray, cut: np.ndarray) -> list[list[np.ndarray]]:
    """A convex polygon cut by a polyline between its vertices 0 and k."""
    middle = len(polygon) // 2
    return [
        [np.concatenate([polygon[: middle + 1], cut[::-1]])],
        [np.concatenate([polygon[middle:], polygon[:1], cut])],
    ]


@settings(deadline=None, max_examples=20)
@given(seeds, st.sampled_from([0.05, 0.2, 1.0]), st.booleans())
def test_a_curved_border_is_sampled_once(seed, edge_length, sized):
    rng = np.random.default_rng(seed)
    x = np.linspace(1, -1, int(rng.integers(3, 60)))[1:-1]
    cut = np.column_stack([x, rng.uniform(-0.3, 0.3) * np.sin(rng.uniform(1, 9) * x) * (1 - x**2)])
    sizing = (lambda places: 0.3 * edge_length + 0.4 * np.hypot(*places.T)) if sized else None
    regions = halves(circle(40), cut)
    mesh = tessera.mesh_regions(regions, edge_length, sizing=sizing)
    check_regions(mesh.vertices, mesh.triangles, mesh.region, regions, keep=False)
    check_mesh(mesh.vertices, mesh.triangles, [circle(40)], keep=False)


def test_regions_may_lie_apart_touch_in_corners_or_fill_holes():
    ring, core, apart = [SQUARE * 4, circle(12) + 2], [circle(12) + 2], [SQUARE + 9]
    corner = [SQUARE * 2 + 4]
    regions = [ring, core, apart, corner]
    mesh = tessera.mesh_regions(regions, 0.5, boundary="keep")
    check_regions(mesh.vertices, mesh.triangles, mesh.region, regions)
    assert mesh.report.warnings == () or "kept boundary" in mesh.report.warnings[0]
    for number, loops in enumerate(regions):
        corners = mesh.vertices[mesh.triangles[mesh.region == number]]
        area = sum(map(polygon_area, corners))
        assert area == pytest.approx(abs(polygon_area(loops[0])) - sum(abs(polygon_area(p)) for p in loops[1:]))


@pytest.mark.parametrize("gap", [0.0, 1e-8, -1e-8, 3e-7])
def test_borders_meet_up_to_a_tolerance(gap):
    regions = [[SQUARE], [SQUARE * [1, 0.5] + [1 + gap, 0.2]]]
    mesh = tessera.mesh_regions(regions, 0.2)
    check_regions(mesh.vertices, mesh.triangles, mesh.region, regions)
    across = np.isin(mesh.triangles[mesh.region == 0], mesh.triangles[mesh.region == 1])
    assert len(np.unique(mesh.triangles[mesh.region == 0][across])) == 3  # 0.5 is 2 edges of about 0.2


@pytest.mark.parametrize(
    ("reason", "regions"),
    [
        ("overlap", [[SQUARE], [SQUARE / 2 + 0.25]]),
        ("overlap", [[SQUARE], [SQUARE]]),
        ("crossing", [[SQUARE], [SQUARE + 0.5]]),
        ("overlap", [[SQUARE], [SQUARE * 0.5 + [0.5, 0]]]),
        ("self-intersection", [[SQUARE], [SQUARE[[0, 2, 1, 3]] + 3]]),
        ("crossing", [[SQUARE, SQUARE + 0.5]]),
        ("too-few-points", []),
        ("too-many-triangles", [[SQUARE * 1e4], [SQUARE * 1e4 + [1e4, 0]]]),
    ],
)
def test_bad_regions(reason, regions):
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh_regions(regions, 0.3)
    assert error.value.reason == reason
    assert str(error.value).endswith(".") and len(str(error.value)) > 40
    if reason in ("overlap", "crossing"):
        assert error.value.place is not None and 0 <= min(error.value.place) <= max(error.value.place) <= 1


@settings(deadline=None, max_examples=15)
@given(simple_polygons, seeds)
def test_a_region_alone_is_a_domain(polygon, seed):
    h = 0.05 * float(np.ptp(polygon, axis=0).max())
    mesh = tessera.mesh_regions([[polygon]], h)
    check_mesh(mesh.vertices, mesh.triangles, [polygon], keep=False)
    assert (mesh.region == 0).all()


def test_the_region_is_the_outer_contour_around_each_triangle():
    loops = [SQUARE / 4 + 0.3, SQUARE, SQUARE / 8 + 0.35, SQUARE + 2]
    mesh = tessera.mesh(loops, 0.1)
    assert mesh.region.dtype == np.int32 and len(mesh.region) == len(mesh.triangles)
    centre = mesh.vertices[mesh.triangles].mean(axis=1)
    island = ((centre > 0.35) & (centre < 0.475)).all(axis=1)
    expected = np.where((centre > 1.5).all(axis=1), 3, np.where(island, 2, 1))
    np.testing.assert_array_equal(mesh.region, expected)
    assert (tessera.mesh_contour(SQUARE, 0.5).region == 0).all()


def test_a_batch_with_graphs_in_it_is_each_domain_alone():
    touching = [SQUARE, SQUARE + 1]
    domains = [[circle(40)], touching, [SQUARE, SQUARE / 3 + 0.3], [SQUARE * 2, [[0, 1], [0.6, 0.6], [0.6, 1.3]]]]
    for domain, mesh in zip(domains, tessera.mesh_many(domains, 0.06), strict=True):
        alone = tessera.mesh(domain, 0.06)
        np.testing.assert_array_equal(alone.vertices, mesh.vertices)
        np.testing.assert_array_equal(alone.triangles, mesh.triangles)
        np.testing.assert_array_equal(alone.region, mesh.region)


TOUCHING = {
    "corner to corner": [SQUARE, SQUARE + 1],
    "a corner on an edge": [SQUARE, np.array([[1, 0.4], [2, 0], [2, 1]])],
    "side by side": [SQUARE, SQUARE * [1, 0.5] + [1, 0.2]],
    "a hole with a corner on the contour": [SQUARE, np.array([[0, 0.5], [0.4, 0.2], [0.4, 0.7]])],
    "a hole in a corner": [SQUARE, np.array([[0, 0], [0.5, 0.2], [0.2, 0.5]])],
    "a hole across": [SQUARE, np.array([[0, 0.5], [0.5, 0.3], [1, 0.5], [0.5, 0.7]])],
    "two holes": [SQUARE, SQUARE / 4 + 0.2, SQUARE / 4 + 0.45],
    "an island at its hole": [SQUARE, SQUARE / 2 + 0.25, SQUARE * [0.3, 0.1] + [0.25, 0.4]],
    "an hourglass": [np.array([[0, 0], [2, 0], [1, 1], [2, 2], [0, 2], [1, 1]])],
    "a ring closed at a vertex": [np.array([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]])],
}


@pytest.mark.parametrize("boundary", ["resample", "keep"])
@pytest.mark.parametrize("edge_length", [0.09, 0.4])
@pytest.mark.parametrize("name", TOUCHING)
def test_contours_that_touch_are_meshed_with_a_warning(name, edge_length, boundary):
    loops = TOUCHING[name]
    mesh = tessera.mesh(loops, edge_length, boundary=boundary)
    check_partition(mesh.vertices, mesh.triangles)
    outer = np.unique(mesh.region)
    assert "touch" in " ".join(mesh.report.warnings)
    area = sum(map(polygon_area, mesh.vertices[mesh.triangles]))
    size = [abs(polygon_area(np.asarray(p))) for p in loops]
    holes = [p for k, p in enumerate(size) if k not in outer]
    assert area == pytest.approx(sum(size[k] for k in outer) - sum(holes))
    if edge_length == 0.09 and boundary == "resample":
        assert mesh.report.q_mean > 0.8


@pytest.mark.parametrize(
    ("reason", "loops"),
    [
        ("crossing", [SQUARE, SQUARE / 2 + [0, 0.25]]),  # a hole along the contour
        ("crossing", [SQUARE * 4, SQUARE + [1, 1], SQUARE + [2, 1.2]]),  # two holes along each other
        ("crossing", [SQUARE, SQUARE]),
        ("crossing", [SQUARE, [[0, 0.5], [1, 0], [1, 1], [2, 0.5], [0.5, 2]]]),  # through a vertex
        ("self-intersection", [[[0, 0], [1, 1], [2, 2], [2, 0], [1, 1], [0, 2]]]),  # the same
        ("self-intersection", [[[0, 0], [2, 0], [2, 2], [2, 5], [2, 2], [0, 2]]]),  # there and back
    ],
)
def test_what_cannot_be_told_apart_is_an_error(reason, loops):
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh(loops, 0.2)
    assert error.value.reason == reason and error.value.place is not None


def test_tiny_gaps_and_repeated_points_are_warned_of():
    hole = tessera.mesh([SQUARE, SQUARE / 5 + [0.001, 0.4]], 0.1)
    check_mesh(hole.vertices, hole.triangles, [SQUARE, SQUARE / 5 + [0.001, 0.4]], keep=False)
    assert "as near to each other as 0.001 at (0.001," in hole.report.warnings[0]
    beside = tessera.mesh([SQUARE, SQUARE + [1.0005, 0.1]], 0.1)
    assert "as near to each other as 0.0005" in beside.report.warnings[0]
    assert tessera.mesh([SQUARE, SQUARE + [1.1, 0.1]], 0.1).report.warnings == ()
    assert tessera.mesh([np.repeat(SQUARE, 2, axis=0)], 0.3).report.warnings == (
        "4 repeated points of contours are left out",
    )
    assert tessera.mesh([np.concatenate([SQUARE, SQUARE[:1]])], 0.3).report.warnings == ()


def test_a_hole_that_another_region_fills_is_no_thin_part():
    regions = [[SQUARE * 4, circle(12) + 2], [circle(12) + 2]]
    plain = tessera.mesh_regions(regions, 0.5)
    sized = tessera.mesh_regions(regions, 0.5, sizing=tessera.by_thickness(2))
    assert sized.report.n_triangles < 1.5 * plain.report.n_triangles


def test_a_region_lost_in_the_tolerance_is_an_error():
    tiny = circle(16) * 2e-6 + 0.5
    for mesh in (
        lambda: tessera.mesh_regions([[SQUARE, tiny], [tiny]], 0.1),
        lambda: tessera.mesh([SQUARE, 0.1 * (tiny - 0.5) + 0.5], 0.1, lines=[[[0.5, 0.5 + 2e-7], [0.8, 0.5]]]),
    ):
        with pytest.raises(tessera.ContourError) as error:
            mesh()
        assert error.value.reason == "zero-area" and error.value.place == pytest.approx((0.5, 0.5), abs=1e-5)


def test_an_empty_region_has_no_triangles():
    mesh = tessera.mesh_regions((iter([loop]) for loop in (SQUARE, SQUARE + [1, 0])), 0.3)
    assert set(mesh.region.tolist()) == {0, 1}
    mesh = tessera.mesh_regions([[], [SQUARE]], 0.3)
    assert set(mesh.region.tolist()) == {1}


def test_memory_does_not_grow_with_the_square_of_the_number_of_regions():
    places = np.stack(np.meshgrid(np.arange(50), np.arange(50)), axis=-1).reshape(-1, 2)
    domain = Domain([SQUARE * 0.3 + place for place in places], np.arange(len(places)), None, ())
    tracemalloc.start()
    graph = planar_domain(domain).graph
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert graph.n_regions == len(places) and peak < 4 * len(places) ** 2  # half of a table of 8 bytes


@pytest.mark.parametrize("gap", [-1e-8, 0.0, 1e-8, 3e-7])
def test_contours_that_all_but_meet_have_common_vertices(gap):
    """As coordinates that were stored in 32 bits leave them, in a T and along a part of a side."""
    loops = [SQUARE * 2, SQUARE + [2 + gap, 0.5], SQUARE * 0.5 + [2 + gap, 1.5 + gap]]
    mesh = tessera.mesh(loops, 0.3)
    check_regions(mesh.vertices, mesh.triangles, mesh.region, [[loop] for loop in loops], keep=False)
    sides = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert mesh.report.n_vertices - len(np.unique(sides, axis=0)) + mesh.report.n_triangles == 1


def test_a_hole_nearer_to_its_contour_than_that_is_meshed_all_the_same():
    plate = [SQUARE, SQUARE * [0.5, 0.2] + [0.2, 1e-8]]
    mesh = tessera.mesh(plate, 0.2, boundary="keep")
    check_mesh(mesh.vertices, mesh.triangles, plate, keep=True)


def test_outlines_finer_than_the_tolerance_are_not_joined():
    """A hole of four millionths of its plate, a fifth of its own width away from another contour."""
    plate = [SQUARE, SQUARE * 0.2 + 0.4, SQUARE[[0, 1, 3]] * 4e-6 + [0.5, 0.4 - 4e-6 - 8e-7]]
    mesh = tessera.mesh(plate, 0.2, boundary="keep")
    check_mesh(mesh.vertices, mesh.triangles, plate, keep=True)


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0)])
def test_what_fills_a_hole_is_the_later_of_two_alike(order):
    loops = [[SQUARE * 3, SQUARE + 1, SQUARE + 1][i] for i in order]
    mesh = tessera.mesh(loops, 0.5)
    assert set(mesh.region) == {order.index(0), max(number for number, i in enumerate(order) if i)}


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1, 2.5])
def test_contours_beside_each_other_to_single_precision_are_no_thin_part(angle):
    turn = np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    loops = [SQUARE * 2, SQUARE + [2, 0.5], SQUARE + [2, 1.5]]
    loops = [(loop @ turn).astype(np.float32).astype(np.float64) for loop in loops]
    mesh = tessera.mesh(loops, 0.3, sizing=tessera.by_thickness(3))
    assert mesh.report.edge_lengths[0] > 0.1
