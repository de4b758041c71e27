"""NN2's own placements of the examples, on which its further passes and NN3 are trained: ``python -m training.place``.

Uses the exported scores (``onnx_models/nn2_scores.onnx``). Half of the examples get the teacher's number of vertices,
the others one more or one less, as NN1 may ask for them too; a star keeps its one.
"""

from __future__ import annotations

import numpy as np
from tqdm import tqdm

from tessera.placement import MOST_INNER, place_by_scores
from tessera.stopwatch import Stopwatch

from . import configuration
from .contours import KINDS
from .data import Examples, load, placed_file
from .provenance import fingerprint

BATCH = 500


def place(examples: Examples, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, M, 2) float32, and how many of them (n,)."""
    off = rng.choice([-1, 0, 0, 1], len(examples)) * (examples.kind != KINDS.index("star"))
    wanted = np.clip(examples.n_inner + off, 0, MOST_INNER)
    placed = np.zeros((len(examples), MOST_INNER, 2), dtype=np.float32)
    count = np.zeros(len(examples), dtype=np.int64)
    for start in tqdm(range(0, len(examples), BATCH)):
        rows = slice(start, start + BATCH)
        inner, count[rows] = place_by_scores(
            examples.contour[rows], examples.n_contour[rows], wanted[rows], Stopwatch()
        )
        placed[rows, : inner.shape[1]] = inner
    return placed[:, : max(1, int(count.max()))], count


def main() -> None:
    """Place the inner vertices of validation and training examples."""
    config = configuration.read()["data"]
    for split in ("validation", "train"):
        file = configuration.ROOT / config["folder"] / f"{split}.npz"
        placed_file(split).unlink(missing_ok=True)  # of other examples, perhaps
        placed, n_placed = place(load(split), np.random.default_rng((config["seeds"][split], 100)))
        np.savez(placed_file(split), placed=placed, n_placed=n_placed, examples=fingerprint(file))


if __name__ == "__main__":
    main()
