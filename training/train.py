"""Train one role: ``python -m training.train ROLE``, where ROLE is nn1, nn2_scores, nn2_moves or nn3.

Reads from top to bottom: batches, validation, checkpoint, loop. A run that was killed goes on from its checkpoint
(``runs/ROLE.pt``), which holds the whole configuration; ``--warm`` starts a new schedule from those weights, or from
those that ship where there is no checkpoint.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np
import onnx
import torch
from tqdm import tqdm

from . import configuration
from .data import Examples, by_size, load, reflect, trim
from .losses import DEVICE, INPUTS, LOSSES
from .networks import ROLES
from .provenance import code_version, data_fingerprint

Batch = dict[str, np.ndarray]


def batches(role: str, examples: Examples, settings: dict) -> Callable[[int], Batch]:
    """A function of the step that draws its batch: examples of like size, half of them mirrored.

    The setting ``draws`` limits how many different batches there are, where they are costly to make.
    """
    groups = by_size(examples)
    shares = [len(group) / len(examples) for group in groups]

    def draw(number: int) -> Batch:
        rng = np.random.default_rng((settings["seed"], number))
        rows = rng.choice(groups[rng.choice(len(groups), p=shares)], settings["batch"])
        return INPUTS[role](rng, trim(reflect(examples[rows], rng.random(len(rows)) < 0.5)))

    if "draws" not in settings:
        return draw
    kept = lru_cache(settings["draws"])(draw)
    return lambda number: kept(number % settings["draws"])


@torch.no_grad()
def validate(role: str, net: torch.nn.Module, held_out: list[tuple[int, Batch]]) -> float:
    """Mean loss over batches, each with its number of examples."""
    losses = [(count, float(LOSSES[role](net, batch))) for count, batch in held_out]
    return sum(count * loss for count, loss in losses) / sum(count for count, _ in losses)


def validation_batches(role: str) -> list[tuple[int, Batch]]:
    """The validation examples, with the same random numbers every time."""
    examples, rng = load("validation"), np.random.default_rng(0)
    return [(len(group), INPUTS[role](rng, trim(examples[group]))) for group in by_size(examples)]


def rate_at(step: int, steps: int, largest: float) -> float:
    """The learning rate: a short rise, then half a cosine down to a fiftieth."""
    return largest * min(1, (step + 1) / 200) * (0.02 + 0.98 * 0.5 * (1 + np.cos(np.pi * step / steps)))


def save(file: Path, state: dict) -> None:
    """Write a checkpoint so that a kill leaves the old one or the new one."""
    unfinished = file.with_suffix(".part")
    torch.save(state, unfinished)
    unfinished.rename(file)


def shipped_weights(role: str) -> dict[str, torch.Tensor]:
    """The weights of the exported network, by the framework's names."""
    model = onnx.load(configuration.ROOT / "onnx_models" / f"{role}.onnx")
    arrays = {weight.name: onnx.numpy_helper.to_array(weight) for weight in model.graph.initializer}
    return {name: torch.tensor(arrays[name]) for name in ROLES[role]().state_dict()}


def train(role: str, settings: dict, steps: int, warm: bool, config: dict) -> None:
    """Run the schedule from the checkpoint, if there is one, to its end."""
    batch_at, held_out = batches(role, load("train"), settings), validation_batches(role)
    net, average = ROLES[role]().to(DEVICE), ROLES[role]().to(DEVICE)
    average.load_state_dict(net.state_dict())
    optimiser = torch.optim.AdamW(net.parameters(), lr=settings["rate"], weight_decay=settings["decay"])
    folder = configuration.ROOT / "runs"
    folder.mkdir(exist_ok=True)
    checkpoint, curve, start = folder / f"{role}.pt", folder / f"{role}.csv", 0
    if checkpoint.exists():
        state = torch.load(checkpoint, map_location=DEVICE, weights_only=False)
        average.load_state_dict(state["average"])
        net.load_state_dict(state["average" if warm else "network"])
        if not warm:
            optimiser.load_state_dict(state["optimiser"])
            start = state["step"]
    elif warm:
        net.load_state_dict(shipped_weights(role))
        average.load_state_dict(net.state_dict())
    source = {"config": config, "data": data_fingerprint(), "code": code_version()}
    losses, saved = [], time.monotonic()
    for step in tqdm(range(start, steps), initial=start, total=steps, mininterval=10):
        for group in optimiser.param_groups:
            group["lr"] = rate_at(step, steps, settings["rate"])
        loss = LOSSES[role](net, batch_at(step))
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        optimiser.step()
        decay = min(0.998, (step + 1) / (step + 10))
        with torch.no_grad():
            for mean, now in zip(average.parameters(), net.parameters(), strict=True):
                mean.lerp_(now, 1 - decay)
        losses.append(float(loss.detach()))
        last = step + 1 == steps
        if (step + 1) % settings["report"] == 0 or last:
            row = [step + 1, float(np.mean(losses[-settings["report"] :])), validate(role, average, held_out)]
            with curve.open("a", newline="") as file:
                csv.writer(file).writerow(row)
            tqdm.write(f"step {row[0]}: loss {row[1]:.4f}, held out {row[2]:.4f}")
        if time.monotonic() - saved > 120 or last:
            weights = {"network": net.state_dict(), "average": average.state_dict()}
            save(checkpoint, weights | source | {"optimiser": optimiser.state_dict(), "step": step + 1})
            saved = time.monotonic()


def main() -> None:
    """Train the role of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("role", choices=LOSSES)
    parser.add_argument("--steps", type=int, help="length of the schedule (default: the configuration's)")
    parser.add_argument("--warm", action="store_true", help="a new schedule from known weights")
    arguments = parser.parse_args()
    config = configuration.read()
    settings = config["train"] | config["train"].get(arguments.role, {})
    torch.manual_seed(settings["seed"])
    torch.set_num_threads(settings["threads"])
    steps = arguments.steps or settings["steps"]
    train(arguments.role, settings, steps, arguments.warm, config)


if __name__ == "__main__":
    main()
