"""The benchmark of domains measures what it says: its numbers again by other means, its Gmsh, its random domains."""

import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import tessera
from benchmarks.domains import cases, goals, growth, invalid, meshers, random_domains, report
from benchmarks.domains.__main__ import write
from benchmarks.domains.comparison import mesh_case, mesh_cases
from benchmarks.domains.measures import inner_edges, measure
from tests.validity import boundary_edges, check_mesh, polygon_area, polygon_is_simple

TINY = [0, 1, 2, 3, 15]  # the circle, the airfoil, the plate, a glyph and a coast


@pytest.fixture(scope="module")
def found():
    return [(cases.all_cases()[number], *mesh_case(number)) for number in TINY]


def qualities(vertices, triangles):
    """4·area / (√3·l_rms²) from the lengths of the sides alone, by Heron."""
    a, b, c = (np.linalg.norm(vertices[triangles[:, i]] - vertices[triangles[:, i - 1]], axis=1) for i in range(3))
    half = 0.5 * (a + b + c)
    area = np.sqrt(half * (half - a) * (half - b) * (half - c))
    return 4 * area / (np.sqrt(3) * (a**2 + b**2 + c**2) / 3)


def test_all_meshes_are_valid_and_share_their_boundary(found):
    for case, meshes, _ in found:
        first = meshes[meshers.OURS]
        loops = meshers.boundary_loops(first)
        assert polygon_area(loops[0]) > 0 and all(polygon_area(loop) < 0 for loop in loops[1:])
        check_mesh(first.vertices, first.triangles, case.loops, keep="boundary" in case.options)
        for mesher in meshers.ALGORITHMS:
            check_mesh(meshes[mesher].vertices, meshes[mesher].triangles, loops, keep=True)


def test_measures_of_all_meshes_by_other_means(found):
    for case, meshes, measures in found:
        for mesher, mesh in meshes.items():
            of, quality = measures[mesher], qualities(mesh.vertices, mesh.triangles)
            assert (of.vertices, of.triangles) == (len(mesh.vertices), len(mesh.triangles))
            assert of.q_mean == pytest.approx(quality.mean(), abs=1e-6)
            assert min(of.q_worst, of.q_left_out) == pytest.approx(quality.min(), abs=1e-6)
            assert of.edges == (3 * of.triangles - len(boundary_edges(mesh.triangles))) // 2
            assert (of.q_left_out < 1) == (case.kind == "airfoil")


def test_the_element_in_the_tail_is_the_one_that_is_left_out(found):
    _, meshes, measures = found[1]
    for mesher, mesh in meshes.items():
        tail = np.flatnonzero(np.all(mesh.vertices == [1, 0], axis=1))
        (element,) = mesh.triangles[np.isin(mesh.triangles, tail).any(axis=1)]
        assert measures[mesher].q_left_out == pytest.approx(qualities(mesh.vertices, element[None])[0])
        assert measures[mesher].q_left_out < measures[mesher].q_worst


def test_edges_beside_a_length_are_counted(found):
    """By hand, one by one, where the length is the same everywhere."""
    case, meshes, measures = found[0]
    for mesher, mesh in meshes.items():
        sides = Counter(
            frozenset(pair) for triangle in mesh.triangles.tolist() for pair in itertools.combinations(triangle, 2)
        )
        ends = [tuple(side) for side, count in sides.items() if count == 2]
        ratio = np.array([np.linalg.norm(mesh.vertices[a] - mesh.vertices[b]) for a, b in ends]) / case.edge_length
        assert measures[mesher].good == np.count_nonzero((0.7 <= ratio) & (ratio <= 1.4))
        assert measures[mesher].short == np.count_nonzero(ratio < 0.7)


def test_edges_beside_a_function_are_counted():
    """A square around its middle: half its diagonals are as long as wanted on one side, and too long on the other."""
    vertices = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]], dtype=float)
    triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    mesh = meshers.Meshed(vertices, triangles, 0.0)
    of = measure(mesh, lambda points: np.where(points[:, 0] < 1, np.sqrt(2), 0.5))
    assert (of.edges, of.good, of.short, of.share) == (4, 2, 0, 50)
    assert of.q_worst == of.q_mean == pytest.approx(np.sqrt(3) / 2)
    assert len(inner_edges(triangles)) == 4


def test_a_changed_boundary_is_seen(found):
    mesh = found[2][1][meshers.OURS]
    assert meshers.same_boundary(mesh, mesh)
    on_boundary = int(boundary_edges(mesh.triangles)[0, 0])
    moved = mesh.vertices.copy()
    moved[on_boundary] += 1e-12
    assert not meshers.same_boundary(mesh, replace(mesh, vertices=moved))


def test_gmsh_follows_a_sizing_function():
    """Its edges are as long as the function asks for, at one end of a strip and at the other."""
    strip = np.array([(0.1 * x, 0) for x in range(40)] + [(4, 0), (4, 1)] + [(0.1 * x, 1) for x in range(39, -1, -1)])
    vertices, triangles = meshers.by_gmsh([strip], lambda points: 0.06 + 0.06 * points[:, 0], 5)
    edges = vertices[inner_edges(triangles)]
    length, x = np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1), edges[:, :, 0].mean(axis=1)
    assert np.median(length[x < 0.7]) < 0.13 and np.median(length[x > 3.3]) > 0.2


def test_random_domains_are_what_they_say():
    domains = [random_domains.random_domain(number) for number in range(100)]
    assert {len(domain.loops) - 1 for domain in domains} == set(range(6))
    assert max(sum(map(len, domain.loops)) for domain in domains) > 400
    for number, domain in enumerate(domains):
        assert sum(map(len, domain.loops)) <= 500
        assert all(polygon_is_simple(loop) for loop in domain.loops), f"loop of {number}"
        for one, other in itertools.combinations(domain.loops, 2):
            assert not crossing(one, other), f"loops of {number}"
    again = random_domains.random_domain(7)
    assert all(np.array_equal(*pair) for pair in zip(again.loops, domains[7].loops, strict=True))


def crossing(one, other):
    def sides(start, end, points):
        (ax, ay), (bx, by) = start.T[..., None], end.T[..., None]
        return (bx - ax) * (points[:, 1] - ay) - (by - ay) * (points[:, 0] - ax) > 0

    (a, b), (c, d) = ((loop, np.roll(loop, -1, axis=0)) for loop in (one, other))
    return bool(((sides(a, b, c) != sides(a, b, d)) & (sides(c, d, a) != sides(c, d, b)).T).any())


def test_what_goes_wrong_is_counted(monkeypatch):
    number = next(n for n in range(100) if not random_domains.random_domain(n).options)
    assert invalid._outcome(number)[0] == invalid.VALID
    sound = tessera.mesh

    def spoilt(*arguments, **options):
        mesh = sound(*arguments, **options)
        mesh.triangles[0] = mesh.triangles[0, ::-1]
        return mesh

    def refusing(*arguments, **options):
        raise tessera.ContourError("crossing", "why")

    for mesher, kind in ((spoilt, invalid.INVALID), (refusing, invalid.REFUSED), (lambda: 0, invalid.CRASHED)):
        monkeypatch.setattr(tessera, "mesh", mesher)
        assert invalid._outcome(number)[0] == kind


def circles(power):
    """As if the time grew by a power of n."""
    sizes = np.array([1_000, 10_000, 100_000, 1_000_000])
    return [growth.Circle(int(n), 1e-6 * float(n) ** power, 10**9, int(n), 1e-5 * n) for n in sizes]


def test_growth_is_told_from_n_log_n():
    for power in (1.0, 1.3):
        assert growth.exponents(circles(power)) == pytest.approx((power, 1.08), abs=0.02)
    assert [goals.growth_goals(circles(p))[-1].reached for p in (1.0, 1.3)] == [True, False]
    assert [goal.reached for goal in goals.growth_goals(circles(1.3))[:2]] == [False, True]


def test_a_circle_is_timed_in_a_process_of_its_own():
    (circle,) = growth.measure_all(1_000)
    assert 850 < circle.triangles < 1_150 and 850 < circle.their_triangles < 1_150
    assert circle.seconds > 0 and circle.their_seconds > 0 and 3e7 < circle.peak < 2e9


def test_other_processes_find_the_same(found):
    ((case, meshes, measures),) = mesh_cases(TINY[:1], 1)
    assert case.name == found[0][0].name and meshes.keys() == measures.keys() == found[0][1].keys()
    for mesher, mesh in meshes.items():
        assert np.array_equal(mesh.vertices, found[0][1][mesher].vertices)


def test_the_page_has_every_goal_and_picture(found, tmp_path):
    outcomes = invalid.count_invalid(4, 1)
    assert sum(outcomes.kinds.values()) == 4 and outcomes.triangles > 10
    around = [tessera.mesh(cases.circle(0.3).loops, 0.3).report]
    text = write(tmp_path, found, circles(1.0), outcomes, around)
    assert f"q_worst {around[0].q_worst:.3f} to {around[0].q_worst:.3f}" in text
    assert (tmp_path / "domains.md").read_text() == text + "\n"
    for goal in goals.quality_goals([(case, measures) for case, _, measures in found]):
        assert f"| {goal.what} |" in text
    for picture in report.PICTURES:
        name = report.file_of(picture)
        assert f"({name})" in text and 10_000 < (tmp_path / name).stat().st_size < 600_000
