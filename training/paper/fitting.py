"""Training of several networks of one shape side by side (Algorithms 1, 2 and 4): the loop, and its checkpoints."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import torch

from .networks import Network

BATCH = 512  # section 3.1.3
RATE = 1e-4
DECAY = {"nn1": 1e-1, "nn2": 1e-2, "nn3": 1e-1, "nn3_star": 1e-1}
# Products of matrices in bfloat16, weights and all else in float32: half the time of wide networks.
HALVED = ("nn3", "nn3_star")
_SAVED_EVERY = 60  # seconds

# Batches of a generator of random numbers: inputs (G, B, n) and what they should give (G, B, m).
Draw = Callable[[torch.Generator], tuple[torch.Tensor, torch.Tensor]]


def fit(net: Network, draw: Draw, steps: int, role: str, file: Path, notes: dict) -> list[tuple[int, list[float]]]:
    """Train to so many steps, from the checkpoint if there is one; returns the curve: step and each network's loss.

    The loss is the mean absolute error for NN1 and the mean squared error for the others; the optimiser is Adam with
    its weight decay decoupled. notes: what is kept in the checkpoint beside the weights.
    """
    optimiser = torch.optim.AdamW(net.parameters(), lr=RATE, weight_decay=DECAY[role], fused=True)
    curve, start = [], 0
    if file.exists():
        state = torch.load(file, weights_only=False)
        net.load_state_dict(state["network"])
        optimiser.load_state_dict(state["optimiser"])
        curve, start = state["curve"], state["step"]
    net.train()
    running, saved = torch.zeros(()), time.monotonic()
    report = max(1, steps // 20)
    for step in range(start, steps):
        given, wanted = draw(torch.Generator().manual_seed(1_000_003 * notes["seed"] + step))
        with torch.autocast("cpu", torch.bfloat16, enabled=role in HALVED):
            found = net(given)
        apart = found.float() - wanted
        losses = (apart.abs() if role == "nn1" else apart.square()).mean(dim=(1, 2))
        optimiser.zero_grad(set_to_none=True)
        losses.sum().backward()
        optimiser.step()
        running = running + losses.detach()
        last = step + 1 == steps
        if (step + 1) % report == 0:
            curve = [*curve, (step + 1, (running / report).tolist())]
            running = torch.zeros(())
        if last or (time.monotonic() - saved > _SAVED_EVERY and (step + 1) % report == 0):
            state = {"network": net.state_dict(), "optimiser": optimiser.state_dict(), "curve": curve}
            save(file, state | {"step": step + 1, "notes": notes})
            saved = time.monotonic()
    return curve


def save(file: Path, state: dict) -> None:
    """Write so that a kill leaves the old file or the new one."""
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_suffix(".part")
    torch.save(state, unfinished)
    unfinished.rename(file)
