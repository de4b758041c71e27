"""Which networks the scheme asks: the shipped ones, or the paper's own where they are there (`paper.py`)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from . import networks
from .placement import place_inner_vertices
from .stopwatch import Stopwatch

Arrays = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Roles:
    """What the scheme asks, of contours (B, N, 2) float64 with n_contour (B,) vertices each, transformed but for NN3.

    count: NN1; n_contour, l_s (B,) -> N_I (B,) int64. place: NN2; n_contour, n_inner, l_s, watch -> distinct inner
    vertices (B, M, 2) inside, and how many each contour got (B,), at most n_inner. rate: NN3; vertices (B, V, 2) of
    contours, inner ones right after them, n_contour, n_inner, entries (P, 3) sorted (contour, facet, vertex) ->
    (q_worst, q_mean) (P, 2) float64, rounded so that a last bit decides less often; an entry of 0 is not to be taken.
    """

    count: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]
    place: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray, Stopwatch], Arrays]
    rate: Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def _place(
    times: int, contour: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, l_s: np.ndarray, watch: Stopwatch
) -> Arrays:
    """`place_inner_vertices`, which goes by the number alone."""
    return place_inner_vertices(contour, n_contour, n_inner, watch, times)


SHIPPED = Roles(networks.count_inner_vertices, partial(_place, 1), networks.rate_connections)
# For the cells of domains: NN2's passes go over their vertices twice, as relaxing poor ones later takes longer.
THOROUGH = Roles(networks.count_inner_vertices, partial(_place, 2), networks.rate_connections)
