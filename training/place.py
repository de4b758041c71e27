"""NN2's own placements of the examples, on which its further passes are trained: ``python -m training.place [--shards
N]``.

Uses the exported scores (``onnx_models/nn2_scores.onnx``). Contours where not all vertices found a place are NaN.
"""

from __future__ import annotations

import argparse

import numpy as np
from tqdm import tqdm

from tessera.placement import place_by_scores
from tessera.stopwatch import Stopwatch

from . import configuration
from .data import load

BATCH = 500


def main() -> None:
    """Place the inner vertices of validation and training examples."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shards", type=int, help="how many of the training shards")
    arguments = parser.parse_args()
    folder = configuration.ROOT / configuration.read()["data"]["folder"]
    for split in ("validation", "train"):
        examples = load(split, arguments.shards)
        placed = np.full(examples.inner.shape, np.nan, dtype=np.float32)
        for start in tqdm(range(0, len(examples), BATCH), desc=split):
            part = examples[np.arange(start, min(start + BATCH, len(examples)))]
            inner, count = place_by_scores(part.contour, part.n_contour, part.n_inner, Stopwatch())
            whole = np.flatnonzero(count == part.n_inner)
            placed[start + whole] = 0
            placed[start + whole, : inner.shape[1]] = inner[whole]
        np.save(folder / f"{split}_placed.npy", placed)


if __name__ == "__main__":
    main()
