"""How onnxruntime runs the networks."""

import numpy as np
import pytest

import tessera
from tessera import networks

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


@pytest.fixture(autouse=True)
def as_it_was():
    yield
    networks.use(networks.Execution())


def test_threads_are_those_that_are_asked_for_and_the_mesh_is_as_good():
    first = tessera.mesh([SQUARE], 0.1)
    networks.use(networks.Execution(threads=2))
    assert networks.session("nn1").get_session_options().intra_op_num_threads == 2
    again = tessera.mesh([SQUARE], 0.1)
    assert again.report.n_triangles == first.report.n_triangles
    assert np.allclose(again.vertices, first.vertices, atol=1e-3)


def test_sessions_stay_open_while_nothing_changes():
    session = networks.session("nn1")
    networks.use(networks.Execution())
    assert networks.session("nn1") is session
    networks.use(networks.Execution(threads=2))
    assert networks.session("nn1") is not session


def test_a_provider_that_is_not_there_is_the_cpu():
    networks.use(networks.Execution(provider="NoSuchExecutionProvider"))
    assert networks.session("nn1").get_providers() == ["CPUExecutionProvider"]
    assert tessera.mesh([SQUARE], 0.3).report.n_triangles > 0
