"""Levels: boundaries that hold each other, meshes that are valid and even, and work that can be watched and stopped."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tessera
from tessera import levels
from tessera.arcs import resample_graph
from tessera.coarsening import coarsen
from tessera.constraints import Domain, PlanarDomain, planar_domain
from tessera.contour import clean_domains, nesting
from tessera.crossings import crossing_pairs
from tessera.gradation import Target
from tessera.graph import graph_faces
from tessera.levels import mesh_by_levels
from tessera.outlines import outlines_of
from tessera.quality import element_quality
from tessera.refinement import Refined
from tessera.steps import finish
from tessera.stopwatch import Stopwatch
from tests.library.polygons import circle, seeds
from tests.library.test_bridges import random_domain
from tests.library.test_constraints import random_constraints
from tests.validity import check_mesh

CORNER = np.radians(32)


def target(edge_length: float) -> Target:
    return Target({}, None, np.array([edge_length]), np.array([0.0]))


def spaced(n: int, radius: float = 1.0) -> np.ndarray:
    return radius * circle(n)


def coarsened(loops, edge_length, most=3):
    (loops,) = clean_domains([loops])
    outlines = outlines_of([loops], [nesting(loops)], {}, [0])
    return coarsen(outlines, target(edge_length), CORNER, np.array([most]))


def test_a_round_domain_starts_with_a_quarter_of_its_boundary_twice():
    found = coarsened([spaced(128)], 2 * np.pi / 128)
    assert found.levels[0] == 3
    assert [len(found.at_level(level).loops[0]) for level in range(4)] == [128, 64, 32, 16]


def test_a_thin_domain_has_no_levels():
    x = np.arange(0, 60) / 4
    loop = np.concatenate([np.column_stack([x, 0 * x]), np.column_stack([x[::-1], 0 * x + 0.5])])
    assert coarsened([loop], 0.25).levels[0] == 0


def test_corners_stay():
    side = np.arange(40) / 40
    square = np.concatenate([np.column_stack(s) for s in ((side, 0 * side), (0 * side + 1, side))])
    square = np.concatenate([square, 1 - square])
    found = coarsened([square], 1 / 40)
    assert found.levels[0] >= 2
    for level in range(found.levels[0] + 1):
        assert {(0, 0), (1, 0), (1, 1), (0, 1)} <= set(map(tuple, found.at_level(level).loops[0].tolist()))


@given(seeds)
@settings(max_examples=15, deadline=None)
def test_boundaries_of_all_levels_are_simple_and_hold_the_coarser_ones(seed):
    loops = [tessera.boundary.resample(loop, 0.04) for loop in clean_domains([random_domain(seed)])[0]]
    found = coarsened(loops, 0.04)
    for level in range(int(found.levels[0]) + 1):
        start = np.concatenate(found.at_level(level).loops)
        ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in found.at_level(level).loops])
        assert not len(crossing_pairs(start, ends, np.zeros(len(start), dtype=np.int64)))
        assert all(len(loop) >= 3 for loop in found.at_level(level).loops)
        finer = {tuple(p) for p in np.concatenate(found.at_level(max(level - 1, 0)).loops).tolist()}
        assert {tuple(p) for p in start.tolist()} <= finer


@given(seeds, st.sampled_from([0.04, 0.1]))
@settings(max_examples=15, deadline=None)
def test_coarser_graphs_have_edges_that_do_not_meet_and_the_same_faces(seed, edge_length):
    loops = random_domain(seed)
    points, lines = random_constraints(seed, loops)
    graph = resample_graph(planar_domain(Domain(loops, None, points, lines)).graph, edge_length, CORNER)
    outlines = outlines_of([None], [None], {0: PlanarDomain([], graph, ())}, [0])
    found = coarsen(outlines, target(edge_length), CORNER, np.array([3]))
    n_faces = graph_faces(graph.points, graph.edges).count
    for level in range(int(found.levels[0]) + 1):
        coarser = found.at_level(level).graphs[0]
        start, end = coarser.points[coarser.edges.T]
        assert not len(crossing_pairs(start, end, np.zeros(len(start), dtype=np.int64)))
        assert graph_faces(coarser.points, coarser.edges).count == n_faces
        finer = {tuple(p) for p in found.at_level(max(level - 1, 0)).graphs[0].points.tolist()}
        assert (
            {tuple(p) for p in graph.points[graph.kept].tolist()}
            <= {tuple(p) for p in coarser.points.tolist()}
            <= finer
        )


def test_two_regions_are_as_good_as_one():
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    mesh = tessera.mesh_regions([[square], [square + [1, 0]]], 0.05)
    assert mesh.report.q_mean > 0.98
    border = np.sort(mesh.vertices[np.abs(mesh.vertices[:, 0] - 1) < 1e-12, 1])
    assert np.diff(border).max() < 1.2 * 0.05


@given(seeds, st.integers(0, 3))
@settings(max_examples=12, deadline=None)
def test_any_number_of_levels_gives_a_valid_mesh_of_the_same_boundary(seed, most):
    cleaned = clean_domains([random_domain(seed)])
    loops = [tessera.boundary.resample(loop, 0.09) for loop in cleaned[0]]
    if len(crossing_pairs(*tessera.contour.edges_of(loops), np.zeros(sum(map(len, loops)), dtype=np.int64))):
        return  # resampled by themselves, loops may meet
    outlines = outlines_of([loops], [nesting(loops)], {}, [0])
    meshes = finish(mesh_by_levels(outlines, target(0.09), CORNER, 3, Stopwatch(), np.array([most])))
    used, local = np.unique(meshes.triangles, return_inverse=True)
    check_mesh(meshes.vertices[used], local.reshape(-1, 3), loops)


def test_a_circle_is_better_than_the_paper_s():
    """q_worst 0.88 and q_mean 0.97 with about 400 nodes (section 4)."""
    mesh = tessera.mesh([spaced(400)], 0.101)
    assert 350 < mesh.report.n_vertices < 450
    assert mesh.report.q_worst >= 0.85 and mesh.report.q_mean >= 0.98
    edges = tessera.edges.unique_edges(mesh.triangles)
    lengths = np.linalg.norm(np.diff(mesh.vertices[edges], axis=1)[:, 0], axis=1) / 0.101
    assert np.mean((lengths > 0.7) & (lengths < 1.4)) > 0.95


def test_steps_come_to_what_mesh_makes():
    loops = [spaced(60), 0.4 * spaced(30)]
    steps, seen = tessera.mesh_in_steps(loops, 0.15, smooth=2), []
    while True:
        try:
            seen.append(next(steps))
        except StopIteration as stop:
            mesh = stop.value
            break
    shares = [progress.share for progress in seen]
    assert shares == sorted(shares) and 0 < shares[0] < 0.1 and 0.9 < shares[-1] <= 1
    assert {"contours", "networks", "relaxation", "smoothing"} <= {progress.stage for progress in seen}
    whole = tessera.mesh(loops, 0.15, smooth=2)
    np.testing.assert_array_equal(mesh.vertices, whole.vertices)
    np.testing.assert_array_equal(mesh.triangles, whole.triangles)


def test_steps_can_be_stopped_and_raise_what_mesh_raises():
    steps = tessera.mesh_in_steps([spaced(60)], 0.1)
    next(steps)
    steps.close()
    with pytest.raises(StopIteration):
        next(steps)
    with pytest.raises(tessera.ContourError) as error:
        finish(tessera.mesh_in_steps([[(0, 0), (1, 1), (1, 0), (0, 1)]], 0.1))
    assert error.value.reason == "self-intersection"


def test_without_passes_nothing_is_improved(monkeypatch):
    asked = []
    monkeypatch.setattr(levels, "improve", lambda *arguments: asked.append(arguments))
    draft = tessera.mesh([spaced(60)], 0.05, passes=0)
    assert not asked and "relaxation" not in draft.report.seconds
    check_mesh(draft.vertices, draft.triangles, [spaced(60)], keep=False)


def test_more_passes_are_asked_for_by_number():
    few, many = (tessera.mesh([spaced(60)], 0.2, passes=passes) for passes in (0, 4))
    assert element_quality(many.vertices, many.triangles).mean() > element_quality(few.vertices, few.triangles).mean()
    with pytest.raises(ValueError, match="passes"):
        tessera.mesh([spaced(60)], 0.2, passes=-1)


def crowded(n: int, more: int) -> np.ndarray:
    """A circle of n vertices, with so many more between two of them."""
    turn = 2 * np.pi * np.arange(n) / n
    turn = np.sort(np.concatenate([turn, np.linspace(turn[5], turn[6], more + 2)[1:-1]]))
    return np.column_stack([np.cos(turn), np.sin(turn)])


@pytest.mark.parametrize("more", [3, 12, 30])
def test_given_vertices_may_be_crowded(more):
    loop = crowded(64, more)
    mesh = tessera.mesh([loop], 2 * np.pi / 64, boundary="keep")
    check_mesh(mesh.vertices, mesh.triangles, [loop])


def test_a_level_that_does_not_fit_is_left_out():
    """Alone, and beside domains that fit."""
    domain = random_domain(70117)
    cleaned = clean_domains([domain])[0]
    others = [[spaced(50)], [spaced(70)]]
    alone, *_ = tessera.mesh_many([domain], 0.1)
    beside = tessera.mesh_many([others[0], domain, others[1]], 0.1)[1]
    np.testing.assert_array_equal(alone.vertices, beside.vertices)
    np.testing.assert_array_equal(alone.triangles, beside.triangles)
    assert len(cleaned) and alone.report.q_mean > 0.9


def test_a_domain_of_one_target_is_the_same_beside_one_of_several():
    sizing = tessera.by_thickness(4)
    alone = tessera.mesh([spaced(12)], 0.3, sizing=sizing)
    beside = tessera.mesh_many([[spaced(12)], [0.01 * spaced(9)]], 0.3, sizing=sizing)[0]
    np.testing.assert_array_equal(alone.vertices, beside.vertices)
    np.testing.assert_array_equal(alone.triangles, beside.triangles)


def test_progress_goes_on_over_levels():
    shares, steps = [], tessera.mesh_in_steps([spaced(300)], 0.05)
    for progress in steps:
        shares.append(progress.share)
    assert shares == sorted(shares) and shares[-1] == pytest.approx(1)


@pytest.mark.parametrize("times", [1, 2])
def test_where_every_domain_fails_a_level_all_start_again_with_one_less(monkeypatch, times):
    """As if none of a group fitted: it then has nothing left to mesh at the finer levels."""
    loops, failures = [spaced(128), spaced(120)], []
    refine = tessera.levels.refine

    def unfit(vertices, triangles, domain, sizing, watch, arcs=None, fixed=None, roles=None):
        refined = yield from refine(vertices, triangles, domain, sizing, watch, arcs, fixed)
        if arcs is None or len(failures) == times:
            return refined
        failures.append(np.unique(domain))
        n, parent = len(triangles), np.arange(len(triangles))
        return Refined(vertices, triangles, parent, np.zeros(n, dtype=np.int64), arcs.number, failures[-1], fixed)

    h = 2 * np.pi / 128
    cleaned = clean_domains([[loop] for loop in loops])
    outlines = outlines_of(cleaned, [nesting(loop) for loop in cleaned], {}, [0, 1])
    both = Target({}, None, np.array([h, h]), np.zeros(2))
    expected = finish(mesh_by_levels(outlines, both, CORNER, 3, Stopwatch(), np.array([3 - times, 3 - times])))
    monkeypatch.setattr(tessera.levels, "refine", unfit)
    found = finish(mesh_by_levels(outlines, both, CORNER, 3, Stopwatch()))
    assert [len(domains) for domains in failures] == [2] * times
    for number, loop in enumerate(loops):
        parts = [meshes.triangles[meshes.region == number] for meshes in (found, expected)]
        used, local = np.unique(parts[0], return_inverse=True)
        check_mesh(found.vertices[used], local.reshape(-1, 3), [loop])
        np.testing.assert_array_equal(found.vertices[parts[0]], expected.vertices[parts[1]])
