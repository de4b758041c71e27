"""Geometry inside the networks: contours in units of a length, squared distances as products, feet on edges.

Written for the processor's cache: what is wide is a product of matrices or an operation on arrays of one shape, as
broadcasting along short axes costs onnxruntime more than the arithmetic. Padded vertices lie so far away that nothing
sees them.
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


def neighbours(values: Tensor, count: Tensor) -> tuple[Tensor, Tensor]:
    """Values (B, N, W) of the next and of the previous contour vertex; of some real one in padding."""
    (batch, size), device = values.shape[:2], values.device
    index, last = torch.arange(size, device=device).unsqueeze(0), count.unsqueeze(1) - 1
    first = (torch.arange(batch, device=device) * size).unsqueeze(1)
    after = torch.where(index < last, index + 1, torch.zeros_like(index))
    before = torch.where(index > 0, index - 1, last)
    flat = values.flatten(0, 1)
    return flat[first + after], flat[first + before]


def area(contour: Tensor, n_contour: Tensor) -> Tensor:
    """(B,) area of contours (B, N, 2)."""
    after, _ = neighbours(contour, n_contour)
    cross = contour[..., 0] * after[..., 1] - contour[..., 1] * after[..., 0]
    return 0.5 * (cross * is_real(n_contour, contour.shape[1])).sum(1)


def even_length(contour: Tensor, n_contour: Tensor, n_inner: Tensor) -> Tensor:
    """(B,) edge length of equilateral elements that would fill the cavity: 2 N_I + N_C - 2 of them."""
    elements = (2 * n_inner + n_contour - 2).float()
    return torch.sqrt(area(contour, n_contour).clamp(min=1e-4) * 4 / 3**0.5 / elements)


def in_units(points: Tensor, count: Tensor, unit: Tensor) -> Tensor:
    """Points (B, n, 2) in units (B,), padding far away."""
    real = is_real(count, points.shape[1]).unsqueeze(-1)
    return points / unit.reshape(-1, 1, 1) * real + (1 - real) * AWAY


def lift(points: Tensor) -> Tensor:
    """(B, n, 4): x, y, x² + y², 1 of points (B, n, 2)."""
    square = (points * points).sum(-1, keepdim=True)
    return torch.cat([points, square, torch.ones_like(square)], -1)


def lower(points: Tensor) -> Tensor:
    """(B, n, 4): -2 x, -2 y, 1, x² + y², whose products with `lift` are squared distances."""
    square = (points * points).sum(-1, keepdim=True)
    return torch.cat([points * -2, torch.ones_like(square), square], -1)


@dataclass(frozen=True)
class Outline:
    """Contours in units of a length, and what is asked of their edges."""

    contour: Tensor  # (B, N, 2) vertices
    edges: Tensor  # (B, N, 2) to the next vertex
    back: Tensor  # (B, N, 2) to the previous vertex
    lengths: Tensor  # (B, N, 1)
    directions: Tensor  # (B, N, 2) of the edges, unit vectors
    lifted: Tensor  # (B, N, 4)
    along: Tensor  # (B, N, 4), whose products with `lower` are distances along the edges


def outline(contour: Tensor, n_contour: Tensor, unit: Tensor) -> Outline:
    """Contours (B, N, 2) in units (B,)."""
    real = is_real(n_contour, contour.shape[1]).unsqueeze(-1)
    at = in_units(contour, n_contour, unit)
    after, before = neighbours(at, n_contour)
    edges = (after - at) * real
    lengths = torch.sqrt((edges * edges).sum(-1, keepdim=True) + 1e-12)
    directions = edges / lengths
    offset = (at * directions).sum(-1, keepdim=True)
    along = torch.cat([directions * -0.5, -offset, torch.zeros_like(offset)], -1)
    return Outline(at, edges, (before - at) * real, lengths, directions, lift(at), along)


def closeness(squared: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """exp(-rate d²) of squared distances at three rates, each four times the one before."""
    wide = torch.exp(squared * -0.4)
    middle = wide * wide
    middle = middle * middle
    narrow = middle * middle
    return wide, middle, narrow * narrow
