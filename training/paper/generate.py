"""The paper's data (section 2.2, Fig. 17): ``python -m training.paper.generate``.

Random contours of 4, 6, ... 16 edges, a vertex in each sector of the unit disk, superimposed on the regular polygon and
meshed by the reference at every target edge length. A shard is made from a seed of its own and gets its name when it is
whole, so that a run that was killed goes on; `manifest.json` says what was made from what.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np

from .. import contours, measures, reference
from ..provenance import code_version, fingerprint
from . import settings


def main() -> None:
    """Make the shards that are missing."""
    config, _ = settings.from_command_line(__doc__)
    make_all(config)


def make_all(config: dict) -> None:
    """Make the shards that are missing, of both splits, and the manifest."""
    folder, data = config["folders"]["data"], config["data"]
    folder.mkdir(parents=True, exist_ok=True)
    reference.start()
    for split, seed in data["seeds"].items():
        for n, count in data[split].items():
            for number in range(-(-count // data["shard"])):
                file = shard_file(folder, split, n, number)
                if not file.exists():
                    _write(file, make_shard((seed, n, number), n, data["shard"], data["targets"]))
                    print(file.name, flush=True)
    manifest = {
        "configuration": data,
        "reference": {"gmsh": reference.VERSION, "options": reference.OPTIONS},
        "code": code_version(),
        "shards": {file.name: fingerprint(file) for file in sorted(folder.glob("*-*-*.npz"))},
    }
    (folder / "manifest.json").write_text(json.dumps(manifest, indent=1))


def shard_file(folder: Path, split: str, n: int, number: int) -> Path:
    """Where a shard of contours of n edges is."""
    return folder / f"{split}-{n:02d}-{number:03d}.npz"


def make_shard(seed: tuple[int, ...], n: int, size: int, targets: list[float]) -> dict[str, np.ndarray]:
    """Contours (size, n, 2), and of the meshes at T targets: n_inner (size, T), quality (size, T, 2), inner vertices.

    The inner vertices of all meshes (k, 2) lie one behind the other. Contours that the reference changes, or inverts
    elements of, are drawn anew.
    """
    rng = np.random.default_rng(seed)
    found = []
    while len(found) < size:
        points = contours.transformed_sector(rng, n)
        meshes = [reference.mesh(points, length) for length in targets]
        if all(reference.keeps(points, vertices) for vertices, _ in meshes):
            quality = [measures.qualities(*mesh) for mesh in meshes]
            if min(worst for worst, _ in quality) > 0:
                found.append((points, [vertices[n:] for vertices, _ in meshes], quality))
    return {
        "contour": np.array([points for points, _, _ in found]),
        "n_inner": np.array([[len(part) for part in inner] for _, inner, _ in found]),
        "quality": np.array([quality for _, _, quality in found]),
        "inner": np.concatenate([part for _, inner, _ in found for part in inner]).astype(np.float32),
    }


def _write(file: Path, arrays: dict[str, np.ndarray]) -> None:
    unfinished = file.with_suffix(f".{os.getpid()}.part")
    with open(unfinished, "wb") as stream:
        np.savez(stream, **arrays)
    unfinished.rename(file)


if __name__ == "__main__":
    main()
