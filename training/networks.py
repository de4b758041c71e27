"""The three roles' networks: one a role, for every N_C and N_I, padded and masked.

All take transformed contours: ``contour`` (B, N, 2) float32 counter-clockwise with ``n_contour`` (B,) int64 vertices
each, the rest padding, and ``l_s`` (B,). Contour vertices are tokens of an encoder; nothing depends on the order of
the inner vertices nor on where the contour starts.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

FAR = -1e4  # added to the attention of a padded token


class Attention(nn.Module):
    """Multi-head attention that may carry a pairwise bias and the mean offset to what each head looks at."""

    def __init__(self, width: int, heads: int, offsets: bool = False):
        super().__init__()
        self.heads, self.size = heads, width // heads
        self.query, self.key, self.value = (nn.Linear(width, width) for _ in range(3))
        self.out = nn.Linear(width + (2 * heads if offsets else 0), width)

    def forward(self, x: Tensor, y: Tensor, bias: Tensor, at: tuple[Tensor, Tensor] | None = None) -> Tensor:
        """x (B, n, W) attends to y (B, m, W); bias broadcasts to (B, heads, n, m); at: places (B, n, 2), (B, m, 2)."""
        b, n, m = x.shape[0], x.shape[1], y.shape[1]
        q = self.query(x).reshape(b, n, self.heads, self.size).transpose(1, 2)
        k = self.key(y).reshape(b, m, self.heads, self.size).permute(0, 2, 3, 1)
        v = self.value(y).reshape(b, m, self.heads, self.size).transpose(1, 2)
        weights = torch.softmax(q @ k * self.size**-0.5 + bias, dim=-1)
        seen = (weights @ v).transpose(1, 2).reshape(b, n, self.heads * self.size)
        if at is not None:
            offset = weights @ at[1].unsqueeze(1) - at[0].unsqueeze(1)  # (B, heads, n, 2)
            seen = torch.cat([seen, offset.transpose(1, 2).reshape(b, n, 2 * self.heads)], dim=-1)
        return self.out(seen)


class Block(nn.Module):
    """Attention and a two-layer perceptron, each added to its normalised input."""

    def __init__(self, width: int, heads: int, offsets: bool = False):
        super().__init__()
        self.before, self.between = nn.LayerNorm(width), nn.LayerNorm(width)
        self.attention = Attention(width, heads, offsets)
        self.perceptron = nn.Sequential(nn.Linear(width, 2 * width), nn.ReLU(), nn.Linear(2 * width, width))

    def forward(self, x: Tensor, y: Tensor | None, bias: Tensor, at: tuple[Tensor, Tensor] | None = None) -> Tensor:
        """Self-attention where y is None, else attention to y."""
        z = self.before(x)
        x = x + self.attention(z, z if y is None else y, bias, at)
        return x + self.perceptron(self.between(x))


def neighbours(contour: Tensor, n_contour: Tensor) -> tuple[Tensor, Tensor]:
    """Next and previous vertex of each contour vertex, (B, N, 2) each; a padded vertex has some real one."""
    index = torch.arange(contour.shape[1], device=contour.device).unsqueeze(0)
    count = n_contour.unsqueeze(1)
    after = torch.where(index + 1 < count, index + 1, torch.zeros_like(index))
    before = torch.where(index > 0, index - 1, count - 1)
    expand = (contour.shape[0], contour.shape[1], 2)
    return (
        torch.gather(contour, 1, after.unsqueeze(-1).expand(expand)),
        torch.gather(contour, 1, before.unsqueeze(-1).expand(expand)),
    )


def is_real(count: Tensor, size: int) -> Tensor:
    """(B, size) float: 1 for the first ``count`` slots, 0 for padding."""
    return (torch.arange(size, device=count.device).unsqueeze(0) < count.unsqueeze(1)).float()


def cross(a: Tensor, b: Tensor) -> Tensor:
    """(...,) cross products of (..., 2)."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def length(a: Tensor) -> Tensor:
    """(...,) lengths of (..., 2), never quite 0."""
    return torch.sqrt((a * a).sum(-1) + 1e-12)


def even_length(contour: Tensor, n_contour: Tensor, n_inner: Tensor) -> Tensor:
    """(B,) edge length of equilateral elements that would fill the cavity: 2 N_I + N_C - 2 of them."""
    after, _ = neighbours(contour, n_contour)
    area = 0.5 * (cross(contour, after) * is_real(n_contour, contour.shape[1])).sum(1)
    elements = (2 * n_inner + n_contour - 2).float()
    return torch.sqrt(area.clamp(min=1e-4) * 4 / 3**0.5 / elements)


class ContourTokens(nn.Module):
    """Features of contour vertices: place, both edges and their lengths, angle, l_s; embedded."""

    def __init__(self, width: int):
        super().__init__()
        self.embed = nn.Linear(13, width)

    def forward(self, contour: Tensor, n_contour: Tensor, l_s: Tensor) -> Tensor:
        """Returns (B, N, W)."""
        after, before = neighbours(contour, n_contour)
        ahead, back = after - contour, before - contour
        la, lb = length(ahead), length(back)
        scale = la * lb + 1e-6
        ones = torch.ones_like(la)
        size = l_s.unsqueeze(1) * ones
        features = [la, lb, cross(ahead, back) / scale, (ahead * back).sum(-1) / scale, size, la / (size + 0.05)]
        features.append(n_contour.unsqueeze(1).float() * ones / 16)
        return self.embed(torch.cat([contour, ahead, back, torch.stack(features, -1)], -1))


class Encoder(nn.Module):
    """Contour tokens, told of each other."""

    def __init__(self, width: int, heads: int, layers: int):
        super().__init__()
        self.tokens = ContourTokens(width)
        self.blocks = nn.ModuleList(Block(width, heads) for _ in range(layers))

    def forward(self, contour: Tensor, n_contour: Tensor, l_s: Tensor) -> tuple[Tensor, Tensor]:
        """Returns tokens (B, N, W) and the bias (B, 1, 1, N) that keeps padding out."""
        x = self.tokens(contour, n_contour, l_s)
        bias = ((1 - is_real(n_contour, contour.shape[1])) * FAR).unsqueeze(1).unsqueeze(1)
        for block in self.blocks:
            x = block(x, None, bias)
        return x, bias


class NN1(nn.Module):
    """How many inner vertices: (contour, n_contour, l_s) -> (B,) a real number near N_I."""

    def __init__(self, width: int = 48, heads: int = 4, layers: int = 3):
        super().__init__()
        self.encoder = Encoder(width, heads, layers)
        self.head = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, 2))

    def forward(self, contour: Tensor, n_contour: Tensor, l_s: Tensor) -> Tensor:
        """Returns (B,)."""
        x, _ = self.encoder(contour, n_contour, l_s)
        real = is_real(n_contour, contour.shape[1]).unsqueeze(-1)
        mean = (x * real).sum(1) / real.sum(1)
        ratio, rest = self.head(mean).unbind(-1)
        # Elements of the target size that the area would hold: most of the answer, so the network learns the departure.
        after, _ = neighbours(contour, n_contour)
        area = 0.5 * (cross(contour, after) * real[..., 0]).sum(1)
        elements = area / (3**0.5 / 4 * l_s * l_s)
        return torch.relu((elements - n_contour.float() + 2) / 2 * (1 + ratio) + 4 * rest)


def distance_to_contour(points: Tensor, contour: Tensor, n_contour: Tensor) -> Tensor:
    """(B, M) distance of each point (B, M, 2) to the nearest contour edge."""
    after, _ = neighbours(contour, n_contour)
    edge = (after - contour).unsqueeze(1)  # (B, 1, N, 2)
    offset = points.unsqueeze(2) - contour.unsqueeze(1)  # (B, M, N, 2)
    t = ((offset * edge).sum(-1) / ((edge * edge).sum(-1) + 1e-12)).clamp(0, 1)
    away = length(offset - t.unsqueeze(-1) * edge)
    return (away + (1 - is_real(n_contour, contour.shape[1])).unsqueeze(1) * 1e3).min(-1).values


class Scores(nn.Module):
    """NN2, where: scores of grid points, their distance to the closest of N_I inner vertices in even lengths."""

    def __init__(self, width: int = 32, heads: int = 4, layers: int = 2, looks: int = 2):
        super().__init__()
        self.encoder = Encoder(width, heads, layers)
        self.count = nn.Linear(3, width)
        self.embed = nn.Linear(12, width)
        self.blocks = nn.ModuleList(Block(width, heads, offsets=True) for _ in range(looks))
        self.head = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, 1))

    def forward(self, contour: Tensor, n_contour: Tensor, n_inner: Tensor, l_s: Tensor, grid: Tensor) -> Tensor:
        """grid: (B, M, 2) points. Returns (B, M)."""
        even = even_length(contour, n_contour, n_inner)
        x, bias = self.encoder(contour, n_contour, l_s)
        inner = n_inner.float()
        x = x + self.count(torch.stack([inner / 8, 1 / (1 + inner), even], -1)).unsqueeze(1)
        away = distance_to_contour(grid, contour, n_contour)
        scale = even.unsqueeze(1)
        waves = [f(k * grid) for k in (3.0, 7.0) for f in (torch.sin, torch.cos)]
        ratio = (away / scale).unsqueeze(-1)
        y = self.embed(torch.cat([grid, *waves, ratio, torch.exp(-ratio)], -1))
        y = y + self.count(torch.stack([inner / 8, 1 / (1 + inner), even], -1)).unsqueeze(1)
        for block in self.blocks:
            y = block(y, x, bias, (grid, contour))
        return self.head(y)[..., 0]


def closeness(at: Tensor, even: Tensor) -> Tensor:
    """(B, n, n, 6) how close tokens at places (B, n, 2) are, on several scales of the even length (B,)."""
    away = length(at.unsqueeze(2) - at.unsqueeze(1)) / even.reshape(-1, 1, 1)
    square = away * away
    return torch.stack([away.clamp(max=6)] + [torch.exp(-square * rate) for rate in (0.06, 0.25, 0.6, 1.5, 4.0)], -1)


class VertexTokens(nn.Module):
    """Contour and inner vertices as one set of tokens, told of each other; contour first."""

    def __init__(self, width: int, heads: int, layers: int):
        super().__init__()
        self.tokens = ContourTokens(width)
        self.embed = nn.Linear(5, width)
        self.pairs = nn.Linear(6, layers * heads)
        self.blocks = nn.ModuleList(Block(width, heads, offsets=True) for _ in range(layers))

    def forward(
        self, contour: Tensor, n_contour: Tensor, inner: Tensor, n_inner: Tensor
    ) -> tuple[Tensor, Tensor, Tensor]:
        """Returns tokens (B, N + M, W), their places (B, N + M, 2) and the even length (B,)."""
        even = even_length(contour, n_contour, n_inner)
        away = distance_to_contour(inner, contour, n_contour) / even.unsqueeze(1)
        features = [inner, torch.stack([away, torch.exp(-away), even.unsqueeze(1) * torch.ones_like(away)], -1)]
        x = torch.cat([self.tokens(contour, n_contour, even), self.embed(torch.cat(features, -1))], 1)
        at = torch.cat([contour, inner], 1)
        real = torch.cat([is_real(n_contour, contour.shape[1]), is_real(n_inner, inner.shape[1])], 1)
        bias = ((1 - real) * FAR).unsqueeze(1).unsqueeze(1)
        pairs = self.pairs(closeness(at, even)).permute(0, 3, 1, 2).chunk(len(self.blocks), 1)
        for block, pair in zip(self.blocks, pairs, strict=True):
            x = block(x, None, bias + pair, (at, at))
        return x, at, even


class Moves(nn.Module):
    """NN2 again: new places of inner vertices that are all seen at once. (B, M, 2)."""

    def __init__(self, width: int = 32, heads: int = 4, layers: int = 3):
        super().__init__()
        self.vertices = VertexTokens(width, heads, layers)
        self.head = nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, 2))

    def forward(self, contour: Tensor, n_contour: Tensor, inner: Tensor, n_inner: Tensor) -> Tensor:
        """inner (B, M, 2), where they are. Returns (B, M, 2)."""
        x, _, even = self.vertices(contour, n_contour, inner, n_inner)
        return inner + self.head(x[:, contour.shape[1] :]) * even.reshape(-1, 1, 1)


class NN3(nn.Module):
    """How to connect: (q_worst, q_mean) of entries of the connection table."""

    def __init__(self, width: int = 32, heads: int = 4, layers: int = 2):
        super().__init__()
        self.vertices = VertexTokens(width, heads, layers)
        self.edge, self.vertex = nn.Linear(2 * width, width), nn.Linear(width, width)
        self.element = nn.Linear(6, width)
        self.head = nn.Sequential(nn.ReLU(), nn.Linear(width, 32), nn.ReLU(), nn.Linear(32, 2))

    def forward(self, contour: Tensor, n_contour: Tensor, inner: Tensor, n_inner: Tensor, entries: Tensor) -> Tensor:
        """entries: (P, 3) int64, an example, a contour edge of it and a vertex (inner ones from N on). Returns (P, 2).

        Only entries whose element is possible are asked for: visibility is theirs by being in the list.
        """
        x, at, even = self.vertices(contour, n_contour, inner, n_inner)
        row, first, third = entries.unbind(1)
        second = torch.where(first + 1 < n_contour[row], first + 1, torch.zeros_like(first))
        a, b, v = at[row, first], at[row, second], at[row, third]
        squares = ((a - b) ** 2).sum(-1) + ((v - a) ** 2).sum(-1) + ((v - b) ** 2).sum(-1)
        quality = 2 * 3**0.5 * cross(b - a, v - a) / (squares + 1e-9)
        la, lb, base = (length(side) / even[row] for side in (v - a, v - b, b - a))
        features = [quality, quality.clamp(0, 1) ** 2, la.clamp(max=5), lb.clamp(max=5), base, la - lb]
        tokens = self.edge(torch.cat([x[row, first], x[row, second]], -1)) + self.vertex(x)[row, third]
        return self.head(tokens + self.element(torch.stack(features, -1)))


ROLES = {"nn1": NN1, "nn2_scores": Scores, "nn2_moves": Moves, "nn3": NN3}
