"""Data, tables and networks of the training: what each stage promises."""

import json

import numpy as np
import pytest
import torch

from tessera.cavity import even_lengths, is_inside
from tessera.scheme import join_vertices
from tests.validity import check_many, check_mesh
from training import configuration, contours, generate, measures, meshing, reference, running, tables, teacher
from training.compact import pack, unpack
from training.data import Examples, elements_of, is_clear, levels, reflect
from training.export import INPUTS, sample
from training.geometry import lower, outline
from training.layers import Boundary
from training.networks import ROLES

CONFIG = configuration.read()["data"]


@pytest.fixture(scope="module")
def shard():
    parts = [generate.make_shard((99, number, 0), name, 40, 32) for number, name in enumerate(generate.SETS)]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def examples(shard):
    arrays = {name: shard[name] for name in ("contour", "inner", "n_contour", "n_inner", "l_s", "kind")}
    arrays = {name: array.astype(np.float64 if array.dtype.kind == "f" else np.int64) for name, array in arrays.items()}
    nothing = np.zeros(len(shard["l_s"]), dtype=np.int64)
    return Examples(**arrays, placed=np.zeros((len(nothing), 1, 2)), n_placed=nothing)


def test_sector_contours_are_transformed_and_counter_clockwise():
    rng = np.random.default_rng(1)
    sizes = set()
    for _ in range(100):
        points, l_s = contours.draw_sector(rng)
        sizes.add(len(points))
        assert 3 <= len(points) <= 16 and l_s > 0 and meshing.area2(points, 0, 1, 2) < 10
        x, y = points.T
        assert np.dot(x, np.roll(y, -1)) > np.dot(y, np.roll(x, -1))
        np.testing.assert_allclose(points.mean(axis=0), 0, atol=1e-12)
    assert len(sizes) >= 6


def test_shards_are_reproducible(shard):
    again = generate.make_shard((99, 0, 0), "sector", 40, 32)
    for name, array in shard.items():
        np.testing.assert_array_equal(array[:40], again[name])


def test_running_shards_are_reproducible_and_hold_every_kind(shard):
    again = generate.make_shard((99, 1, 0), "running", 40, 32)
    for name, array in shard.items():
        np.testing.assert_array_equal(array[40:], again[name])
    assert set(again["kind"]) == set(range(1, len(contours.KINDS)))
    assert (again["n_inner"][again["kind"] == contours.KINDS.index("star")] == 1).all()


def test_the_compact_form_keeps_the_examples(shard, tmp_path):
    (tmp_path / "train").mkdir()
    np.savez(tmp_path / "train" / "sector-00000.npz", **shard)
    pack(tmp_path / "train", tmp_path / "train.npz")
    again = unpack(tmp_path / "train.npz")
    for name, array in shard.items():
        kept = again[name]
        if name in ("contour", "inner"):
            assert not array[:, kept.shape[1] :].any()
            array = array[:, : kept.shape[1]]
        np.testing.assert_allclose(kept, array, rtol=1e-3, atol=1e-6)
    assert (tmp_path / "train.npz").stat().st_size < 100 * len(shard["l_s"]) + 5000


def test_the_manifest_says_what_was_made(shard, tmp_path):
    for number in range(2):
        np.savez(tmp_path / f"sector-{number:05d}.npz", **shard)
    generate.write_manifest(tmp_path, "train", CONFIG)
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    assert manifest["examples"] == 2 * len(shard["l_s"]) == sum(manifest["kinds"].values())
    assert manifest["reference"]["gmsh"] == reference.VERSION and manifest["seed"] == CONFIG["seeds"]["train"]
    first, second = (entry["sha256"] for entry in manifest["shards"].values())
    assert first == second and len(first) == 64


def test_a_killed_run_leaves_no_half_shard(tmp_path, monkeypatch):
    config = CONFIG | {"shard": 3}

    def killed(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(generate.np, "savez", killed)
        with pytest.raises(KeyboardInterrupt):
            generate.work((tmp_path / "sector-00000.npz", (1, 0, 0), "sector", config))
    assert not list(tmp_path.glob("*.npz"))
    generate.work((tmp_path / "sector-00000.npz", (1, 0, 0), "sector", config))
    assert len(np.load(tmp_path / "sector-00000.npz")["l_s"]) == 3


def test_the_teacher_is_better_than_the_reference(shard):
    """In quality and in keeping to the target size, on average."""
    sector = shard["kind"] == 0
    assert shard["teacher"][sector, 0].mean() > shard["reference"][sector, 0].mean() + 0.05
    assert shard["teacher"][sector, 1].mean() > shard["reference"][sector, 1].mean()
    away = []
    for row in np.flatnonzero(sector):
        points = shard["contour"][row, : shard["n_contour"][row]].astype(float)
        lesson = teacher.teach(points, shard["l_s"][row])
        assert (lesson.taught.vertices[: len(points)] == points).all()
        check_mesh(lesson.taught.vertices, lesson.taught.triangles, [points])
        meshes = lesson.reference, lesson.taught
        away.append([measures.deviation(m.vertices, m.triangles, len(points), shard["l_s"][row]) for m in meshes])
    assert np.mean(away, axis=0)[1] <= np.mean(away, axis=0)[0]


def test_delaunay_is_valid_and_delaunay(shard):
    data = examples(shard)
    out, ok = np.empty((len(data), 80, 3), np.int64), np.zeros(len(data), bool)
    elements_of(data.contour, data.inner, data.n_contour, data.n_inner, out, ok)
    assert ok.all()
    for row in range(len(data)):
        n, m = data.n_contour[row], data.n_inner[row]
        points = np.concatenate([data.contour[row, :n], data.inner[row, :m]])
        triangles = out[row][out[row, :, 0] >= 0]
        triangles = np.where(triangles >= 16, triangles - 16 + n, triangles)
        check_many(points[None], np.array([n]), np.array([m]), triangles, np.zeros(len(triangles), int))
        opposite = np.full((n + m, n + m), -1)
        for a, b, c in triangles:
            meshing.add(opposite, a, b, c)
        for u, v in np.argwhere(opposite >= 0):
            w, x = opposite[u, v], opposite[v, u]
            assert x < 0 or meshing.in_circle(points, u, v, w, x) <= 1e-9


def test_reference_keeps_the_contour():
    reference.start()
    points = contours.transformed_sector(np.random.default_rng(2), 9)
    vertices, triangles = reference.mesh(points, 0.4)
    np.testing.assert_allclose(vertices[:9], points, atol=1e-12)
    check_many(vertices[None], np.array([9]), np.array([len(vertices) - 9]), triangles, np.zeros(len(triangles), int))


def test_table_of_a_square():
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    (table,) = tables.connection_tables(points[None], np.array([4]), np.array([1]))
    quality = 4 * 0.25 / (np.sqrt(3) * (1 + 0.5 + 0.5) / 3)
    for facet in range(4):
        assert table[facet, 4] == pytest.approx((quality, quality))
        # A corner is not possible: the middle lies on the diagonal.
        np.testing.assert_array_equal(table[facet, :4], 0)


def test_tables_hold_what_forcing_an_element_gives():
    """Against brute force: every triangulation of a few points that holds the element and is Delaunay elsewhere."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        points = np.concatenate([contours.transformed_sector(rng, 6), rng.uniform(-0.15, 0.15, (2, 2))])
        if not all(is_clear(points, 6, 8, v, 0.05) for v in (6, 7)):
            continue
        (table,) = tables.connection_tables(points[None], np.array([6]), np.array([2]))
        best = table[..., 0].max()
        opposite = np.empty((8, 8), np.int64)
        assert meshing.delaunay(points, 6, 8, opposite)
        worst, mean = meshing.qualities(points, opposite, 8)
        for facet in range(6):
            own = opposite[facet, (facet + 1) % 6]
            assert table[facet, own] == pytest.approx((worst, mean))
            for v in np.flatnonzero(table[facet, :, 0]):
                assert table[facet, v, 0] <= meshing.quality(points, facet, (facet + 1) % 6, v) + 1e-12
        assert best >= worst


def test_sub_contours_are_simple_and_keep_all_vertices_inside(shard):
    data = examples(shard)
    points = join_vertices(data.contour, data.n_contour, data.inner, data.n_inner)
    found = list(levels(points, data.n_contour, data.n_inner))
    assert len(found) > len(data)
    assert {level for _, _, level in found} >= {0, 1}
    for vertices, count, _ in found:
        assert is_inside(vertices[None, count:], vertices[None, :count], np.array([count])).all()
        opposite = np.empty((len(vertices), len(vertices)), np.int64)
        assert meshing.delaunay(vertices, count, len(vertices), opposite)


def test_reflection_keeps_contours_counter_clockwise(shard):
    data = examples(shard)
    mirrored = reflect(data, np.ones(len(data), bool))
    lengths = [even_lengths(d.contour, d.n_contour, d.n_inner) for d in (data, mirrored)]
    np.testing.assert_allclose(*lengths)
    np.testing.assert_allclose(mirrored.contour[:, 0], data.contour[:, 0] * [1, -1])


def test_the_order_of_inner_vertices_does_not_matter():
    torch.manual_seed(0)
    net, inputs = ROLES["nn2_moves"](), sample(np.random.default_rng(5), 6, 12, 7)
    inputs["n_inner"][:] = 7
    order = torch.tensor([3, 1, 6, 0, 2, 5, 4])
    given = {name: inputs[name] for name in INPUTS["nn2_moves"]}
    with torch.no_grad():
        here = net(**given)
        there = net(**(given | {"inner": inputs["inner"][:, order]}))
    torch.testing.assert_close(here[:, order], there, atol=1e-5, rtol=1e-4)


@pytest.mark.parametrize("role", ["nn1", "nn2_scores", "nn2_moves"])
def test_padding_does_not_matter(role):
    torch.manual_seed(0)
    net, inputs = ROLES[role](), sample(np.random.default_rng(6), 6, 12, 7)
    padded = dict(inputs)
    padded["contour"] = torch.nn.functional.pad(inputs["contour"], (0, 4), value=3.0)
    padded["inner"] = torch.nn.functional.pad(inputs["inner"], (0, 0, 0, 5), value=-2.0)
    with torch.no_grad():
        here, there = (net(**{name: d[name] for name in INPUTS[role]}) for d in (inputs, padded))
    if role == "nn2_moves":
        real = torch.arange(7) < inputs["n_inner"][:, None]
        here, there = here[real], there[:, :7][real]
    torch.testing.assert_close(here, there, atol=1e-4, rtol=1e-4)


def test_the_boundary_is_known_by_the_ways_to_it():
    """What a point hears of the contour is the same wherever both are."""
    torch.manual_seed(0)
    layer, inputs = Boundary(8), sample(np.random.default_rng(7), 4, 9, 1)
    point, heard = torch.tensor([0.3, -0.2]), []
    for shift in (torch.zeros(2), torch.tensor([1.5, -0.7])):
        shape = outline(inputs["contour"] + shift.reshape(1, 2, 1), inputs["n_contour"], torch.full((4,), 0.5))
        x, y = ((point + shift) / 0.5).reshape(2, 1, 1).expand(2, 4, 1)
        heard.append(layer(lower(x, y), shape))
    torch.testing.assert_close(*heard, atol=1e-4, rtol=1e-4)


def test_the_teacher_s_mesh_is_valid_and_lacks_no_more_than_the_reference_s():
    """On contours on which it once was inverted, and others."""
    reference.start()
    points, n_contour, l_s = running.real_contours(1500)
    for row in [941, 973, 1419, 1452, 1453, *range(30)]:
        n = n_contour[row]
        lesson = teacher.teach(points[row, :n], l_s[row])
        values = []
        for mesh in (lesson.reference, lesson.taught):
            assert measures.qualities(mesh.vertices, mesh.triangles)[0] > 0
            matrix = teacher._matrix(mesh)
            values.append(teacher.cost(mesh.vertices, matrix, n, len(mesh.vertices), l_s[row]))
        assert values[1] <= values[0]


def test_shards_of_another_configuration_are_refused(shard, tmp_path):
    np.savez(tmp_path / "sector-00000.npz", **shard)
    with pytest.raises(SystemExit, match="another configuration"):
        generate.check_folder(tmp_path, CONFIG, "train")
    generate.check_folder(tmp_path, CONFIG | {"shard": len(shard["l_s"])}, "train")
    (tmp_path / "sector-00000.npz").rename(tmp_path / "sector-00777.npz")
    with pytest.raises(SystemExit, match="another configuration"):
        generate.check_folder(tmp_path, CONFIG | {"shard": len(shard["l_s"])}, "train")
