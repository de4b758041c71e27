"""The graph by which the triangulation looks along lines: ``python -m training.determinants``. Nothing in it is learnt.

Batched products of small matrices take onnxruntime a quarter of the time that they take numpy, so this step, the
heaviest of the triangulation, is written as a graph (`tessera.visibility`).
"""

from __future__ import annotations

from pathlib import Path

import onnx
import torch
from torch import Tensor, nn

from . import configuration

FILE = configuration.ROOT / "onnx_models" / "determinants.onnx"


class Determinants(nn.Module):
    """On which side of lines vertices lie."""

    def forward(self, vertices: Tensor, lines: Tensor) -> Tensor:
        """vertices: (B, 3, V) x, y and 1, or nothing but 0; lines: (2, L) two vertices each. Returns (B, L, V).

        Twice the signed area of the triangle: the line from (a, b) to (c, d) has (x, y) on its left if
        (b - d) x + (c - a) y + (a d - b c) > 0.
        """
        (a, b), (c, d) = (vertices[:, :2].index_select(2, end).unbind(1) for end in lines.unbind(0))
        return torch.stack([b - d, c - a, a * d - b * c], 1).transpose(1, 2) @ vertices


def export(file: Path) -> None:
    """Write the graph."""
    sample = torch.rand(2, 3, 8), torch.tensor([[0, 0, 1], [1, 2, 2]])
    torch.onnx.export(
        Determinants(),
        sample,
        file,
        input_names=["vertices", "lines"],
        output_names=["out"],
        dynamic_axes={"vertices": {0: "batch", 2: "vertices"}, "lines": {1: "lines"}},
        opset_version=17,
        dynamo=False,
    )
    model = onnx.load(file)
    for node in model.graph.node:
        node.doc_string = ""
    onnx.save(model, file)


if __name__ == "__main__":
    export(FILE)
