"""The evaluation: what it measures, what it takes for valid, its groups, its seeds, and a small run of the whole."""

import numpy as np
import pytest

from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch
from training import configuration, generate, measures, running
from training.evaluate import goals, groups, meshers, parallel, report, sets
from training.evaluate.meshes import Meshes, are_valid, gather, measure

SEEDS = configuration.read()["data"]["seeds"]


@pytest.fixture(scope="module")
def sector():
    return sets.sector(26, (SEEDS["validation"], 9))


@pytest.fixture(scope="module")
def meshes(sector):
    return meshers.by_gmsh(sector)


def test_measures_are_those_of_single_meshes(sector, meshes):
    found = measure(meshes, sector.l_s)
    for row, (n, m) in enumerate(zip(sector.n_contour, meshes.n_inner, strict=True)):
        single = meshes.points[row, : n + m], meshes.triangles[meshes.owner == row]
        assert found[row, :2] == pytest.approx(measures.qualities(*single))
        assert found[row, 3] == pytest.approx(measures.deviation(*single, n, sector.l_s[row]))


def test_smallest_angle_and_deviation_of_a_cut_square():
    square = sets.Contours(np.zeros((2, 16, 2)), np.array([4, 4]), np.array([1.0, 1.0]))
    square.points[:, :4] = [(0, 0), (1, 0), (1, 1), (0, 1)]
    found = measure(gather(square, [(square.points[0, :4], np.array([[0, 1, 2], [0, 2, 3]])), None]), square.l_s)
    np.testing.assert_allclose(found[0, 2:], (45, np.sqrt(2) - 1))
    assert np.isnan(found[1]).all()


@pytest.mark.parametrize("mesher", [meshers.by_gmsh, meshers.by_teacher])
def test_meshes_of_gmsh_and_the_teacher_are_valid(mesher, sector):
    assert are_valid(mesher(sector), sector).all()


def test_meshes_of_the_scheme_are_valid(sector):
    scheme = mesh_contours(sector.points, sector.n_contour, sector.l_s, Stopwatch())
    assert are_valid(meshers.of_scheme(sector, scheme), sector).all()


def dropped(meshes, first):
    kept = np.arange(len(meshes.owner)) != first
    return meshes.points, meshes.n_inner, meshes.triangles[kept], meshes.owner[kept]


def inverted(meshes, first):
    triangles = meshes.triangles.copy()
    triangles[first] = triangles[first][::-1]
    return meshes.points, meshes.n_inner, triangles, meshes.owner


def doubled(meshes, first):
    triangles = meshes.triangles.copy()
    triangles[first] = triangles[first + 1]
    return meshes.points, meshes.n_inner, triangles, meshes.owner


def moved(meshes, first):
    points = meshes.points.copy()
    points[meshes.owner[first], meshes.n_contour[meshes.owner[first]]] += 3
    return points, meshes.n_inner, meshes.triangles, meshes.owner


def changed_contour(meshes, first):
    points = meshes.points.copy()
    points[meshes.owner[first], 0] *= 1 + 1e-6
    return points, meshes.n_inner, meshes.triangles, meshes.owner


def unused(meshes, first):
    n_inner = meshes.n_inner.copy()
    n_inner[meshes.owner[first]] -= 1
    return meshes.points, n_inner, meshes.triangles, meshes.owner


def out_of_range(meshes, first):
    triangles = meshes.triangles.copy()
    triangles[first, 0] = meshes.points.shape[1] - 1
    return meshes.points, meshes.n_inner, triangles, meshes.owner


@pytest.mark.parametrize(
    "spoil",
    [dropped, inverted, doubled, moved, changed_contour, unused, out_of_range],
    ids=lambda spoil: spoil.__name__,
)
def test_a_spoilt_mesh_is_not_valid(spoil, sector, meshes):
    """And all others still are."""
    row = int(np.flatnonzero((meshes.n_inner > 2) & (meshes.n_inner < meshes.n_inner.max() - 1))[0])
    points, n_inner, triangles, owner = spoil(meshes, int(np.flatnonzero(meshes.owner == row)[0]))
    valid = are_valid(Meshes(points, meshes.n_contour, n_inner, triangles, owner), sector)
    np.testing.assert_array_equal(valid, np.arange(len(valid)) != row)


def test_groups_are_means_of_their_members():
    row, column = np.array([4, 4, 4, 5, 5.0]), np.array([1, 1, 1, 1, np.nan])
    found = groups.group(row, column, np.array([1, 2, 6, 7, 100.0]))
    np.testing.assert_array_equal(found.count, [[3], [1]])
    np.testing.assert_allclose(found.mean, [[3], [7]])
    np.testing.assert_allclose(found.spread[0, 0], np.std([1, 2, 6], ddof=1) / np.sqrt(3))
    assert found.worst(1)[:3] == (5, 1, 7) and found.worst(2)[:3] == (4, 1, 3) and found.worst(4) is None
    assert found.cell(4, 1) == (3, 3) and found.cell(9, 9)[0] == 0


def test_a_goal_that_is_missed_says_so():
    assert goals.Goal("what", "—", 1, 1.5).cells()[-1] == "**no**"
    assert goals.Goal("what", "—", 1, 0.5).cells()[-1] == "yes"


def shapes(points, n_contour):
    """What tells contours apart, however they were transformed: their edges' lengths beside the longest, in order."""
    for row, n in zip(points, n_contour, strict=True):
        lengths = np.linalg.norm(np.roll(row[:n], -1, axis=0) - row[:n], axis=1)
        yield tuple(np.round(np.roll(lengths, -int(lengths.argmax())) / lengths.max(), 5))


def drawn(name, seed, count):
    """The shapes of a shard's first contours."""
    stream = generate.drawn(np.random.default_rng(seed), name, count)
    return {next(shapes([points], [len(points)])) for _, (points, _, _) in zip(range(count), stream, strict=False)}


@pytest.mark.parametrize("name", generate.SETS)
def test_contours_of_the_test_are_none_of_training(name):
    """Same generators, other seeds: not one contour of the test is in the first shards of training or validation."""
    assert len(set(SEEDS.values())) == len(SEEDS)
    if name == "sector":
        tested = [sets.held_out(400, (SEEDS["test"], number))[:2] for number in range(2)]
    else:
        tested = [running.refinement_contours(SEEDS["test"], 200)[:2], running.real_contours(200)[:2]]
    tested = set().union(*(shapes(*contours) for contours in tested))
    for split in ("train", "validation"):
        for number in range(2):
            shard = drawn(name, (SEEDS[split], generate.SETS.index(name), number), 200)
            assert len(shard) > 150 and not tested & shard


def test_contours_of_one_seed_would_be_found():
    """By the comparison above: another draw of a stream, or the same contours transformed, are the same shapes."""
    seed = (SEEDS["validation"], 1, 0)
    assert drawn("running", seed, 50) == drawn("running", seed, 50)
    points, n_contour, _ = sets.held_out(50, seed)
    turned = points @ np.array([[0.6, -0.8], [0.8, 0.6]]) * 3
    assert set(shapes(points, n_contour)) == set(shapes(turned, n_contour))


def test_a_small_run_of_the_whole(tmp_path):
    test = {"contours": 26, "close": 13, "others": 13, "chunk": 13, "smooth": 2}
    found = parallel.find_all(test, SEEDS["validation"], processes=1)
    assert [len(results) for results in found.values()] == [26, 13, 13]
    first = next(iter(found.values()))
    assert first.is_close.sum() == 13 and first.is_comparable.sum() <= 13
    assert first.valid["Tessera"].all() and np.isfinite(first.measures["Tessera"]).all()
    lines = goals.goals(found, parallel.time_tables(SEEDS["validation"], count=5))
    text = report.write(tmp_path, found, lines, test, SEEDS["validation"])
    assert (tmp_path / "scheme.md").read_text() == text + "\n"
    for line in lines:
        assert f"| {line.what} |" in text
    for name in ("scheme", "nn1", "nn2", "nn3", "nn3_cdt", "nn3_gmsh", "tables", "distributions"):
        assert (tmp_path / f"{name}.png").stat().st_size > 5000 and f"({name}.png)" in text
