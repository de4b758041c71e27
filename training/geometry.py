"""Geometry inside the networks: contours in units of a length, squared distances as products, feet on edges.

Written for the processor's cache: x and y of vertices are arrays of their own, as operations along short axes cost
onnxruntime more than the arithmetic, and what is wide is a product of matrices. Padded vertices lie so far away that
nothing sees them.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

AWAY = 100.0  # where padding is, in units
SCALES = 3  # of closeness to edges


def is_real(count: Tensor, size: int) -> Tensor:
    """(B, size) float: 1 for the first ``count`` slots, 0 for padding."""
    return (torch.arange(size, device=count.device).unsqueeze(0) < count.unsqueeze(1)).float()


def area(ring: Tensor, n_contour: Tensor) -> Tensor:
    """(B,) area of contours, as rings (B, 2, N + 2)."""
    here, after = ring[:, :, 1:-1], ring[:, :, 2:]
    cross = here[:, 0] * after[:, 1] - here[:, 1] * after[:, 0]
    return 0.5 * (cross * is_real(n_contour, cross.shape[1])).sum(1)


def even_length(ring: Tensor, n_contour: Tensor, n_inner: Tensor) -> Tensor:
    """(B,) edge length of equilateral elements that would fill the cavity: 2 N_I + N_C - 2 of them."""
    elements = (2 * n_inner + n_contour - 2).float()
    return torch.sqrt(area(ring, n_contour).clamp(min=1e-4) * 4 / 3**0.5 / elements)


def lower(x: Tensor, y: Tensor) -> Tensor:
    """(B, n, 4): -2 x, -2 y, 1, x² + y² of points, whose products with `lift` are squared distances."""
    return torch.stack([x * -2, y * -2, torch.ones_like(x), x * x + y * y], -1)


def lift(x: Tensor, y: Tensor) -> Tensor:
    """(B, 4, n): x, y, x² + y², 1 of points."""
    return torch.stack([x, y, x * x + y * y, torch.ones_like(x)], 1)


@dataclass(frozen=True)
class Outline:
    """Contours in units of a length, and what is asked of their edges."""

    x: Tensor  # (B, N) vertices
    y: Tensor
    ahead: tuple[Tensor, Tensor, Tensor]  # (B, N) x, y and length of the edge to the next vertex
    back: tuple[Tensor, Tensor, Tensor]  # of the edge to the previous vertex
    lowered: Tensor  # (B, N, 4) the vertices' `lower`
    lifted: Tensor  # (B, 4, N) their `lift`
    along: Tensor  # (B, 4, N), whose products with `lower` are distances along the edges
    feet: Tensor  # (B, 2 N, 4): x, y, 1, 1 of the edges' starts, then x, y, 0, 0 of their directions


def outline(ring: Tensor, n_contour: Tensor, unit: Tensor) -> Outline:
    """Contours, as rings (B, 2, N + 2), in units (B,)."""
    real = is_real(n_contour, ring.shape[2] - 2)
    away, scale = (1 - real) * AWAY, real / unit.unsqueeze(1)
    (x, y), (after_x, after_y), (before_x, before_y) = (
        (part[:, 0], part[:, 1]) for part in (ring[:, :, 1:-1], ring[:, :, 2:], ring[:, :, :-2])
    )
    ahead_x, ahead_y = (after_x - x) * scale, (after_y - y) * scale
    back_x, back_y = (before_x - x) * scale, (before_y - y) * scale
    length = torch.sqrt(ahead_x * ahead_x + ahead_y * ahead_y + 1e-12)
    behind = torch.sqrt(back_x * back_x + back_y * back_y + 1e-12)
    x, y = x * scale + away, y * scale + away
    unit_x, unit_y = ahead_x / length, ahead_y / length
    offset = x * unit_x + y * unit_y
    one, nothing = torch.ones_like(x), torch.zeros_like(x)
    along = torch.stack([unit_x * -0.5, unit_y * -0.5, -offset, nothing], 1)
    feet = torch.cat([torch.stack([x, y, one, one], -1), torch.stack([unit_x, unit_y, nothing, nothing], -1)], 1)
    ahead, back = (ahead_x, ahead_y, length), (back_x, back_y, behind)
    return Outline(x, y, ahead, back, lower(x, y), lift(x, y), along, feet)


def decay(exponent: Tensor) -> Tensor:
    """exp, never so near 0 that it is denormal: the processor takes a hundred times as long for such numbers."""
    return torch.exp(exponent.clamp(min=-60))


def closeness(squared: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """exp(-rate d²) of squared distances at three rates, each four times the one before."""
    return tuple(decay(squared * -rate) for rate in (0.4, 1.6, 6.4))
