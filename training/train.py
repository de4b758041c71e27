"""Train one role: ``python -m training.train ROLE``, where ROLE is nn1, nn2_scores, nn2_moves or nn3.

Reads from top to bottom: configuration, data, network, loss, loop. A run that was killed goes on from its checkpoint
(``runs/ROLE.pt``), which holds the whole configuration; ``--warm`` starts a new schedule from those weights.
"""

from __future__ import annotations

import argparse
import csv
import time

import numpy as np
import torch
from torch import Tensor
from tqdm import tqdm

from . import configuration
from .data import Examples, by_size, elements_of, load, move_batch, reflect, score_batch, table_batch, trim
from .networks import ROLES

DEVICE = "cuda" if torch.cuda.is_available() else "cpu"


def tensor(array: np.ndarray) -> Tensor:
    """An array on the device, int64 or float32."""
    kind = torch.int64 if array.dtype.kind == "i" else torch.float32
    return torch.as_tensor(np.ascontiguousarray(array), dtype=kind, device=DEVICE)


def quality(a: Tensor, b: Tensor, c: Tensor) -> Tensor:
    """Element quality of triangles (..., 2), negative where inverted."""
    squares = sum((u - v).pow(2).sum(-1) for u, v in ((a, b), (b, c), (c, a)))
    u, v = b - a, c - a
    return 2 * 3**0.5 * (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]) / (squares + 1e-9)


def loss_nn1(net: torch.nn.Module, examples: Examples, rng: np.random.Generator) -> Tensor:
    """Mean absolute error of the number of inner vertices (section 2.3)."""
    count = net(tensor(examples.contour), tensor(examples.n_contour), tensor(examples.l_s))
    return (count - tensor(examples.n_inner)).abs().mean()


def loss_nn2_scores(net: torch.nn.Module, examples: Examples, rng: np.random.Generator) -> Tensor:
    """Squared error of the scores of points over the cavity (section 2.4), linear beyond 0.3 even lengths."""
    points, scores, counts = score_batch(rng, examples)
    inputs = [tensor(a) for a in (examples.contour, examples.n_contour, examples.n_inner, examples.l_s, points)]
    error = torch.nn.functional.huber_loss(net(*inputs), tensor(scores), reduction="none", delta=0.3)
    counts = tensor(counts.astype(float))
    return (error * counts).sum() / counts.sum()


def mesh_energy(at: Tensor, elements: Tensor) -> Tensor:
    """(B,) a soft maximum of -log q over each mesh: (1/4) log of the mean of q^-4, finite where inverted."""
    index = elements.clamp(min=0).reshape(len(elements), -1, 1).expand(-1, -1, 2)
    a, b, c = torch.gather(at, 1, index).reshape(*elements.shape, 2).unbind(2)
    q = quality(a, b, c)
    energy = torch.where(q > 0.1, q.clamp(min=0.1) ** -4, 1e4 + 4e5 * (0.1 - q))
    real = (elements[..., 0] >= 0).float()
    return 0.25 * torch.log((energy * real).sum(1) / real.sum(1))


def loss_nn2_moves(net: torch.nn.Module, examples: Examples, rng: np.random.Generator) -> Tensor:
    """Energy of the mesh after two passes of moving, each on the elements of the vertices it was given."""
    inner, fits = move_batch(rng, examples)
    examples, inner = examples[fits], inner[fits]
    out, ok = np.empty((len(inner), 80, 3), np.int64), np.zeros(len(inner), bool)
    contour, n_contour, n_inner = (tensor(a) for a in (examples.contour, examples.n_contour, examples.n_inner))
    total = 0 * next(net.parameters()).sum()
    for _ in range(2):
        elements_of(examples.contour, inner, examples.n_contour, examples.n_inner, out, ok)
        if not ok.any():  # an untrained network may have moved all of a small batch out of their contours
            break
        moved = net(contour, n_contour, tensor(inner), n_inner)
        rows = torch.tensor(ok, device=DEVICE)
        energy = mesh_energy(torch.cat([contour, moved], 1)[rows], tensor(out)[rows])
        total = total + energy.clamp(max=4).mean() + 0.5 * mean_loss(contour, moved, out, rows)
        inner = moved.detach().cpu().double().numpy()
    return total / 2


def mean_loss(contour: Tensor, moved: Tensor, elements: np.ndarray, rows: Tensor) -> Tensor:
    """Mean shortfall of the element quality from 1."""
    at, elements = torch.cat([contour, moved], 1)[rows], tensor(elements)[rows]
    index = elements.clamp(min=0).reshape(len(elements), -1, 1).expand(-1, -1, 2)
    a, b, c = torch.gather(at, 1, index).reshape(*elements.shape, 2).unbind(2)
    real = (elements[..., 0] >= 0).float()
    return (((1 - quality(a, b, c)) * real).sum(1) / real.sum(1)).mean()


def loss_nn3(net: torch.nn.Module, examples: Examples, rng: np.random.Generator) -> Tensor:
    """Squared error of the possible entries (section 2.5), and how far each edge's choice is from the table's."""
    batch = {name: tensor(array) for name, array in table_batch(rng, examples).items()}
    table, possible = batch["table"], (batch["table"] > 0).any(-1)
    entries = possible.nonzero()
    out = net(batch["contour"], batch["n_contour"], batch["inner"], batch["n_inner"], entries)
    squared = (out - table[possible]).pow(2).sum(-1).mean()
    own = element_qualities(batch, entries)

    def rank(entry: Tensor) -> Tensor:
        """What the triangulation orders the possible entries (P, 2) by; the others far below: (n, N, N + M)."""
        value = torch.minimum(entry[:, 0], own) + entry[:, 1]
        return torch.full(possible.shape, -1e4, device=DEVICE).masked_scatter(possible, 20 * value)

    wanted = torch.softmax(rank(table[possible]), -1)
    divergence = -(wanted * torch.log_softmax(rank(out), -1)).sum(-1)
    choices = possible.sum(-1) > 1
    return squared + 0.02 * divergence[choices].mean()


def element_qualities(batch: dict[str, Tensor], entries: Tensor) -> Tensor:
    """(P,) quality of the element that each entry (P, 3) of a table asks for."""
    row, first, third = entries.unbind(1)
    at = torch.cat([batch["contour"], batch["inner"]], 1)
    second = torch.where(first + 1 < batch["n_contour"][row], first + 1, 0)
    a, b, c = at[row, first], at[row, second], at[row, third]
    return quality(a, b, c)


LOSSES = {"nn1": loss_nn1, "nn2_scores": loss_nn2_scores, "nn2_moves": loss_nn2_moves, "nn3": loss_nn3}


@torch.no_grad()
def validate(role: str, net: torch.nn.Module, examples: Examples) -> float:
    """Mean loss over the validation examples, with the same random numbers every time."""
    rng = np.random.default_rng(0)
    losses = [(len(group), float(LOSSES[role](net, trim(examples[group]), rng))) for group in by_size(examples)]
    return sum(count * loss for count, loss in losses) / len(examples)


def main() -> None:
    """Train the role of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("role", choices=LOSSES)
    parser.add_argument("--steps", type=int, help="length of the schedule (default: the configuration's)")
    parser.add_argument("--warm", action="store_true", help="a new schedule from the checkpoint's weights")
    parser.add_argument("--shards", type=int, help="use only so many shards")
    arguments = parser.parse_args()
    config = configuration.read()
    settings = config["train"] | config["train"].get(arguments.role, {})
    steps = arguments.steps or settings["steps"]
    torch.manual_seed(settings["seed"])
    torch.set_num_threads(settings["threads"])
    examples, held_out = load("train", arguments.shards), load("validation", 1)
    groups = by_size(examples)

    net = ROLES[arguments.role]().to(DEVICE)
    average = ROLES[arguments.role]().to(DEVICE)
    average.load_state_dict(net.state_dict())
    optimiser = torch.optim.AdamW(net.parameters(), lr=settings["rate"], weight_decay=settings["decay"])
    folder = configuration.ROOT / "runs"
    folder.mkdir(exist_ok=True)
    checkpoint, curve = folder / f"{arguments.role}.pt", folder / f"{arguments.role}.csv"
    start = 0
    if checkpoint.exists():
        state = torch.load(checkpoint, map_location=DEVICE, weights_only=False)
        average.load_state_dict(state["average"])
        net.load_state_dict(state["average" if arguments.warm else "network"])
        if not arguments.warm:
            optimiser.load_state_dict(state["optimiser"])
            start = state["step"]

    def save(step: int) -> None:
        state = {"network": net.state_dict(), "average": average.state_dict(), "optimiser": optimiser.state_dict()}
        unfinished = checkpoint.with_suffix(".part")
        torch.save(state | {"step": step, "config": config}, unfinished)
        unfinished.rename(checkpoint)

    losses, saved = [], time.monotonic()
    for step in tqdm(range(start, steps), initial=start, total=steps, mininterval=10):
        rng = np.random.default_rng((settings["seed"], step))
        rate = settings["rate"] * min(1, (step + 1) / 200) * (0.02 + 0.98 * 0.5 * (1 + np.cos(np.pi * step / steps)))
        for group in optimiser.param_groups:
            group["lr"] = rate
        group = groups[rng.choice(len(groups), p=[len(group) / len(examples) for group in groups])]
        rows = rng.choice(group, settings["batch"])
        batch = trim(reflect(examples[rows], rng.random(len(rows)) < 0.5))
        loss = LOSSES[arguments.role](net, batch, rng)
        optimiser.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        optimiser.step()
        decay = min(0.998, (step + 1) / (step + 10))
        with torch.no_grad():
            for mean, now in zip(average.parameters(), net.parameters(), strict=True):
                mean.lerp_(now, 1 - decay)
        losses.append(float(loss.detach()))
        if (step + 1) % settings["report"] == 0 or step + 1 == steps:
            row = [step + 1, float(np.mean(losses[-settings["report"] :])), validate(arguments.role, average, held_out)]
            with curve.open("a", newline="") as file:
                csv.writer(file).writerow(row)
            tqdm.write(f"step {row[0]}: loss {row[1]:.4f}, held out {row[2]:.4f}")
        if time.monotonic() - saved > 120 or step + 1 == steps:
            save(step + 1)
            saved = time.monotonic()


if __name__ == "__main__":
    main()
