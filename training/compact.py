"""The compact form of a split: one file of half precision, for training here or on another machine.

Contours and inner vertices lie one after the other without padding: about 60 bytes an example. Connection tables are
not in it; they are made while NN3 trains.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

_POINTS = {"contour": "n_contour", "inner": "n_inner"}


def pack(folder: Path, file: Path) -> None:
    """Put all shards of a folder, in the order of their names, into one file."""
    shards = [np.load(shard) for shard in sorted(folder.glob("*-*.npz"))]
    if not shards:
        raise FileNotFoundError(f"no shards in {folder}: run 'python -m training.generate {folder.name}'")
    arrays = {name: np.concatenate([shard[name] for shard in shards]) for name in shards[0].files}
    for name, count in _POINTS.items():
        arrays[name] = arrays[name][np.arange(arrays[name].shape[1]) < arrays[count][:, None]]
    halves = {name: array.astype(np.float16) if array.dtype.kind == "f" else array for name, array in arrays.items()}
    unfinished = file.with_suffix(f".{os.getpid()}.part")
    with open(unfinished, "wb") as stream:
        np.savez_compressed(stream, **halves)
    unfinished.rename(file)


def unpack(file: Path) -> dict[str, np.ndarray]:
    """The arrays of `generate.make_shard` for all examples of a file: float64 and int64, points padded with zeros."""
    if not file.exists():
        raise FileNotFoundError(f"no {file}: run 'python -m training.generate {file.stem}'")
    with np.load(file) as packed:
        arrays = {
            name: packed[name].astype(np.float64 if packed[name].dtype.kind == "f" else np.int64) for name in packed
        }
    for name, count in _POINTS.items():
        real = np.arange(arrays[count].max(initial=1)) < arrays[count][:, None]
        padded = np.zeros((*real.shape, 2))
        padded[real] = arrays[name]
        arrays[name] = padded
    return arrays
