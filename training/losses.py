"""What each role is shown and how its answer is judged: ``INPUTS[role]`` makes a batch, ``LOSSES[role]`` the loss."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn

from tessera.networks import rings
from tessera.placement import MOST_INNER
from tessera.scheme import LARGEST_CONTOUR

from .contours import KINDS
from .data import Examples, elements_of, move_batch, score_batch, table_batch

DEVICE = "cuda" if torch.cuda.is_available() else "cpu"

_MOST_ELEMENTS = LARGEST_CONTOUR + 2 * MOST_INNER - 2
# How sharply NN3's entries are compared: broadly, and between near ties.
_SHARPNESS = (20.0, 200.0)


def tensor(array: np.ndarray) -> Tensor:
    """An array on the device, int64 or float32."""
    kind = torch.int64 if array.dtype.kind == "i" else torch.float32
    return torch.as_tensor(np.ascontiguousarray(array), dtype=kind, device=DEVICE)


def contour_of(batch: dict[str, np.ndarray]) -> Tensor:
    """A batch's contours as the networks take them, rings (n, 2, N + 2)."""
    contour, n_contour = batch["contour"], batch["n_contour"]
    return tensor(rings(contour, n_contour, np.arange(len(contour)), contour.shape[1]))


def quality(a: Tensor, b: Tensor, c: Tensor) -> Tensor:
    """Element quality of triangles (..., 2), negative where inverted."""
    squares = sum((u - v).pow(2).sum(-1) for u, v in ((a, b), (b, c), (c, a)))
    u, v = b - a, c - a
    return 2 * 3**0.5 * (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]) / (squares + 1e-9)


def count_inputs(rng: np.random.Generator, examples: Examples) -> dict[str, np.ndarray]:
    """NN1's batch: all but stars, whose number of inner vertices is given."""
    examples = examples[examples.kind != KINDS.index("star")]
    return {name: getattr(examples, name) for name in ("contour", "n_contour", "l_s", "n_inner")}


def count_loss(net: nn.Module, batch: dict[str, np.ndarray]) -> Tensor:
    """Mean absolute error of the number of inner vertices (section 2.3)."""
    count = net(contour_of(batch), tensor(batch["n_contour"]), tensor(batch["l_s"]))
    return (count - tensor(batch["n_inner"])).abs().mean()


def score_inputs(rng: np.random.Generator, examples: Examples) -> dict[str, np.ndarray]:
    """Points over the cavities, (n, 2, M), and their scores."""
    points, scores, counts = score_batch(rng, examples)
    whole = {name: getattr(examples, name) for name in ("contour", "n_contour", "n_inner")}
    return whole | {"grid": points.swapaxes(1, 2), "scores": scores, "counts": counts.astype(float)}


def score_loss(net: nn.Module, batch: dict[str, np.ndarray]) -> Tensor:
    """Squared error of the scores of points over the cavity (section 2.4), linear beyond 0.3 even lengths."""
    found = net(contour_of(batch), *(tensor(batch[name]) for name in ("n_contour", "n_inner", "grid")))
    error = nn.functional.huber_loss(found, tensor(batch["scores"]), reduction="none", delta=0.3)
    counts = tensor(batch["counts"])
    return (error * counts).sum() / counts.sum()


def move_inputs(rng: np.random.Generator, examples: Examples) -> dict[str, np.ndarray]:
    """Inner vertices to be moved."""
    inner, n_inner = move_batch(rng, examples)
    fits = n_inner > 0
    whole = {name: getattr(examples, name)[fits] for name in ("contour", "n_contour")}
    return whole | {"inner": inner[fits], "n_inner": n_inner[fits]}


def move_loss(net: nn.Module, batch: dict[str, np.ndarray]) -> Tensor:
    """Energy of the mesh after each pass of moving, on the elements of the vertices that the pass was given.

    The shares of all passes add up to 1, half of it the last one's.
    """
    given = batch["inner"]
    elements, ok = np.empty((len(given), _MOST_ELEMENTS, 3), np.int64), np.zeros(len(given), bool)
    contour, n_contour, n_inner = (tensor(batch[name]) for name in ("contour", "n_contour", "n_inner"))
    total = 0 * next(net.parameters()).sum()
    passes = net.trajectory(contour_of(batch), n_contour, tensor(given), n_inner)
    for number, moved in enumerate(passes, 1):
        elements_of(batch["contour"], given, batch["n_contour"], batch["n_inner"], elements, ok)
        if not ok.any():  # an untrained network may have moved all of a small batch out of their contours
            break
        rows = torch.tensor(ok, device=DEVICE)
        share = 0.5 if number == len(passes) else 0.5 / (len(passes) - 1)
        total = total + share * mesh_energy(torch.cat([contour, moved], 1)[rows], tensor(elements)[rows])
        given = moved.detach().cpu().double().numpy()
    return total


def mesh_energy(at: Tensor, elements: Tensor) -> Tensor:
    """Mean over meshes of what is missing to perfect elements, the worst and the mean.

    The worst softly, as (1/4) log of the mean of q^-4, finite where inverted; the mean shortfall is added twice.
    """
    index = elements.clamp(min=0).reshape(len(elements), -1, 1).expand(-1, -1, 2)
    a, b, c = torch.gather(at, 1, index).reshape(*elements.shape, 2).unbind(2)
    q = quality(a, b, c)
    real = (elements[..., 0] >= 0).float()
    energy = torch.where(q > 0.1, q.clamp(min=0.1) ** -4, 1e4 + 4e5 * (0.1 - q))
    worst = 0.25 * torch.log((energy * real).sum(1) / real.sum(1))
    return (worst.clamp(max=4) + 2 * ((1 - q) * real).sum(1) / real.sum(1)).mean()


def connection_loss(net: nn.Module, batch: dict[str, np.ndarray]) -> Tensor:
    """Squared error of the possible entries (section 2.5), and how far each facet's choice is from the table's.

    Near ties decide the mean quality, and differ by less than the error of an entry: so choices are compared twice.
    """
    described = {name: tensor(array) for name, array in batch.items()}
    table = described.pop("table")
    possible, own = (table > 0).any(-1), described["elements"][0]
    out = net(**described)
    loss = (out - table[possible]).pow(2).sum(-1).mean()
    choices = possible.sum(-1) > 1

    def rank(entry: Tensor, sharpness: float) -> Tensor:
        """What the triangulation orders the possible entries (P, 2) by; the others far below: (n, N, V)."""
        value = torch.minimum(entry[:, 0], own) + entry[:, 1]
        return torch.full(possible.shape, -1e4, device=DEVICE).masked_scatter(possible, sharpness * value)

    for sharpness in _SHARPNESS:
        wanted = torch.softmax(rank(table[possible], sharpness), -1)
        divergence = -(wanted * torch.log_softmax(rank(out, sharpness), -1)).sum(-1)
        loss = loss + 0.2 * divergence[choices].mean()
    return loss


INPUTS = {"nn1": count_inputs, "nn2_scores": score_inputs, "nn2_moves": move_inputs, "nn3": table_batch}
LOSSES = {"nn1": count_loss, "nn2_scores": score_loss, "nn2_moves": move_loss, "nn3": connection_loss}
