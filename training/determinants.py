"""The graph by which the triangulation looks along lines: ``python -m training.determinants``. Nothing in it is learnt.

Batched products of small matrices take onnxruntime a third of the time that they take numpy, so this step, the heaviest
of the triangulation, is written as a graph (`tessera.visibility`).
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

    def forward(self, lines: Tensor, vertices: Tensor) -> Tensor:
        """lines: (B, 3, L) coefficients of x, y and 1; vertices: (B, 3, V) x, y and 1. Returns (B, L, V)."""
        return lines.transpose(1, 2) @ vertices


def export(file: Path) -> None:
    """Write the graph."""
    sample = torch.rand(2, 3, 5), torch.rand(2, 3, 8)
    torch.onnx.export(
        Determinants(),
        sample,
        file,
        input_names=["lines", "vertices"],
        output_names=["out"],
        dynamic_axes={"lines": {0: "batch", 2: "lines"}, "vertices": {0: "batch", 2: "vertices"}},
        opset_version=17,
        dynamo=False,
    )
    model = onnx.load(file)
    for node in model.graph.node:
        node.doc_string = ""
    onnx.save(model, file)


if __name__ == "__main__":
    export(FILE)
