import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tessera.errors import ContourError
from tessera.quality import element_quality

TRIANGLE = np.array([[0, 0], [1, 0], [0.5, np.sqrt(3) / 2]])


@pytest.mark.parametrize("scale", [1e-200, 1e-6, 1.0, 1e6, 1e200])
def test_equilateral_is_one_at_every_scale(scale):
    quality = element_quality(TRIANGLE * scale, np.array([[0, 1, 2], [0, 2, 1]]))
    assert quality == pytest.approx([1.0, -1.0], abs=1e-12)


def test_degenerate_triangles_are_zero():
    points = np.array([[0, 0], [1, 1], [2, 2], [2, 2]], dtype=float)
    assert element_quality(points, np.array([[0, 1, 2], [2, 3, 3], [0, 0, 0]])).tolist() == [0, 0, 0]


@given(st.integers(0, 2**32 - 1))
def test_is_the_papers_formula(seed):
    a, b, c = points = np.random.default_rng(seed).normal(size=(3, 2))
    area = 0.5 * ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    squared = sum(np.sum((p - q) ** 2) for p, q in ((a, b), (b, c), (c, a))) / 3
    assert element_quality(points, np.array([[0, 1, 2]]))[0] == pytest.approx(4 * area / (np.sqrt(3) * squared))


def test_the_error_survives_pickling():
    error = pickle.loads(pickle.dumps(ContourError("crossing", "text", (1.0, 2.0))))
    assert (error.reason, str(error), error.place) == ("crossing", "text", (1.0, 2.0))
