"""The paper's networks: the tables that NN3 learns from, how they are drawn and trained with."""

import numpy as np
import pytest
import torch

from training import contours, tables
from training.paper import batches, comparing, fitting, networks, sampling


def test_a_network_is_asked_for_its_own_group_alone():
    asked = []
    role = comparing.asking(lambda rows: asked.append(rows) or np.full((len(rows), 6 * 7), 0.5), 6, 1, by_row=False)
    corners = np.stack([contours.transformed_sector(np.random.default_rng(seed), 6) for seed in (1, 2)])
    points, entries = np.concatenate([corners, np.zeros((2, 1, 2))], axis=1), np.array([[0, 0, 6], [1, 2, 6]])
    values = role.rate(points, np.array([6, 6]), np.array([1, 0]), entries)
    assert [rows.shape for rows in asked] == [(1, 14)]
    np.testing.assert_array_equal(values, [[0.5, 0], [0, 0]])


def test_random_groups_keep_their_distances():
    contour = contours.transformed_sector(np.random.default_rng(5), 8)
    places = sampling.admissible(contour, 0.06)
    groups = sampling.random_groups(np.random.default_rng(6), places, 4, 50, 0.06)
    away = np.linalg.norm(groups[:, :, None] - groups[:, None], axis=-1) + 10 * np.eye(4)
    assert groups.shape == (50, 4, 2) and away.min() >= 0.06


def test_shuffled_tables_are_those_of_the_shuffled_vertices():
    drawn = contours.transformed_sector(np.random.default_rng(5), 6)[None].repeat(4, axis=0), np.full(4, 0.8)
    found = sampling.random_tables(np.random.default_rng(6), *drawn, 3)
    points, table = torch.as_tensor(found["points"]), torch.as_tensor(found["table"]).float()
    moved, theirs = batches.shuffled(points, table, torch.Generator().manual_seed(7))
    assert torch.equal(moved[:, :6], points[:, :6]) and not torch.equal(moved, points)
    own = tables.connection_tables(moved.double().numpy(), np.full(len(moved), 6), np.full(len(moved), 3))
    np.testing.assert_allclose(theirs, own[..., 0], atol=1e-3)


@pytest.mark.parametrize("role", ["nn1", "nn3"])
def test_training_goes_on_from_its_checkpoint_as_if_never_stopped(tmp_path, role):
    rng = np.random.default_rng(9)
    make = {"nn1": lambda: networks.nn1(4), "nn3": lambda: networks.nn3(4, 1)}[role]
    rows = [array.astype(np.float32) for array in (rng.random((50, make().inputs)), rng.random((50, make().outputs)))]
    draw, weights = batches.from_rows([rows]), []
    for stops in ([6], [2, 6]):
        for steps in stops:
            torch.manual_seed(3)
            net, file = make(), tmp_path / f"{role}-{len(stops)}.pt"
            curve = fitting.fit(net, draw, steps, role, file, {"seed": 1})
        assert curve[-1][0] == 6
        weights.append(net.state_dict())
    for name, value in weights[0].items():
        assert torch.equal(value, weights[1][name]), name


def test_a_batch_has_the_share_of_the_references_vertices():
    one, other = ({"points": np.full((5, 7, 2), v, np.float32), "table": np.zeros((5, 6, 7))} for v in (1.0, 2.0))
    given, wanted = batches.from_tables([batches.mixed(one, (other, share)) for share in (0.25, 0.5)])(
        torch.Generator()
    )
    assert given.shape == (2, fitting.BATCH, 14) and wanted.shape == (2, fitting.BATCH, 42)
    assert (given[:, :, 0] == 2).float().mean(dim=1).tolist() == [0.25, 0.5]
    none = {name: array[:0] for name, array in other.items()}
    assert batches.mixed(one, (none, 0.5)) == [(one, fitting.BATCH)]


def test_batch_normalisation_of_a_stack_is_each_networks_own():
    layer, rows = networks.BatchNorm(3, 5), torch.randn(3, 64, 5) * torch.tensor([1.0, 2.0, 3.0])[:, None, None]
    found = layer.train()(rows)
    torch.testing.assert_close(found.mean(dim=1), torch.zeros(3, 5), atol=1e-5, rtol=0)
    torch.testing.assert_close(found.var(dim=1, correction=0), torch.ones(3, 5), atol=1e-3, rtol=0)
    torch.testing.assert_close(layer.mean, 0.1 * rows.mean(dim=1, keepdim=True))
    assert (layer.eval()(rows) - found).abs().max() > 0.1
