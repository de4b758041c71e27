"""Layers of the networks: features of contour vertices, the boundary as a vertex sees it, attention with closeness."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from .geometry import SCALES, Outline, closeness, is_real, lower


class ContourTokens(nn.Module):
    """Features of contour vertices: both edges, their lengths, the angle, and what is known of the whole; embedded."""

    def __init__(self, width: int, known: int = 1):
        super().__init__()
        self.embed = nn.Linear(8 + known, width)

    def forward(self, shape: Outline, known: list[Tensor]) -> Tensor:
        """known: (B,) each. Returns (B N, W)."""
        ahead, back = shape.edges, shape.back
        behind = torch.sqrt((back * back).sum(-1, keepdim=True) + 1e-12)
        scale = shape.lengths * behind + 1e-6
        cross = ahead[..., :1] * back[..., 1:] - ahead[..., 1:] * back[..., :1]
        dot = (ahead * back).sum(-1, keepdim=True)
        whole = torch.stack(known, -1).unsqueeze(1).expand(-1, ahead.shape[1], -1)
        features = torch.cat([ahead, back, shape.lengths, behind, cross / scale, dot / scale, whole], -1)
        return self.embed(features.reshape(-1, features.shape[-1]))


class Boundary(nn.Module):
    """How the contour lies around points: closeness to its edges on three scales, and the mean way to their feet."""

    def __init__(self, width: int):
        super().__init__()
        self.embed = nn.Linear(3 * SCALES, width)

    def forward(self, at: Tensor, lowered: Tensor, shape: Outline) -> Tensor:
        """Points at (B, n, 2), and their `lower` (B, n, 4). Returns (B n, W)."""
        batch, n = at.shape[:2]
        along = lowered @ shape.along.transpose(1, 2)
        foot = torch.minimum(torch.relu(along), shape.lengths.transpose(1, 2))
        squared = lowered @ shape.lifted.transpose(1, 2) + foot * (foot - 2 * along)
        close = torch.cat(closeness(squared), 2).reshape(batch, SCALES * n, -1)
        feet = torch.cat([foot] * SCALES, 2).reshape(batch, SCALES * n, -1)
        own = torch.cat([at] * SCALES, 2).reshape(batch, SCALES * n, 2)
        # Sums over edges of closeness times (start, 1, 1), and of closeness times the way from the start to the foot.
        sums = close @ torch.cat([shape.contour, torch.ones_like(shape.contour)], -1)
        ways = (close * feet) @ shape.directions
        features = torch.cat([sums[..., :2] + ways - sums[..., 2:] * own, sums[..., 3:]], -1)
        return self.embed(features.reshape(-1, 3 * SCALES))


class Attention(nn.Module):
    """Vertices look at vertices, each head at a scale of its own, and take values and the mean way to what they see."""

    def __init__(self, width: int, heads: int = 4, hidden: int = 48, size: int = 8):
        super().__init__()
        self.heads, self.size = heads, size
        self.before = nn.LayerNorm(width)
        self.query = nn.Linear(width, heads * size)
        self.key = nn.Linear(width, heads * size, bias=False)
        self.value = nn.Linear(width, heads * size, bias=False)
        self.rates = nn.Parameter(torch.linspace(-2, 0.7, heads))  # logarithms, per squared unit
        self.first = nn.Linear(width + heads * (size + 2), hidden)
        self.second = nn.Linear(hidden, width)

    def forward(self, x: Tensor, others: Tensor | None, squared: Tensor, at: Tensor, places: Tensor) -> Tensor:
        """Vertices x (B n, W) at (B, n, 2) look at others (B, m, W), if any, and at each other.

        squared: (B, n, S) distances to the places (B, S, 2) of the others and of x itself. Returns (B n, W).
        """
        batch, n = at.shape[:2]
        heads, seen = self.heads, places.shape[1]
        z = self.before(x)
        y = z if others is None else torch.cat([others, z.reshape(batch, n, -1)], 1).reshape(batch * seen, -1)
        query = self.query(z).reshape(batch, n, heads, self.size).transpose(1, 2)
        key = self.key(y).reshape(batch, seen, heads, self.size).permute(0, 2, 3, 1)
        value = self.value(y).reshape(batch, seen, heads, self.size).transpose(1, 2)
        distance = torch.exp(self.rates).reshape(1, heads, 1, 1) * squared.unsqueeze(1)
        weights = torch.softmax(query @ key - distance, -1)
        heard = (weights @ value).transpose(1, 2).reshape(batch * n, -1)
        mean = (weights.reshape(batch, heads * n, seen) @ places).reshape(batch, heads, n, 2).transpose(1, 2)
        ways = mean.reshape(batch, n, -1) - torch.cat([at] * heads, 2)
        heard = torch.cat([z, heard, ways.reshape(batch * n, -1)], -1)
        return x + self.second(torch.relu(self.first(heard)))


class Encoder(nn.Module):
    """Contour vertices, told of the boundary and of each other."""

    def __init__(self, width: int, known: int, layers: int):
        super().__init__()
        self.tokens, self.boundary = ContourTokens(width, known), Boundary(width)
        self.layers = nn.ModuleList(Attention(width) for _ in range(layers))
        self.after = nn.LayerNorm(width)

    def forward(self, shape: Outline, known: list[Tensor]) -> Tensor:
        """Returns (B, N, W)."""
        at, lowered = shape.contour, lower(shape.contour)
        x = self.tokens(shape, known) + self.boundary(at, lowered, shape)
        squared = lowered @ shape.lifted.transpose(1, 2)
        for layer in self.layers:
            x = layer(x, None, squared, at, at)
        return self.after(x).reshape(*at.shape[:2], -1)


def mean_token(x: Tensor, n_contour: Tensor) -> Tensor:
    """(B, W) mean over the real ones of the tokens (B, N, W)."""
    real = is_real(n_contour, x.shape[1])
    return ((real / real.sum(1, keepdim=True)).unsqueeze(1) @ x)[:, 0]
