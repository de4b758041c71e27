"""Export trained networks to ONNX: ``python -m training.export [ROLE ...]``.

Every file is checked against the framework's own output on several shapes, and carries in its metadata the
configuration, seed, data fingerprint and code version that it was trained with.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import torch

from tessera.elements import describe
from tessera.networks import rings
from tessera.scheme import join_vertices

from . import configuration
from .networks import ROLES

INPUTS = {
    "nn1": ["contour", "n_contour", "l_s"],
    "nn2_scores": ["contour", "n_contour", "n_inner", "grid"],
    "nn2_moves": ["contour", "n_contour", "inner", "n_inner"],
    "nn2_star": ["ring", "share"],
    "nn3": ["vertices", "following", "facets", "apexes", "elements"],
}
AXES = {
    "contour": {0: "batch", 2: "wrapped"},
    "ring": {1: "wrapped", 2: "batch"},
    "share": {0: "edges", 1: "batch"},
    "n_contour": {0: "batch"},
    "n_inner": {0: "batch"},
    "l_s": {0: "batch"},
    "grid": {0: "batch", 2: "points"},
    "inner": {0: "batch", 1: "vertices"},
    "vertices": {0: "vertices"},
    "following": {0: "vertices"},
    "facets": {0: "entries"},
    "apexes": {0: "entries"},
    "elements": {1: "entries"},
}
TOLERANCE = 1e-4


def sample(rng: np.random.Generator, batch: int, edges: int, vertices: int) -> dict[str, torch.Tensor]:
    """Random inputs of every name: star-shaped contours and points in the disk, some of it padding."""
    n_contour = torch.tensor(rng.integers(3, edges + 1, batch))
    angle = 2 * np.pi * (np.arange(edges) + rng.random((batch, edges)) * 0.8) / n_contour.numpy()[:, None]
    radius = rng.uniform(0.4, 1.1, (batch, edges))
    contour = np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1)
    n_inner = torch.tensor(rng.integers(1, vertices + 1, batch))
    row = rng.integers(0, batch, 50)
    facet = rng.integers(0, n_contour.numpy()[row])
    vertex = np.where(
        rng.random(50) < 0.5, (facet + 2) % n_contour.numpy()[row], (n_contour + rng.integers(0, n_inner)).numpy()[row]
    )
    inner = rng.uniform(-0.5, 0.5, (batch, vertices, 2))
    points = join_vertices(contour, n_contour.numpy(), inner, n_inner.numpy())
    entries = np.unique(np.stack([row, facet, vertex]), axis=1).T
    _, described = describe(points, n_contour.numpy(), n_inner.numpy(), entries)
    return {
        "ring": torch.tensor(np.concatenate([contour[:, -1:], contour, contour[:, :1]], axis=1).T, dtype=torch.float32),
        "share": torch.full((edges, batch), 1 / edges),
        "contour": torch.tensor(rings(contour, n_contour.numpy(), np.arange(batch), edges)),
        "n_contour": n_contour,
        "n_inner": n_inner,
        "l_s": torch.tensor(rng.uniform(0.3, 1, batch), dtype=torch.float32),
        "grid": torch.tensor(rng.uniform(-1, 1, (batch, 2, 40)), dtype=torch.float32),
        "inner": torch.tensor(inner, dtype=torch.float32),
        **{name: torch.tensor(value) for name, value in vars(described).items()},
    }


def largest_difference(net: torch.nn.Module, file: Path, role: str) -> float:
    """Between the file's answers and the framework's, over random shapes; relative where they are above 1."""
    rng = np.random.default_rng(0)
    session = onnxruntime.InferenceSession(file, providers=["CPUExecutionProvider"])
    worst = 0.0
    for batch, edges, vertices in [(1, 3, 1), (2, 4, 1), (5, 16, 12), (33, 9, 24), (8, 32, 3), (3, 16, 32)]:
        inputs = {name: value for name, value in sample(rng, batch, edges, vertices).items() if name in INPUTS[role]}
        with torch.no_grad():
            ours = net(**inputs).numpy()
        (theirs,) = session.run(None, {name: value.numpy() for name, value in inputs.items()})
        worst = max(worst, float(np.abs(ours - theirs).max() / max(1, np.abs(ours).max())))
    return worst


def export(role: str) -> None:
    """Write one role's file, and check it."""
    state = torch.load(configuration.ROOT / "runs" / f"{role}.pt", map_location="cpu", weights_only=False)
    net = ROLES[role]()
    net.load_state_dict(state["average"])
    net.eval()
    file = configuration.ROOT / "onnx_models" / f"{role}.onnx"
    file.parent.mkdir(exist_ok=True)
    inputs = sample(np.random.default_rng(1), 4, 12, 6)
    torch.onnx.export(
        net,
        tuple(inputs[name] for name in INPUTS[role]),
        file,
        input_names=INPUTS[role],
        output_names=["out"],
        dynamic_axes={name: AXES[name] for name in INPUTS[role]},
        opset_version=17,
        dynamo=False,
        do_constant_folding=False,  # so that weights keep their names, for warm starts (`train.shipped_weights`)
    )
    model = onnx.load(file)
    config = state["config"]
    metadata = {
        "role": role,
        "configuration": json.dumps(config),
        "seed": str(config["train"]["seed"]),
        "steps": str(state["step"]),
        "data": state["data"],
        "code": state["code"],
    }
    onnx.helper.set_model_props(model, metadata)
    model.doc_string = ""
    for node in model.graph.node:
        node.doc_string = ""
    onnx.save(model, file)
    difference = largest_difference(net, file, role)
    if difference > TOLERANCE:
        raise SystemExit(f"{file.name} departs from the framework's output by {difference:.1e}")
    print(
        f"{file.name}: {file.stat().st_size / 1e6:.2f} MB, {state['step']} steps, differs by at most {difference:.1e}"
    )


def main() -> None:
    """Export the roles of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("roles", nargs="*", metavar="ROLE", help=f"of {', '.join(ROLES)} (default: all)")
    for role in parser.parse_args().roles or ROLES:
        export(role)


if __name__ == "__main__":
    main()
