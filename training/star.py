"""Train NN2 of a star, the place of a contour's only inner vertex: ``python -m training.star``.

Relaxation asks it for every vertex of a large mesh, again and again, so it is small. It needs no examples: the quality
of the elements around a place can be differentiated, and rings are drawn at random, like those that meshes have but
more uneven. What it minimises is what `smoothing.py` does, the sum of q⁻⁸.
"""

from __future__ import annotations

import csv
import time

import numpy as np
import torch
from torch import Tensor

from . import configuration
from .networks import Star
from .provenance import code_version
from .train import rate_at, save

POWER = 2
# Ring sizes, and the shares in which they are drawn.
SIZES = np.arange(3, 17)
SHARES = np.array([4, 10, 22, 26, 18, 8, 4, 2, 1, 1, 1, 1, 1, 1]) / 100
_POOR = 0.1  # quality below which the energy goes on as a straight line


def rings(rng: np.random.Generator, count: int, size: int) -> np.ndarray:
    """Random rings (count, size, 2) float32, counter-clockwise around the origin, which sees all of each."""
    turn = (
        np.arange(size) + rng.uniform(-0.4, 0.4, (count, size)) * rng.random((count, 1)) + rng.random((count, 1))
    ) / size
    radius = np.exp(rng.normal(0, 0.3, (count, size)) * rng.random((count, 1)))
    points = radius[..., None] * np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)], -1)
    # Stretched along one axis, as beside a boundary or where elements grow.
    points[..., 0] *= np.exp(np.abs(rng.normal(0, 0.3, (count, 1))))
    angle = 2 * np.pi * rng.random((count, 1))
    x, y = points[..., 0], points[..., 1]
    turned = np.stack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y], -1)
    return turned.astype(np.float32)


def wrapped(ring: Tensor) -> tuple[Tensor, Tensor]:
    """Rings (B, N, 2) as the network takes them, and the share of each vertex."""
    share = torch.full((ring.shape[1], len(ring)), 1 / ring.shape[1])
    return torch.cat([ring[:, -1:], ring, ring[:, :1]], 1).permute(2, 1, 0), share


def energy(ring: Tensor, place: Tensor) -> Tensor:
    """(B,) the logarithm of the mean q⁻⁸ of the elements between rings (B, N, 2) and places (B, 2), over 8."""
    a = ring - place.unsqueeze(1)
    b = torch.roll(a, -1, 1)
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    quality = 2 * 3**0.5 * cross / ((a * a).sum(-1) + (b * b).sum(-1) + ((a - b) ** 2).sum(-1))
    inside = -POWER * torch.log(quality.clamp(min=_POOR))
    return (
        torch.logsumexp(inside + POWER * (_POOR - quality).clamp(min=0) / _POOR, 1) / POWER
        - np.log(ring.shape[1]) / POWER
    )


def main() -> None:
    """Train from the start; a minute on one core, so there is nothing to resume."""
    config = configuration.read()
    settings = config["train"] | config["train"]["nn2_star"]
    torch.manual_seed(settings["seed"])
    torch.set_num_threads(settings["threads"])
    net, average = Star(), Star()
    optimiser = torch.optim.AdamW(net.parameters(), lr=settings["rate"], weight_decay=0)
    folder = configuration.ROOT / "runs"
    folder.mkdir(exist_ok=True)
    held = np.random.default_rng((settings["seed"], 1))
    held_out = [torch.tensor(rings(held, 2000, size)) for size in SIZES]
    losses, start = [], time.monotonic()
    with (folder / "nn2_star.csv").open("w", newline="") as file:
        for step in range(settings["steps"]):
            rng = np.random.default_rng((settings["seed"], 2, step))
            ring = torch.tensor(rings(rng, settings["batch"], rng.choice(SIZES, p=SHARES)))
            for group in optimiser.param_groups:
                group["lr"] = rate_at(step, settings["steps"], settings["rate"])
            loss = energy(ring, net(*wrapped(ring)).T).mean()
            optimiser.zero_grad(set_to_none=True)
            loss.backward()
            torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
            optimiser.step()
            losses.append(float(loss.detach()))
            decay = min(0.995, (step + 1) / (step + 10))
            with torch.no_grad():
                for mean, now in zip(average.parameters(), net.parameters(), strict=True):
                    mean.lerp_(now, 1 - decay)
            if (step + 1) % settings["report"] == 0:
                with torch.no_grad():
                    found = [energy(ring, average(*wrapped(ring)).T).mean() for ring in held_out]
                    value = float(SHARES @ np.array(found))
                row = [step + 1, float(np.mean(losses[-settings["report"] :])), value]
                csv.writer(file).writerow(row)
                print(
                    f"step {row[0]}: loss {row[1]:.5f}, held out {row[2]:.5f}, {time.monotonic() - start:.0f} s",
                    flush=True,
                )
    source = {"config": config, "data": "random rings", "code": code_version()}
    save(folder / "nn2_star.pt", {"average": average.state_dict(), "step": settings["steps"]} | source)


if __name__ == "__main__":
    main()
