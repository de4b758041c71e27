"""The public interface: any simple polygons at any target edge length, and a clear error for anything else."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera.budget import checked_domain
from tessera.contour import nesting
from tessera.domains import mesh_domains
from tessera.settings import Request, Settings
from tests.library.polygons import LETTER_E, circle, letter_s, placed, placements, simple_polygons, star
from tests.validity import check_mesh, polygon_area

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def target(polygon: np.ndarray, triangles: float) -> float:
    """The edge length of about so many equilateral triangles, but no shorter than the outline is fine."""
    outline = np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).sum()
    return max(np.sqrt(abs(polygon_area(polygon)) / triangles * 4 / np.sqrt(3)), outline / 300)


@settings(deadline=None, max_examples=40)
@given(simple_polygons, placements, st.sampled_from([2, 30, 300]), st.sampled_from(["resample", "keep"]))
def test_any_simple_polygon_is_meshed(polygon, placement, triangles, boundary):
    polygon = placed(polygon, placement)
    mesh = tessera.mesh([polygon], target(polygon, triangles), boundary=boundary)
    check_mesh(mesh.vertices, mesh.triangles, [polygon], keep=boundary == "keep")


@pytest.mark.parametrize("edge_length", [0.15, 0.05])
@pytest.mark.parametrize("polygon", [SQUARE, circle(100), LETTER_E / 7, letter_s()], ids=["square", "circle", "E", "S"])
def test_meshes_are_even(polygon, edge_length):
    mesh = tessera.mesh([polygon], edge_length)
    check_mesh(mesh.vertices, mesh.triangles, [polygon], keep=False)
    assert mesh.report.q_mean > 0.85
    if edge_length == 0.05:
        assert mesh.report.q_worst > 0.4 and mesh.report.q_mean > 0.93
        assert 0.7 < mesh.report.edge_lengths[1] / edge_length < 1.3


def test_a_target_too_long_for_the_shape_is_warned_of():
    assert "too long" in tessera.mesh([circle(60)], 10).report.warnings[0]
    assert tessera.mesh([circle(60)], 0.3).report.warnings == ()


def test_winding_order_and_repeats_do_not_matter():
    once = tessera.mesh([SQUARE], 0.2)
    for loop in (SQUARE[::-1], np.repeat(SQUARE, 2, axis=0), np.vstack([SQUARE, SQUARE[:1]])):
        again = tessera.mesh([loop], 0.2)
        assert again.report.n_triangles == pytest.approx(once.report.n_triangles, rel=0.1)
        check_mesh(again.vertices, again.triangles, [SQUARE], keep=False)


def test_several_outer_contours_are_one_mesh():
    loops = [SQUARE, SQUARE[::-1] + [3, 0], circle(40) + [0, 5]]
    mesh = tessera.mesh(loops, 0.2)
    check_mesh(mesh.vertices, mesh.triangles, loops, keep=False)


def test_a_kept_boundary_of_long_edges_is_graded():
    mesh = tessera.mesh([SQUARE * [8, 1]], 0.1, boundary="keep")
    check_mesh(mesh.vertices, mesh.triangles, [SQUARE * [8, 1]])
    assert "4 of the 4 kept boundary edges are longer" in mesh.report.warnings[0]


def test_a_kept_boundary_at_the_target_has_no_warning():
    assert tessera.mesh([circle(60)], 0.1, boundary="keep").report.warnings == ()


def test_refinement_reaches_the_inside_of_a_coarse_kept_boundary():
    coarse = circle(24)
    mesh = tessera.mesh([coarse], 0.05, boundary="keep")
    check_mesh(mesh.vertices, mesh.triangles, [coarse])
    inside = np.linalg.norm(mesh.vertices[mesh.triangles].mean(axis=1), axis=1) < 0.3
    corners = mesh.vertices[mesh.triangles[inside]]
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).mean() < 0.09


def test_a_batch_is_each_domain_alone():
    domains = [
        [SQUARE],
        [star(7)],
        [np.array([[0, 0], [1, 1], [2, 2]])],
        [circle(60), circle(60) + [4, 0]],
        [LETTER_E / 5],
    ]
    together = tessera.mesh_many(domains, 0.15)
    assert isinstance(together[2], tessera.ContourError) and together[2].reason == "zero-area"
    for domain, mesh in zip(domains, together, strict=True):
        if isinstance(mesh, tessera.Mesh):
            alone = tessera.mesh(domain, 0.15)
            np.testing.assert_array_equal(alone.triangles, mesh.triangles)
            np.testing.assert_array_equal(alone.vertices, mesh.vertices)


@settings(deadline=None, max_examples=12)
@given(st.data())
def test_domains_of_any_size_and_place_and_sizing_are_meshed_as_they_would_be_alone(data):
    shapes = [[circle(60)], [star(7)], [LETTER_E / 3], [circle(60) * 3, circle(24)], [SQUARE, SQUARE + [1, 0]]]
    sizings = [None, 0.3, tessera.by_distance(0.1), lambda points: np.full(len(points), 0.2)]
    requests = []
    for _ in range(data.draw(st.integers(2, 5))):
        loops, sizing = data.draw(st.sampled_from(shapes)), data.draw(st.sampled_from(sizings))
        # A sizing is in the loops' unit.
        scale = 1.0 if sizing is not None else 10.0 ** data.draw(st.integers(-6, 6))
        place = scale * np.array([data.draw(st.integers(-1000, 1000)), 0])
        length = scale * data.draw(st.sampled_from([-1.0, 0.2, 0.35, 1.0]))
        requests.append(Request([scale * loop + place for loop in loops], length, sizing))
    kept = Settings(boundary=data.draw(st.sampled_from(["resample", "keep"])), smooth=data.draw(st.integers(0, 1)))
    for request, together in zip(requests, mesh_domains(requests, kept), strict=True):
        (alone,) = mesh_domains([request], kept)
        if request.edge_length < 0:
            assert alone.reason == together.reason == "edge-length"
            continue
        np.testing.assert_array_equal(alone.vertices, together.vertices)
        np.testing.assert_array_equal(alone.triangles, together.triangles)
        assert alone.report.warnings == together.report.warnings


def test_a_batch_takes_an_edge_length_for_each_domain():
    first, second = tessera.mesh_many([[SQUARE], [SQUARE]], [0.5, 0.1])
    np.testing.assert_array_equal(second.vertices, tessera.mesh([SQUARE], 0.1).vertices)
    assert len(first.triangles) < len(second.triangles)
    with pytest.raises(ValueError, match="2 domains and 1 edge lengths"):
        tessera.mesh_many([[SQUARE], [SQUARE]], [0.5])


def test_domains_may_be_any_iterables():
    loops = [SQUARE * 4, SQUARE + 1]
    (one,) = tessera.mesh_many(((loop for loop in loops) for _ in range(1)), 0.8)
    np.testing.assert_array_equal(one.vertices, tessera.mesh((loop for loop in loops), 0.8).vertices)


def test_kept_long_edges_coarsen_no_other_mesh():
    plate, disk = [SQUARE * 4], [circle(24) * 0.5 + 0.6]
    (alone,) = mesh_domains([Request(disk, 0.1)], Settings(boundary="keep"))
    together = mesh_domains([Request(plate, 0.1), Request(disk, 0.1)], Settings(boundary="keep"))
    np.testing.assert_array_equal(together[1].vertices, alone.vertices)
    np.testing.assert_array_equal(together[1].triangles, alone.triangles)


def test_report():
    report = tessera.mesh([circle(80)], 0.2).report
    shortest, mean, longest = report.edge_lengths
    assert 0 < report.q_worst <= report.q_mean <= 1 and shortest <= mean <= longest
    assert report.n_triangles == 2 * report.n_vertices - 2 - 32  # the boundary's edges, near 2 π / 0.2
    assert {"division", "NN1", "NN2", "NN3", "triangulation", "relaxation"} <= set(report.seconds)


BOW_TIE = [(0, 0), (2, 2), (2, 0), (0, 2)]


@pytest.mark.parametrize(
    ("reason", "loops", "edge_length"),
    [
        ("not-finite", [[(0, 0), (1, 0), (np.nan, 1)]], 0.1),
        ("not-finite", [[(0, 0), (1, 0), (np.inf, 1)]], 0.1),
        ("too-few-points", [[(0, 0), (1, 0), (1, 0), (0, 0)]], 0.1),
        ("too-few-points", [[]], 0.1),
        ("too-few-points", [], 0.1),
        ("zero-area", [[(0, 0), (1, 0), (2, 0)]], 0.1),
        ("self-intersection", [BOW_TIE], 0.1),
        ("crossing", [SQUARE, SQUARE + 0.5], 0.1),
        ("crossing", [SQUARE, SQUARE / 2 + [0, 0.25]], 0.1),
        ("crossing", [SQUARE, SQUARE / 4 + 0.1, SQUARE / 4 + 0.2], 0.1),
        ("edge-length", [SQUARE], 0.0),
        ("edge-length", [SQUARE], -1.0),
        ("edge-length", [SQUARE], np.nan),
        ("edge-length", [SQUARE], None),
        ("edge-length", [SQUARE], "short"),
        ("too-many-triangles", [SQUARE], 1e-4),
        ("too-many-triangles", [SQUARE], 1e-320),
        ("out-of-range", [SQUARE * 1e-160], 1e-161),
        ("out-of-range", [SQUARE * 1e160], 1e159),
        ("out-of-range", [SQUARE + 1e15], 1.0),
        ("out-of-range", [circle(40) + 1e15], 20.0),
    ],
)
def test_bad_input(reason, loops, edge_length):
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh(loops, edge_length)
    assert error.value.reason == reason
    assert str(error.value).endswith(".") and len(str(error.value)) > 40


@pytest.mark.parametrize("loop", [SQUARE, SQUARE * [1000, 1e-3]], ids=["square", "needle"])
def test_the_remedy_for_too_many_triangles_is_one(loop):
    nested = nesting([loop])
    error = checked_domain([loop], nested, 1e-7)
    remedy = float(str(error).split("Use ")[1].split()[0])
    assert checked_domain([loop], nested, remedy) == [loop]
    assert isinstance(checked_domain([loop], nested, remedy / 1.3), tessera.ContourError)


@pytest.mark.parametrize("edge_length", [1e200, np.float64(1e308), Fraction(10), np.array(10.0)])
def test_any_number_is_an_edge_length(edge_length):
    mesh = tessera.mesh([LETTER_E], edge_length)
    check_mesh(mesh.vertices, mesh.triangles, [LETTER_E])


@pytest.mark.parametrize(
    "loop",
    [SQUARE + 1j, SQUARE[:, 0] + 1j * SQUARE[:, 1], (p for p in SQUARE), [(0, 0), (10**400, 0), (1, 1)], ["a", "b"], 5],
    ids=["complex", "complex plane", "generator", "huge", "words", "number"],
)
def test_what_is_no_array_of_points_is_a_plain_value_error(loop):
    with pytest.raises(ValueError, match="a contour is an array") as error:
        tessera.mesh([loop], 0.1)
    assert not isinstance(error.value, tessera.ContourError)


def test_contours_far_from_the_origin_are_meshed_as_long_as_coordinates_tell_their_points_apart():
    loop = SQUARE + 1e12  # rounded by 1e-4
    mesh = tessera.mesh([loop], 0.1)
    check_mesh(mesh.vertices, mesh.triangles, [loop], keep=False)
    with pytest.raises(tessera.ContourError, match=r"rounded by 0\.00012") as error:
        tessera.mesh([loop], 0.1, sizing=lambda points: np.where(points[:, 0] > 1e12 + 0.5, 1e-3, 0.1))
    assert error.value.reason == "out-of-range" and min(error.value.place) >= 1e12


def test_an_error_says_where():
    with pytest.raises(tessera.ContourError) as error:
        tessera.mesh([BOW_TIE], 0.1)
    np.testing.assert_allclose(error.value.place, (1, 1))


def test_no_such_boundary():
    with pytest.raises(ValueError, match="resample"):
        tessera.mesh([SQUARE], 0.1, boundary="both")
