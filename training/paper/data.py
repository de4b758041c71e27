"""The paper's populations in memory: contours and their reference meshes, in groups by inner vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .generate import shard_file


@dataclass(frozen=True)
class Group:
    """Meshes of contours of one (N_C, N_I): what one NN2 or NN3 learns from, or is tested on."""

    contour: np.ndarray  # (k, N_C, 2) float64, transformed
    l_s: np.ndarray  # (k,) float64
    inner: np.ndarray  # (k, N_I, 2) float64, the reference's inner vertices
    quality: np.ndarray  # (k, 2) float64, the reference's (q_worst, q_mean)

    def __len__(self) -> int:
        return len(self.l_s)

    def rows(self, index: slice | np.ndarray) -> Group:
        """Some of them."""
        return Group(self.contour[index], self.l_s[index], self.inner[index], self.quality[index])


@dataclass(frozen=True)
class Population:
    """Contours of one N_C, each meshed at T target edge lengths."""

    contour: np.ndarray  # (n, N_C, 2) float64, transformed
    targets: np.ndarray  # (T,) float64
    n_inner: np.ndarray  # (n, T) int64
    quality: np.ndarray  # (n, T, 2) float64
    first: np.ndarray  # (n, T) int64, where a mesh's inner vertices begin
    inner: np.ndarray  # (k, 2) float64

    def group(self, n_inner: int) -> Group:
        """All meshes with so many inner vertices, in the order of the contours."""
        row, target = np.nonzero(self.n_inner == n_inner)
        slots = self.first[row, target][:, None] + np.arange(n_inner)
        return Group(self.contour[row], self.targets[target], self.inner[slots], self.quality[row, target])

    def head(self, count: int) -> Population:
        """The first contours."""
        arrays = (array[:count] for array in (self.n_inner, self.quality, self.first))
        return Population(self.contour[:count], self.targets, *arrays, self.inner)


def load(config: dict, split: str, n: int) -> Population:
    """The population of N_C = n: as many contours as the configuration asks for."""
    data, folder = config["data"], config["folders"]["data"]
    count = data[split][n]
    files = [shard_file(folder, split, n, number) for number in range(-(-count // data["shard"]))]
    missing = [file.name for file in files if not file.exists()]
    if missing:
        raise FileNotFoundError(f"no {missing[0]} in {folder}: run 'python -m training.paper.generate'")
    shards = [dict(np.load(file)) for file in files]
    joined = {name: np.concatenate([shard[name] for shard in shards]) for name in shards[0]}
    n_inner = joined["n_inner"].astype(np.int64)
    first = (np.cumsum(n_inner) - n_inner.ravel()).reshape(n_inner.shape)
    inner = joined["inner"].astype(np.float64)
    whole = Population(joined["contour"], np.array(data["targets"]), n_inner, joined["quality"], first, inner)
    return whole.head(count)


def sample_size(population: int, deviation: float = 1.96, interval: float = 0.05) -> int:
    """Cochran's size of a sample for a confidence level and an interval, of a finite population (section 3.2.1).

    deviation: that of the confidence level, 1.96 for the paper's 95 %.
    """
    infinite = deviation**2 * 0.25 / interval**2
    return int(np.ceil(infinite / (1 + (infinite - 1) / max(population, 1))))
