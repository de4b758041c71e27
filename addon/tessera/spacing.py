"""Vertices along a cut: from the spacing at its ends to the target edge length."""

from collections.abc import Callable

import numpy as np

# Points (n, 2) of owners (n,) -> the edge lengths (n,) that are wanted there.
Target = Callable[[np.ndarray, np.ndarray], np.ndarray]

# The spacing goes from the boundary's to the target edge length by so much per unit of length.
GRADING = 0.3
# Places along a cut between which its spacing is taken to be constant.
_STEPS = 64


def graded_spacing(position, length, spacing_start, spacing_end, edge_length) -> np.ndarray:
    """Spacing at a position along a cut: the boundary's at its ends, the target (there) away from them."""
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


def wanted_along(start: np.ndarray, end: np.ndarray, owner: np.ndarray, target: Target, every: int = 1) -> np.ndarray:
    """The target of owners (k,) along cuts from start (k, 2) to end (k, 2), at all steps: (k, _STEPS).

    It is asked for at every so many steps only, and interpolated in between.
    """
    share = (np.arange(_STEPS // every) + 0.5) * every / _STEPS
    stations = start[:, None] + share[:, None] * (end - start)[:, None]
    wanted = target(stations.reshape(-1, 2), np.repeat(owner, len(share))).reshape(len(owner), -1)
    if every == 1:
        return wanted
    at = np.clip(((np.arange(_STEPS) + 0.5) / every - 0.5), 0, len(share) - 1)
    before = np.minimum(at.astype(np.int64), len(share) - 2)
    return wanted[:, before] + (at - before) * (wanted[:, before + 1] - wanted[:, before])


def points_between(
    start: np.ndarray,
    end: np.ndarray,
    spacing_start: np.ndarray,
    spacing_end: np.ndarray,
    most: np.ndarray,
    wanted: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """How many segments k cuts come to at the graded spacing (k,), and their new vertices, from start to end: (n, 2).

    start, end (k, 2); spacing_start, spacing_end, most (k,), the last of segments; wanted: the target along each cut,
    (k, 1) or as of `wanted_along`.
    """
    length = np.linalg.norm(end - start, axis=1)[:, None]
    middle = (np.arange(_STEPS) + 0.5) / _STEPS
    spacing = graded_spacing(middle * length, length, spacing_start[:, None], spacing_end[:, None], wanted)
    passed = np.concatenate([np.zeros((len(start), 1)), np.cumsum(1 / spacing, axis=1)], axis=1)
    n_segments = np.clip(np.rint(passed[:, -1] * length[:, 0] / _STEPS), 1, most).astype(np.int64)
    n_new = n_segments - 1
    cut = np.repeat(np.arange(len(start)), n_new)
    number = np.arange(len(cut)) - np.repeat(np.cumsum(n_new) - n_new, n_new) + 1
    reached = passed[cut, -1] * number / n_segments[cut]
    step = np.minimum(np.sum(passed[cut] <= reached[:, None], axis=1) - 1, _STEPS - 1)
    share = (step + (reached - passed[cut, step]) * spacing[cut, step]) / _STEPS
    return n_segments, (1 - share)[:, None] * start[cut] + share[:, None] * end[cut]
