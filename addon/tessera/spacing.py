"""Vertices along a cut: from the spacing at its ends to the target edge length."""

import numpy as np

# The spacing goes from the boundary's to the target edge length by so much per unit of length.
GRADING = 0.3
# Places along a cut between which its spacing is taken to be constant.
_STEPS = 64


def graded_spacing(position, length, spacing_start, spacing_end, edge_length) -> np.ndarray:
    """Spacing at a position along a cut: the boundary's at its ends, the target away from them."""
    rise_start, rise_end = GRADING * position, GRADING * (length - position)
    coarse = np.maximum(edge_length, np.maximum(spacing_start - rise_start, spacing_end - rise_end))
    fine_start = np.where(spacing_start < edge_length, spacing_start + rise_start, np.inf)
    fine_end = np.where(spacing_end < edge_length, spacing_end + rise_end, np.inf)
    return np.minimum(coarse, np.minimum(fine_start, fine_end))


def natural_segments(length, spacing_start, spacing_end, edge_length) -> np.ndarray:
    """How many segments a cut wants, as a fraction: the integral of 1 / spacing by Simpson's rule."""
    start, middle, end = (
        graded_spacing(share * length, length, spacing_start, spacing_end, edge_length) for share in (0.0, 0.5, 1.0)
    )
    return length * (1 / start + 4 / middle + 1 / end) / 6


def points_between(
    start: np.ndarray,
    end: np.ndarray,
    spacing_start: np.ndarray,
    spacing_end: np.ndarray,
    n_segments: np.ndarray,
    edge_length: np.ndarray,
) -> np.ndarray:
    """The new vertices of k cuts, n_segments - 1 each, from their starts to their ends, at the graded spacing: (n, 2).

    start, end (k, 2); the others (k,).
    """
    length = np.linalg.norm(end - start, axis=1)[:, None]
    middle = (np.arange(_STEPS) + 0.5) / _STEPS
    spacing = graded_spacing(
        middle * length, length, spacing_start[:, None], spacing_end[:, None], edge_length[:, None]
    )
    passed = np.concatenate([np.zeros((len(start), 1)), np.cumsum(1 / spacing, axis=1)], axis=1)
    n_new = n_segments - 1
    cut = np.repeat(np.arange(len(start)), n_new)
    number = np.arange(len(cut)) - np.repeat(np.cumsum(n_new) - n_new, n_new) + 1
    target = passed[cut, -1] * number / n_segments[cut]
    step = np.minimum(np.sum(passed[cut] <= target[:, None], axis=1) - 1, _STEPS - 1)
    share = (step + (target - passed[cut, step]) * spacing[cut, step]) / _STEPS
    return (1 - share)[:, None] * start[cut] + share[:, None] * end[cut]
