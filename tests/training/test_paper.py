"""The paper's networks: their shapes and inputs, what they learn from, and the whole report on tiny populations."""

import tomllib

import numpy as np
import pytest
import torch

import tessera
from tessera import paper, paper_placement
from tessera.cavity import is_inside
from tessera.roles import SHIPPED
from tests.validity import check_mesh
from training import configuration, contours
from training.paper import (
    batches,
    claims,
    data,
    fitting,
    generate,
    markdown,
    networks,
    settings,
    train,
)
from training.paper.__main__ import everything

ANSWERS = {"reproduced", "better", "worse", "not tested"}
TINY = """
[folders]
data = "{folder}/data"
runs = "{folder}/runs"
results = "{folder}/results"
models = "{folder}/models"
docs = "{folder}/docs"
[data]
seeds = {{ test = 901, train = 902 }}
shard = 60
targets = [0.4, 0.6, 1.0]
train = {{ 6 = 60, 10 = 60 }}
test = {{ 6 = 20, 10 = 20 }}
[test]
contours = 8
[nn1]
steps = 40
seed = 1
[nn2]
steps = 40
seed = 2
meshes = 20
groups = {{ 6 = [1, 2, 3, 4], 10 = [1, 2, 4] }}
[nn3]
steps = 20
longer = {{ 10_4 = 30 }}
seed = 3
meshes = 4
references = 10
share = 0.5
groups = {{ 6 = [1, 2, 3, 4], 10 = [2, 4] }}
[nn3_star]
steps = 10
seed = 4
n_contour = 10
groups = [1, 2, 4]
contours = 2
levels = [50, 96]
random = {{ 1 = [5, 20], 2 = [5, 20], 4 = [5, 20] }}
adaptive = {{ 1 = [5, 20], 2 = [5, 20], 4 = [5, 20] }}
[resolution]
grids = [10, 20, 40]
fewest = 1
steps = 10
seed = 5
contours = 5
[mixture]
n_contour = 6
n_inner = 4
steps = 10
seed = 8
[learning]
shares = [0.5, 1.0]
seed = 6
nn1 = {{ n_contour = 10, steps = 10 }}
nn2 = {{ n_contour = 10, n_inner = 4, steps = 10 }}
nn3 = {{ n_contour = 6, n_inner = 4, steps = 10 }}
nn3_star = {{ n_inner = 2, steps = 10 }}
"""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paper")
    (folder / "config.toml").write_text(TINY.format(folder=folder))
    threads = torch.get_num_threads()
    config = settings.read(folder / "config.toml")
    everything(config)
    torch.set_num_threads(threads)
    return config


def test_the_whole_report_is_made_of_tiny_populations(tiny):
    folder = tiny["folders"]["docs"]
    text = (folder / "reproduction.md").read_text()
    headings = "\n".join(line for line in text.splitlines() if line.startswith(("## ", "!")))
    for figure in ("Figs. 17 and 18", "Fig. 19", "Fig. 21", "Fig. 22", "Fig. 24", "Fig. 25", "16 and 26", "Fig. 27"):
        assert figure in headings, figure
    assert "sub-contours by CDT: ē_worst" in text and "examples of the reference's vertices" in text
    pictures = {line.split("(")[1].rstrip(")") for line in text.splitlines() if line.startswith("![")}
    assert pictures and all((folder / picture).stat().st_size > 1000 for picture in pictures)
    answers = [line.split("**")[1] for line in text.splitlines() if line.count("**") == 2]
    assert len(answers) > 25 and set(answers) <= ANSWERS
    assert "not tested" in answers and len(set(answers)) > 1


def test_a_second_run_makes_nothing_again(tiny):
    file = tiny["folders"]["runs"] / "nn2_6.pt"
    shard = next(tiny["folders"]["data"].glob("train-06-*.npz"))
    before = file.stat().st_mtime_ns, shard.stat().st_mtime_ns
    generate.make_all(tiny)
    train.train_all(tiny)
    assert (file.stat().st_mtime_ns, shard.stat().st_mtime_ns) == before


def test_a_run_does_not_go_on_with_another_population(tiny):
    more = tiny | {"nn3": tiny["nn3"] | {"steps": 25, "references": 5}}
    with pytest.raises(ValueError, match=r"nn3_6_1\.pt was begun with another population"):
        train.train_nn3(more, data.load(more, "train", 6), 1)


def test_exported_networks_mesh_and_name_their_groups(tiny):
    roles = paper.load("paper", tiny["folders"]["models"])
    groups = paper.groups("paper", tiny["folders"]["models"])
    assert groups == {6: [0, 1, 2, 3, 4], 10: [2, 4]}
    contour, n = np.zeros((1, 16, 2)), np.array([10])
    contour[0, :10] = contours.transformed_sector(np.random.default_rng(3), 10)
    inner, count = roles.place(contour, n, np.array([4]), np.array([0.6]), tessera.scheme.Stopwatch())
    assert count[0] == 4 and is_inside(inner, contour, n).all()
    with pytest.raises(
        tessera.ContourError,
        match=r"NN2 and NN3 were .* 10 edges with the 3 inner .* 6 edges with 0 to 4 .*; 10 with 2 and 4",
    ) as caught:
        roles.place(contour, n, np.array([3]), np.array([0.6]), tessera.scheme.Stopwatch())
    assert caught.value.reason == "untrained-group" and "a longer edge length" in caught.value.args[0]


@pytest.mark.parametrize("name", ["paper", "paper*"])
def test_paper_networks_of_the_repository_mesh_by_the_same_call(name):
    rng, meshed = np.random.default_rng(77), 0
    trained = paper.groups(name)
    assert set(trained) == {10} if name == "paper*" else set(trained) >= {4, 6, 8, 10}
    for n in trained:
        for length in (0.5, 0.6, 0.7, 0.8, 0.9):
            points = contours.transformed_sector(rng, n)
            try:
                mesh = tessera.mesh_contour(points, length, networks=name)
            except tessera.ContourError as error:
                assert error.reason == "untrained-group"
                continue
            check_mesh(mesh.vertices, mesh.triangles, [points])
            np.testing.assert_array_equal(mesh.vertices[:n], points)
            meshed += 1
    assert meshed >= 2
    with pytest.raises(ValueError, match="networks"):
        tessera.mesh_contour(points, 0.5, networks="papers")


def test_contours_of_no_group_and_a_missing_folder_are_told():
    with pytest.raises(tessera.ContourError, match="5 edges"):
        tessera.mesh_contour([(0, 0), (1, 0), (1, 1), (0.5, 1.4), (0, 1)], 0.5, networks="paper")
    with pytest.raises(tessera.ContourError, match="Train and export"):
        paper.load("paper", settings.FILE.parent)


@pytest.mark.parametrize("n", [4, 6, 10, 16])
def test_networks_have_the_papers_layers(n):
    one, two, three = networks.nn1(n), networks.nn2(n), networks.nn3(n, 3)
    assert [layer.weight.shape[1:] for layer in one.layers[::3]] == [(2 * n + 1, 4 * n), (4 * n, 4 * n), (4 * n, 1)]
    hidden = 2 * n + 4
    assert [layer.weight.shape[1:] for layer in two.layers[::3]] == [(2 * n + 9, hidden), (hidden, hidden), (hidden, 4)]
    entries = n * (n + 3)
    assert [layer.weight.shape[2] for layer in three.layers[::3]] == [2 * entries, 2 * entries, entries]
    assert three.convolution.filters.weight.shape[1:] == (4, n)
    assert three(torch.randn(1, 8, 2 * (n + 3))).shape == (1, 8, entries)


def test_networks_side_by_side_are_as_alone():
    torch.manual_seed(0)
    stack, rows = networks.nn3(6, 2, 3), torch.randn(1, 5, 16)
    together = stack.eval()(rows.expand(3, -1, -1))
    for number in range(3):
        alone = networks.one_of(stack.state_dict(), networks.nn3(6, 2), number)
        torch.testing.assert_close(alone(rows)[0], together[number])


def test_scores_and_patches_are_those_of_their_grid_points():
    group = data.Group(np.zeros((1, 4, 2)), np.ones(1), np.array([[[0.3, -0.2], [-0.5, 0.1]]]), np.ones((1, 2)))
    points, number = paper_placement.grid_points(20), paper_placement.patches(20)
    wanted = np.linalg.norm(points[:, None] - group.inner, axis=-1).min(axis=1)
    np.testing.assert_allclose(batches.scores(group, 20)[0], wanted, atol=1e-5)
    assert sorted(number.ravel()) == list(range(400)) and number.shape == (100, 4)
    assert np.ptp(points[number], axis=1).max() < 0.13


def test_calculated_scores_decode_to_the_vertices_they_were_made_of():
    contour = np.array([[(1, 0), (0.3, 0.9), (-0.8, 0.6), (-0.9, -0.5), (0.2, -1)]], dtype=float)
    inner = np.array([[(0.4, 0.2), (-0.4, 0.1), (0.0, -0.5)]])
    group = data.Group(contour, np.array([0.6]), inner, np.ones((1, 2)))
    n = np.array([5])
    found, count = paper_placement.decode(batches.scores(group, 20), contour, n, np.array([3]), np.array([0.6]))
    assert count[0] == 3
    away = np.linalg.norm(found[0][:, None] - inner[0], axis=-1)
    assert sorted(away.argmin(axis=1)) == [0, 1, 2] and away.min(axis=1).max() < 0.06


def test_the_element_in_a_sharp_tail_is_shown_and_does_not_decide():
    row = {"name": "wing", "paper": (0.7, 0.9), "q_worst": 0.8, "q_mean": 0.95, "q_left_out": 0.4, "triangles": 9}
    worst, mean = claims._domains([row])
    assert (worst.answer, mean.answer) == ("better", "better")
    assert worst.shipped == "0.80 (0.40 with the element in the sharp tail)" and mean.shipped == "0.95"
    assert "0.80, 0.95 | 0.40" in markdown.domain_table([row])


@pytest.mark.parametrize(("adaptive", "spread", "answer"), [(14.0, 0.5, "reproduced"), (20.0, 3.0, "worse")])
def test_a_gain_that_could_be_none_is_not_reproduced(adaptive, spread, answer):
    rows = [
        {"m": 1, "level": 96, "sampling": sampling, "worst": worst, "worst_spread": spread, "size": size}
        for sampling, worst, size in (("random", 20.0, 594), ("adaptive", adaptive, 382))
    ]
    assert next(iter(claims._adaptive(rows))).answer == answer


def test_epochs_are_those_of_the_exported_networks(tiny):
    folder = tiny["folders"]["models"]
    assert markdown.epochs(folder / "nn1_6.onnx") == pytest.approx(40 * fitting.BATCH / (60 * 3))
    assert markdown.epochs(folder / "nn1_5.onnx") is None


def test_shards_are_reproducible_and_hold_every_mesh():
    first, again = (generate.make_shard((7, 6, 0), 6, 3, [0.5, 1.0]) for _ in range(2))
    for name in first:
        np.testing.assert_array_equal(first[name], again[name])
    assert first["n_inner"].sum() == len(first["inner"]) and (first["quality"] > 0).all()


def test_a_contour_has_the_same_answer_wherever_it_begins():
    points = contours.transformed_sector(np.random.default_rng(8), 8)
    meshes = [tessera.mesh_contour(np.roll(points, shift, axis=0), 0.7, networks="paper") for shift in (0, 3)]
    assert meshes[0].report.n_vertices == meshes[1].report.n_vertices
    assert meshes[0].report.q_worst == pytest.approx(meshes[1].report.q_worst, abs=1e-6)


def test_the_shipped_roles_are_the_shipped_networks():
    assert SHIPPED.count is tessera.networks.count_inner_vertices
    assert paper.roles_named("shipped") is SHIPPED


def test_the_kept_networks_are_small_and_not_in_the_extension():
    kept = list(paper.FOLDER.glob("*.onnx"))
    assert kept and sum(file.stat().st_size for file in kept) < 15e6
    manifest = tomllib.loads((configuration.ROOT / "blender_manifest.toml").read_text())
    patterns = manifest["build"]["paths_exclude_pattern"]
    assert patterns[0] == "/*" and not any(paper.FOLDER.name in pattern for pattern in patterns)
