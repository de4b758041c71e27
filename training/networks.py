"""The three roles' networks: one a role, for every N_C and N_I, padded and masked.

NN1 and NN2 take transformed contours as rings: ``contour`` (B, 2, N + 2) float32, x and y, counter-clockwise: the last
of ``n_contour`` (B,) int64 vertices before the first, the first after the last, then padding. Nothing depends on the
order of the inner vertices nor on where the contour starts. Lengths are in units of the target (NN1) or of the even
edge length, so that nothing depends on the size either.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from .geometry import AWAY, Outline, area, closeness, even_length, is_real, lower, outline
from .layers import Attention, Boundary, Encoder, mean_token

PAIRS = 5  # ways in which a grid point hears an edge


class NN1(nn.Module):
    """How many inner vertices: (contour, n_contour, l_s) -> (B,) a real number near N_I."""

    def __init__(self, width: int = 32, layers: int = 1):
        super().__init__()
        self.encoder = Encoder(width, 2, layers)
        self.head = nn.Sequential(nn.Linear(width, width), nn.ReLU(), nn.Linear(width, 2))

    def forward(self, contour: Tensor, n_contour: Tensor, l_s: Tensor) -> Tensor:
        """Returns (B,)."""
        shape, edges = outline(contour, n_contour, l_s), n_contour.float()
        x = self.encoder(shape, [edges / 16, l_s])
        ratio, rest = self.head(mean_token(x, n_contour)).unbind(-1)
        # Elements of the target size that the area would hold: most of the answer, so the network learns the departure.
        elements = area(contour, n_contour) / (3**0.5 / 4 * l_s * l_s)
        return torch.relu((elements - edges + 2) / 2 * (1 + ratio[:, 0]) + 4 * rest[:, 0])


class Scores(nn.Module):
    """NN2, where: scores of grid points, their distance to the closest of N_I inner vertices in even lengths."""

    def __init__(self, width: int = 32, narrow: int = 24):
        super().__init__()
        self.encoder = Encoder(width, 3, layers=1)
        self.value = nn.Linear(width, PAIRS * narrow)
        self.whole = nn.Linear(width, narrow)
        self.second = nn.Parameter(torch.randn(narrow, narrow) / narrow**0.5)
        self.second_bias = nn.Parameter(torch.zeros(narrow, 1))
        self.third = nn.Parameter(torch.randn(1, narrow) / narrow**0.5)
        self.third_bias = nn.Parameter(torch.zeros(1))

    def forward(self, contour: Tensor, n_contour: Tensor, n_inner: Tensor, grid: Tensor) -> Tensor:
        """grid: (B, 2, M) points. Returns (B, M). Points are the last axis: there are many of them."""
        even, inner = even_length(contour, n_contour, n_inner), n_inner.float()
        shape = outline(contour, n_contour, even)
        x = self.encoder(shape, [n_contour.float() / 16, inner / 16, 1 / (1 + inner)])
        at = grid / even.reshape(-1, 1, 1)
        square = at[:, :1] * at[:, :1] + at[:, 1:] * at[:, 1:]
        lowered = torch.cat([at * -2, torch.ones_like(square), square], 1)
        along = shape.along.transpose(1, 2) @ lowered
        foot = torch.minimum(torch.relu(along), shape.ahead[2].unsqueeze(2))
        # Grid points look further than vertices: their rates are smaller.
        wide, middle, narrow = closeness(0.4 * (shape.lifted.transpose(1, 2) @ lowered + foot * (foot - 2 * along)))
        pairs = torch.cat([wide, middle, narrow, wide * foot, middle * foot], 1)  # (B, N, M) each
        values = torch.cat(self.value(x).chunk(PAIRS, 2), 1)
        whole = self.whole(mean_token(x, n_contour)).transpose(1, 2)
        y = torch.relu(values.transpose(1, 2) @ pairs + whole)
        y = torch.relu(self.second @ y + self.second_bias)
        return (self.third @ y)[:, 0] + self.third_bias


class Pass(nn.Module):
    """One pass of NN2 over all inner vertices: they look at each other and at the contour, and move."""

    def __init__(self, width: int):
        super().__init__()
        self.boundary, self.look = Boundary(width), Attention(width)
        self.head = nn.Linear(width, 2)

    def forward(
        self, x: Tensor, at: tuple[Tensor, Tensor], contour: Tensor, shape: Outline
    ) -> tuple[Tensor, tuple[Tensor, Tensor]]:
        """x (B, M, W): what the vertices at (B, M), x and y, know; contour (B, N, W + 4). Returns both anew."""
        lowered = lower(*at)
        x = x + self.boundary(lowered, shape)
        x = self.look(x, lowered, contour)
        step_x, step_y = self.head(x).unbind(-1)
        return x, (at[0] + step_x, at[1] + step_y)


class Moves(nn.Module):
    """NN2 again: new places of inner vertices that are all seen at once. (B, M, 2)."""

    def __init__(self, width: int = 32, passes: int = 3):
        super().__init__()
        self.encoder = Encoder(width, 2, layers=0)
        self.start = nn.Linear(2, width)
        self.passes = nn.ModuleList(Pass(width) for _ in range(passes))

    def forward(self, contour: Tensor, n_contour: Tensor, inner: Tensor, n_inner: Tensor) -> Tensor:
        """inner (B, M, 2), where they are. Returns (B, M, 2), 0 for padding."""
        return self.trajectory(contour, n_contour, inner, n_inner)[-1] * is_real(n_inner, inner.shape[1]).unsqueeze(-1)

    def trajectory(self, contour: Tensor, n_contour: Tensor, inner: Tensor, n_inner: Tensor) -> list[Tensor]:
        """Places (B, M, 2) after each of the passes."""
        even, count = even_length(contour, n_contour, n_inner), n_inner.float()
        shape, real = outline(contour, n_contour, even), is_real(n_inner, inner.shape[1])
        known = 1 / (1 + count)
        tokens = self.encoder(shape, [n_contour.float() / 16, known])
        tokens = torch.cat([tokens, shape.lowered], 2)
        scale, away = real / even.unsqueeze(1), (1 - real) * AWAY
        at = inner[..., 0] * scale + away, inner[..., 1] * scale + away
        x = self.start(torch.stack([count / 16, known], -1)).unsqueeze(1)
        places = []
        for step in self.passes:
            x, at = step(x, at, tokens, shape)
            places.append(torch.stack(at, -1) * even.reshape(-1, 1, 1))
        return places


class Star(nn.Module):
    """NN2 where N_I is 1 and the contour a ring of neighbours: the place of the vertex, (2, B).

    A mean of the ring's vertices, weighed by what each has around it, so that the place turns, moves and grows with the
    ring. It is asked for every vertex of a large mesh, again and again, so it is small.
    """

    def __init__(self, width: int = 24):
        super().__init__()
        self.first = nn.Linear(9, width)
        self.second = nn.Linear(2 * width, width)
        self.weight = nn.Linear(width, 1)

    def forward(self, ring: Tensor, share: Tensor) -> Tensor:
        """ring: (2, N + 2, B), counter-clockwise, the last vertex before the first and the first after the last.

        share: (N, B), 1 over their number for real vertices, 0 for padding. Returns (2, B). Rings are the last axis:
        there are many of them.
        """
        centre = (ring[:, 1:-1] * share).sum(1, keepdim=True)
        at = ring - centre
        here = at[:, 1:-1]
        size = torch.sqrt(((here[0] * here[0] + here[1] * here[1]) * share).sum(0))
        at = at / size
        x = torch.relu(self.first.weight @ star_features(at) + self.first.bias.unsqueeze(1))
        # The mean of the ring goes through its part of the second layer once.
        each, mean = self.second.weight.split(self.first.out_features, 1)
        x = x.reshape(x.shape[0], *share.shape)
        whole = mean @ (x * share).sum(1) + self.second.bias.unsqueeze(1)
        x = torch.relu((each @ x.flatten(1)).reshape(x.shape) + whole.unsqueeze(1))
        weight = (self.weight.weight @ x.flatten(1) + self.weight.bias).reshape(share.shape)
        return centre[:, 0] + size * (weight * share * at[:, 1:-1]).sum(1)


def star_features(ring: Tensor) -> Tensor:
    """(9, N B) squared lengths and products of each of a ring's vertices, (2, N + 2, B), and of the two beside it."""
    before, here, after = ring[:, :-2], ring[:, 1:-1], ring[:, 2:]

    def dot(a: Tensor, b: Tensor) -> Tensor:
        return a[0] * b[0] + a[1] * b[1]

    def cross(a: Tensor, b: Tensor) -> Tensor:
        return a[0] * b[1] - a[1] * b[0]

    products = [cross(here, after), cross(before, here), dot(here, here), dot(here, after), dot(here, before)]
    products += [dot(here - other, here - other) for other in (after, before)]
    products += [dot(other, other) for other in (after, before)]
    return torch.stack(products).flatten(1)


class NN3(nn.Module):
    """How to connect: (q_worst, q_mean) of entries of connection tables, as `tessera.elements` describes them."""

    def __init__(self, width: int = 32, narrow: int = 16):
        super().__init__()
        self.tokens = nn.Linear(5, width)
        self.start, self.end, self.apex = (nn.Linear(width, narrow, bias=False) for _ in range(3))
        self.element = nn.Linear(8, narrow)
        self.head = nn.Sequential(nn.ReLU(), nn.Linear(narrow, narrow), nn.ReLU(), nn.Linear(narrow, 2))

    def forward(self, vertices: Tensor, following: Tensor, facets: Tensor, apexes: Tensor, elements: Tensor) -> Tensor:
        """Returns (P, 2). Only possible elements are asked for: visibility is theirs by being in the list."""
        tokens = torch.relu(self.tokens(vertices))
        sides = self.start(tokens) + self.end(tokens)[following]
        return self.head(sides[facets] + self.apex(tokens)[apexes] + self.element(elements.T))


ROLES = {"nn1": NN1, "nn2_scores": Scores, "nn2_moves": Moves, "nn2_star": Star, "nn3": NN3}
