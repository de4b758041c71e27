"""Layers of the networks: features of contour vertices, the boundary as a vertex sees it, attention with closeness."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from .geometry import SCALES, Outline, closeness, decay, is_real


class ContourTokens(nn.Module):
    """Features of contour vertices: both edges, their lengths, the angle, and what is known of the whole; embedded."""

    def __init__(self, width: int, known: int):
        super().__init__()
        self.embed = nn.Linear(8 + known, width)

    def forward(self, shape: Outline, known: list[Tensor]) -> Tensor:
        """known: (B,) each. Returns (B, N, W)."""
        (ax, ay, ahead), (bx, by, behind) = shape.ahead, shape.back
        scale = ahead * behind + 1e-6
        whole = [value.unsqueeze(1).expand_as(ahead) for value in known]
        features = [ax, ay, bx, by, ahead, behind, (ax * by - ay * bx) / scale, (ax * bx + ay * by) / scale, *whole]
        return self.embed(torch.stack(features, -1))


class Boundary(nn.Module):
    """How the contour lies around points: closeness to its edges on three scales, and the mean way to their feet."""

    def __init__(self, width: int):
        super().__init__()
        self.way = nn.Parameter(torch.randn(SCALES, 2, width) / (9 * SCALES) ** 0.5)
        self.count = nn.Parameter(torch.randn(SCALES, 1, width) / (9 * SCALES) ** 0.5)
        self.bias = nn.Parameter(torch.zeros(width))

    def forward(self, lowered: Tensor, shape: Outline) -> Tensor:
        """Points by their `lower` (B, n, 4). Returns (B, n, W)."""
        along = lowered @ shape.along
        foot = torch.minimum(torch.relu(along), shape.ahead[2].unsqueeze(1))
        # Sums over edges of closeness times the foot's place, and of closeness.
        sums = [
            torch.cat([close, close * foot], 2) @ shape.feet
            for close in closeness(lowered @ shape.lifted + foot * (foot - 2 * along))
        ]
        own = torch.cat([lowered[..., :2]] * SCALES, 2) * torch.cat([each[..., 2:] for each in sums], 2)
        # Ways are from the point itself, of which `lower` has -2 times.
        ways = torch.cat([self.way, self.count, torch.zeros_like(self.count)], 1)
        embed = torch.cat([ways.flatten(0, 1), 0.5 * self.way.flatten(0, 1)])
        return torch.cat([*sums, own], 2) @ embed + self.bias


class Attention(nn.Module):
    """Vertices look at vertices, each head at a scale of its own, and take values and the mean way to what they see."""

    def __init__(self, width: int, heads: int = 4, hidden: int = 64, size: int = 12):
        super().__init__()
        self.size = size
        self.before = nn.LayerNorm(width)
        self.query, self.key = (nn.Parameter(torch.randn(heads, width, size) / (3 * width) ** 0.5) for _ in range(2))
        self.value = nn.Parameter(torch.randn(heads, width, size + 1) / (3 * width) ** 0.5)
        self.rates = nn.Parameter(torch.linspace(-2, 0.7, heads))  # logarithms, per squared unit
        self.heard = nn.Parameter(torch.randn(heads, size + 1, hidden) / (3 * (width + heads * size)) ** 0.5)
        self.way = nn.Parameter(torch.randn(heads, 2, hidden) / (3 * (width + heads * size)) ** 0.5)
        self.first, self.second = nn.Linear(width, hidden), nn.Linear(hidden, width)
        # From `lower`, (-2 x, -2 y, 1, x² + y²), to `lift`, (x, y, x² + y², 1).
        lifted = torch.tensor([[-0.5, 0, 0, 0], [0, -0.5, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]]).expand(heads, 4, 4)
        self.register_buffer("lifted", lifted, persistent=False)
        # What adds up each head's last value, 1, beside all its values.
        last = torch.zeros(size + 4, size + 4)
        last[-1] = 1
        self.register_buffer("sums", torch.block_diag(*[last] * heads), persistent=False)

    def forward(self, x: Tensor, lowered: Tensor, others: Tensor | None) -> Tensor:
        """Vertices x (B, n, W) look at others (B, m, W + 4), if any, and at each other. Returns (B, n, W).

        lowered: (B, n, 4), their places; those of the others are the last four of each. A softmax, in which the squared
        distance is a part of the product of query and key, and the sum over all that is seen a value like others.
        """
        own = torch.cat([self.before(x), lowered], 2)
        seen = own if others is None else torch.cat([others, own], 1)
        heads = [
            decay((own @ query) @ (seen @ key).transpose(1, 2)) @ (seen @ value)
            for query, key, value in zip(*self.matrices(), strict=True)
        ]
        heard = torch.cat(heads, 2)
        hidden = torch.cat([own, heard / (heard @ self.sums)], 2) @ self.to_hidden() + self.first.bias
        return x + self.second(torch.relu(hidden))

    def matrices(self) -> tuple[Tensor, Tensor, Tensor]:
        """(heads, W + 4, size + 4) of queries, keys and values of vertices and their `lower`.

        The products of the last four of query and key are -rate d². Values end with x, y and 1.
        """
        rate = torch.exp(self.rates).reshape(-1, 1, 1)
        lowered = -rate * torch.eye(4, device=rate.device)
        values = torch.cat([self.lifted[..., :2], self.lifted[..., 3:]], 2)
        return tuple(map(_beside, (self.query, self.key, self.value), (lowered, self.lifted, values)))

    def to_hidden(self) -> Tensor:
        """(W + 4 + heads (size + 4), H) from a vertex, its `lower`, and what it has heard."""
        # Ways are from the vertex's own place, of which `lower` has -2 times.
        own = 0.5 * self.way.sum(0)
        heard = torch.cat([self.heard, self.way, torch.zeros_like(self.way[:, :1])], 1).flatten(0, 1)
        return torch.cat([self.first.weight.T, own, torch.zeros_like(own), heard])


def _beside(learnt: Tensor, fixed: Tensor) -> Tensor:
    """Matrices (h, a, b) and (h, c, d) as blocks of (h, a + c, b + d)."""
    above = torch.cat([learnt, torch.zeros_like(learnt[..., :1]).expand(-1, -1, fixed.shape[2])], 2)
    below = torch.cat([torch.zeros_like(fixed[..., :1]).expand(-1, -1, learnt.shape[2]), fixed], 2)
    return torch.cat([above, below], 1)


class Encoder(nn.Module):
    """Contour vertices, told of the boundary and of each other."""

    def __init__(self, width: int, known: int, layers: int):
        super().__init__()
        self.tokens, self.boundary = ContourTokens(width, known), Boundary(width)
        self.layers = nn.ModuleList(Attention(width) for _ in range(layers))
        self.after = nn.LayerNorm(width)

    def forward(self, shape: Outline, known: list[Tensor]) -> Tensor:
        """known: (B,) each. Returns (B, N, W)."""
        x = self.tokens(shape, known) + self.boundary(shape.lowered, shape)
        for layer in self.layers:
            x = layer(x, shape.lowered, None)
        return self.after(x)


def mean_token(x: Tensor, n_contour: Tensor) -> Tensor:
    """(B, 1, W) mean over the real ones of the tokens (B, N, W)."""
    real = is_real(n_contour, x.shape[1])
    return (real / n_contour.float().unsqueeze(1)).unsqueeze(1) @ x
