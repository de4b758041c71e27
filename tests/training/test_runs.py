"""A training run that is killed goes on as if it had not been; what ships is what was trained."""

import sys

import numpy as np
import onnx
import onnxruntime
import pytest
import torch

from tessera.scheme import mesh_contours
from tessera.stopwatch import Stopwatch
from training import configuration, evaluate, generate, train
from training.compact import pack
from training.export import INPUTS, TOLERANCE, largest_difference
from training.networks import ROLES

MODELS = configuration.ROOT / "onnx_models"


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    """A root of its own with a little data, and every step a checkpoint."""
    config = configuration.read()
    config["train"] |= {"batch": 8, "report": 2}
    config["train"] = {key: value for key, value in config["train"].items() if not isinstance(value, dict)}
    for split, seed in (("train", 1), ("validation", 2)):
        folder = tmp_path / "data" / split
        folder.mkdir(parents=True)
        for number, name in enumerate(generate.SETS):
            np.savez(folder / f"{name}-00000.npz", **generate.make_shard((seed, number, 0), name, 20, 32))
        pack(folder, folder.with_suffix(".npz"))
    monkeypatch.setattr(configuration, "ROOT", tmp_path)
    monkeypatch.setattr(configuration, "read", lambda: config)
    ticks = iter(range(0, 10**9, 1000))
    monkeypatch.setattr(train.time, "monotonic", lambda: next(ticks))
    return tmp_path


def run(monkeypatch, role, steps):
    monkeypatch.setattr(sys, "argv", ["train", role, "--steps", str(steps)])
    train.main()


@pytest.mark.parametrize("role", list(train.LOSSES))
def test_a_killed_run_goes_on_as_if_it_had_not_been(role, workplace, monkeypatch):
    run(monkeypatch, role, 4)
    whole = torch.load(workplace / "runs" / f"{role}.pt", weights_only=False)
    (workplace / "runs" / f"{role}.pt").unlink()
    loss, calls = train.LOSSES[role], iter(range(100))

    def killed(net, *rest):
        if net.training and torch.is_grad_enabled() and next(calls) == 2:
            raise KeyboardInterrupt
        return loss(net, *rest)

    with monkeypatch.context() as patch:
        patch.setitem(train.LOSSES, role, killed)
        with pytest.raises(KeyboardInterrupt):
            run(patch, role, 4)
    assert torch.load(workplace / "runs" / f"{role}.pt", weights_only=False)["step"] == 2
    run(monkeypatch, role, 4)
    again = torch.load(workplace / "runs" / f"{role}.pt", weights_only=False)
    assert again["step"] == whole["step"] == 4
    for name, weight in whole["average"].items():
        torch.testing.assert_close(weight, again["average"][name], atol=1e-6, rtol=1e-5)


def test_training_lowers_the_loss(workplace, monkeypatch):
    """On held-out contours: single batches of the tiny training set are too different to compare."""
    run(monkeypatch, "nn1", 300)
    held_out = np.loadtxt(workplace / "runs" / "nn1.csv", delimiter=",")[:, 2]
    assert held_out[-5:].mean() < 0.8 * held_out[0]


def test_seeds_of_training_validation_and_test_differ():
    seeds = configuration.read()["data"]["seeds"]
    assert len(set(seeds.values())) == 3


@pytest.mark.parametrize("role", list(ROLES))
def test_shipped_networks_say_where_they_come_from(role):
    model = onnx.load(MODELS / f"{role}.onnx")
    metadata = {entry.key: entry.value for entry in model.metadata_props}
    assert metadata["role"] == role and int(metadata["steps"]) > 1000
    assert all(metadata[key] for key in ("configuration", "seed", "data", "code"))
    assert [entry.name for entry in model.graph.input] == INPUTS[role]


def test_shipped_networks_are_small():
    assert sum(file.stat().st_size for file in MODELS.glob("*.onnx")) < 8e6


@pytest.mark.parametrize("role", list(ROLES))
def test_export_agrees_with_the_framework(role, tmp_path, monkeypatch):
    from training import export

    torch.manual_seed(1)
    (tmp_path / "runs").mkdir()
    net = ROLES[role]()
    state = {"average": net.state_dict(), "step": 0, "config": configuration.read(), "data": "d", "code": "c"}
    torch.save(state, tmp_path / "runs" / f"{role}.pt")
    monkeypatch.setattr(configuration, "ROOT", tmp_path)
    export.export(role)
    assert largest_difference(net, tmp_path / "onnx_models" / f"{role}.onnx", role) < TOLERANCE


def test_the_scheme_is_better_than_the_reference():
    """ē_worst ≤ −5 %, ē_mean ≤ 0.5 %, on fewer and other contours than `make evaluate`'s."""
    points, n_contour, l_s = evaluate.held_out(800, seed=configuration.read()["data"]["seeds"]["validation"])
    meshes = mesh_contours(points, n_contour, l_s, Stopwatch())
    theirs, _ = evaluate.reference_meshes(points, n_contour, l_s)
    error = (theirs - evaluate.qualities(points, meshes, n_contour)) / theirs
    assert error[:, 0].mean() <= -0.05 and error[:, 1].mean() <= 0.005


def test_determinants_are_what_the_error_bound_allows(tmp_path):
    """The graph that ships, and as its command makes it: products of single precision, in whatever order they add."""
    from training import determinants

    determinants.export(tmp_path / "determinants.onnx")
    rng = np.random.default_rng(0)
    lines, vertices = (rng.uniform(-2, 2, (7, 3, size)).astype(np.float32) for size in (36, 16))
    exact = lines.astype(np.float64).swapaxes(1, 2) @ vertices.astype(np.float64)
    for file in (MODELS / "determinants.onnx", tmp_path / "determinants.onnx"):
        session = onnxruntime.InferenceSession(file, providers=["CPUExecutionProvider"])
        (found,) = session.run(None, {"lines": lines, "vertices": vertices})
        np.testing.assert_allclose(found, exact, rtol=0, atol=12 * 2.0**-24 * 4)


def test_a_warm_start_takes_what_ships(workplace, monkeypatch):
    """In a fresh clone, where there is no checkpoint: the weights by their names in the exported file."""
    (workplace / "onnx_models").mkdir()
    file = workplace / "onnx_models" / "nn1.onnx"
    file.write_bytes((MODELS / "nn1.onnx").read_bytes())
    net = ROLES["nn1"]()
    net.load_state_dict(train.shipped_weights("nn1"))
    assert largest_difference(net.eval(), file, "nn1") < TOLERANCE
    monkeypatch.setattr(sys, "argv", ["train", "nn1", "--steps", "1", "--warm"])
    train.main()
    begun = torch.load(workplace / "runs" / "nn1.pt", weights_only=False)["average"]
    for name, weight in net.state_dict().items():
        torch.testing.assert_close(begun[name], weight, atol=1e-2, rtol=0)
