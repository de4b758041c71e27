"""The paper's networks: NN1 (section 2.3, Fig. 7), NN2 (2.4, Fig. 9), NN3 (2.5, Fig. 13) and NN3* (2.5.3).

Several networks of one shape are trained side by side, each with weights, batches and normalisation of its own: all
tensors have the networks first, (G, B, ...). Every network takes one row of numbers, what comes first named first:

    NN1    P_C, l_s                      -> N_I
    NN2    P_C, l_s, P_Gk of a patch     -> the scores of its four grid points
    NN3    P_C, P_I                      -> q_worst of every entry of the connection table, row by row
    NN3*   P_C, P_I, i as 1 of N_C       -> q_worst of the entries of the table's row i

Coordinates are those of the transformed contour, x and y of each vertex, beginning at its first vertex.
"""

from __future__ import annotations

import torch
from torch import nn

from tessera.paper_placement import PATCH


class Linear(nn.Module):
    """Fully connected layers of G networks: (G, B, inputs) -> (G, B, outputs)."""

    def __init__(self, networks: int, inputs: int, outputs: int) -> None:
        super().__init__()
        bound = inputs**-0.5
        self.weight = nn.Parameter(torch.empty(networks, inputs, outputs).uniform_(-bound, bound))
        self.bias = nn.Parameter(torch.empty(networks, 1, outputs).uniform_(-bound, bound))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Each network's own product."""
        return torch.baddbmm(self.bias, x, self.weight)


class BatchNorm(nn.Module):
    """Batch normalisation of G networks, each over its own batch: (G, B, features) -> the same."""

    def __init__(self, networks: int, features: int, momentum: float = 0.1, eps: float = 1e-5) -> None:
        super().__init__()
        self.momentum, self.eps = momentum, eps
        self.scale = nn.Parameter(torch.ones(networks, 1, features))
        self.shift = nn.Parameter(torch.zeros(networks, 1, features))
        self.register_buffer("mean", torch.zeros(networks, 1, features))
        self.register_buffer("variance", torch.ones(networks, 1, features))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """By the batch while training, by the running means afterwards."""
        networks, batch, features = x.shape
        rows = x.transpose(0, 1).reshape(batch, networks * features)
        own = (part.reshape(-1) for part in (self.mean, self.variance, self.scale, self.shift))
        rows = nn.functional.batch_norm(rows, *own, self.training, self.momentum, self.eps)
        return rows.reshape(batch, networks, features).transpose(0, 1)


class Convolution(nn.Module):
    """Fig. 13: N_C filters of 2×2 with stride 2 over the contour's coordinates, then max pooling of 2×1, stride 2.

    A filter sees two vertices at a time. Where an odd number of pairs is left to pool, the first one follows the last,
    as the vertices go round, so that none is lost. (G, B, 2 N_C) -> (G, B, N_C ceil(N_C / 4)).
    """

    def __init__(self, networks: int, n_contour: int) -> None:
        super().__init__()
        self.filters = Linear(networks, 4, n_contour)
        self.n_contour = n_contour
        self.outputs = n_contour * -(-n_contour // 4)

    def forward(self, contour: torch.Tensor) -> torch.Tensor:
        """Filter and pool."""
        networks, pairs = contour.shape[0], self.n_contour // 2
        found = self.filters(contour.reshape(networks, -1, 4)).reshape(networks, -1, pairs, self.n_contour)
        if pairs % 2:
            found = torch.cat([found, found[:, :, :1]], dim=2)
        pooled = torch.maximum(found[:, :, 0::2], found[:, :, 1::2])
        return pooled.reshape(networks, -1, self.outputs)


class Network(nn.Module):
    """Three fully connected layers, the first two normalised and activated; with or without Fig. 13's convolution."""

    def __init__(
        self, networks: int, inputs: int, hidden: int, outputs: int, activation: nn.Module, convolved: int = 0
    ) -> None:
        super().__init__()
        self.inputs, self.outputs, self.convolved = inputs, outputs, convolved
        if convolved:
            self.convolution = Convolution(networks, convolved)
            inputs += self.convolution.outputs - 2 * convolved
        self.layers = nn.Sequential(
            Linear(networks, inputs, hidden),
            BatchNorm(networks, hidden),
            activation,
            Linear(networks, hidden, hidden),
            BatchNorm(networks, hidden),
            activation,
            Linear(networks, hidden, outputs),
        )

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """(G, B, inputs) -> (G, B, outputs)."""
        if self.convolved:
            contour = self.convolution(x[..., : 2 * self.convolved])
            x = torch.cat([contour, x[..., 2 * self.convolved :]], dim=-1)
        return self.layers(x)


def nn1(n_contour: int, networks: int = 1) -> Network:
    """NN1 (section 3.1.3): 4 N_C hidden nodes, ReLU."""
    return Network(networks, 2 * n_contour + 1, 4 * n_contour, 1, nn.ReLU())


def nn2(n_contour: int, networks: int = 1) -> Network:
    """NN2: 2 N_C + N_Gk hidden nodes, ReLU. Its shape is the same for every N_I."""
    points = PATCH * PATCH
    return Network(networks, 2 * n_contour + 1 + 2 * points, 2 * n_contour + points, points, nn.ReLU())


def nn3(n_contour: int, n_inner: int, networks: int = 1) -> Network:
    """NN3: 2 N_C (N_C + N_I) hidden nodes, tanh."""
    entries = n_contour * (n_contour + n_inner)
    return Network(networks, 2 * (n_contour + n_inner), 2 * entries, entries, nn.Tanh(), n_contour)


def nn3_star(n_contour: int, n_inner: int, networks: int = 1) -> Network:
    """NN3*: the paper does not say how it is made, so as NN3, with the edge's index as N_C further inputs."""
    hidden = 2 * n_contour * (n_contour + n_inner)
    inputs = 2 * (n_contour + n_inner) + n_contour
    return Network(networks, inputs, hidden, n_contour + n_inner, nn.Tanh(), n_contour)


def one_of(stack: dict[str, torch.Tensor], single: Network, number: int) -> Network:
    """A stack of one with the weights of one network of a stack's state, ready to be asked."""
    single.load_state_dict({name: value[number : number + 1] for name, value in stack.items()})
    return single.eval()
