"""Contours recorded from the running system: what they promise, and that recording leaves no trace in the library."""

import numpy as np
import pytest

from tessera import ContourError, levels, refinement, relaxation, remeshing, triangulation
from tessera.cavity import areas, is_inside
from tessera.closing import MOST_EDGES
from tessera.contour import clean_domains
from tessera.crossings import crossing_pairs
from tessera.domains import mesh_domains
from tessera.settings import Request, Settings
from tessera.transform import superimpose
from training import domains, recording, running
from training.recording import KINDS

SEED = 990
PLACES = (
    (levels, "mesh_cells"),
    (refinement, "mesh_cells"),
    (remeshing, "mesh_cells"),
    (relaxation, "_better_places"),
    (triangulation, "_triangulate"),
)


@pytest.fixture(scope="module")
def pool():
    return running.pool(np.random.default_rng(SEED), 200)


@pytest.fixture(scope="module")
def sub_contours():
    return recording.sub_contours_of(recording.record(domains.random_domains(np.random.default_rng(SEED), 12)))


def check_contours(contour, n_contour):
    """Simple and counter-clockwise by the library's exact test, transformed, padded with 0."""
    inside = np.arange(contour.shape[1]) < n_contour[:, None]
    assert (contour[~inside] == 0).all() and (areas(contour, n_contour) > 0).all()
    end = np.take_along_axis(
        contour, (np.arange(contour.shape[1]) + 1)[None, :, None] % n_contour[:, None, None], axis=1
    )
    group = np.broadcast_to(np.arange(len(contour))[:, None], inside.shape)
    pairs = crossing_pairs(contour[inside], end[inside], group[inside])
    # Vertices of straight edges are on them but for rounding, by which neighbours may touch.
    first = np.cumsum(n_contour) - n_contour
    place, n = pairs - first[group[inside]][pairs], n_contour[group[inside][pairs[:, 0]]]
    apart = place[:, 1] - place[:, 0]
    assert ((apart == 1) | (apart == n - 1)).all()
    again = superimpose(contour, n_contour)
    np.testing.assert_allclose(again.centre, 0, atol=1e-9)
    np.testing.assert_allclose(again.factor, 1, atol=1e-9)
    radius = np.linalg.norm(contour, axis=-1)
    np.testing.assert_allclose(radius[:, 0], radius.max(axis=1), rtol=1e-8)


def bends(contour):
    """Sine of the turn at each vertex of a contour without padding."""
    came, goes = contour - np.roll(contour, 1, axis=0), np.roll(contour, -1, axis=0) - contour
    cross = came[:, 0] * goes[:, 1] - came[:, 1] * goes[:, 0]
    return cross / np.linalg.norm(came, axis=1) / np.linalg.norm(goes, axis=1)


def test_contours_are_transformed_simple_and_counter_clockwise(pool):
    assert len(pool) >= 200 and pool.contour.shape == (len(pool), 16, 2) and pool.kind.dtype == np.int8
    assert pool.n_contour.min() >= 3 and pool.n_contour.max() <= 16
    # Patches are meshed no finer than is wanted there, and some are small beside that.
    assert (pool.l_s > 0.1).all() and (pool.l_s < 4).all() and np.mean(pool.l_s < 2) > 0.99
    check_contours(pool.contour, pool.n_contour)


def test_all_kinds_occur_and_stars_are_thinned(pool):
    count = np.bincount(pool.kind, minlength=len(KINDS))
    assert (count[:3] > 20).all()
    assert 0 < count[3] <= count[:3].sum() / 3


def test_repetitions_are_left_out():
    contour = np.zeros((3, 16, 2))
    contour[:, :3] = [[1, 0], [-0.5, 0.8], [-0.5, -0.8]]
    contour[1, 0, 0] += 1e-9
    contour[2, 0, 0] += 1e-3
    pool = recording.Pool(contour, np.full(3, 3), np.ones(3), np.zeros(3, dtype=np.int8))
    assert len(running._once(pool)) == 2


def test_split_triangles_have_straight_angles_but_on_curved_boundaries(pool):
    straight = []
    for row in np.flatnonzero(pool.kind == KINDS.index("triangle")):
        turn = bends(pool.contour[row, : pool.n_contour[row]])
        assert 4 <= len(turn) <= 15 and np.count_nonzero(np.abs(turn) < 1e-6) <= len(turn) - 3
        straight.append(np.count_nonzero(np.abs(turn) < 1e-6) == len(turn) - 3)
    assert np.mean(straight) > 0.5


def test_the_same_seed_makes_the_same_pool(pool):
    again = running.pool(np.random.default_rng(SEED), 200)
    for name in pool.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(pool, name), getattr(again, name))


def test_sub_contours_have_their_inner_vertices_inside(sub_contours):
    n, m, points = sub_contours.n_contour, sub_contours.n_inner, sub_contours.points
    index = np.arange(points.shape[1])
    on = index < n[:, None]
    between = ~on & (index < (n + m)[:, None])
    check_contours(np.where(on[..., None], points, 0), n)
    assert is_inside(points, points, n)[between].all() and (m > 0).any() and (m == 0).any()
    assert ((n > MOST_EDGES) | (m > 0)).all() and (points[~on & ~between] == 0).all()


def test_recorded_cells_cover_the_domain_and_nothing_else():
    loop = np.array([[0, 0], [12, 0], [12, 5], [4, 5], [4, 9], [0, 9]], dtype=float)
    found = recording.record([domains.Domain(loop, keep=False)])
    contours = recording.join(found.contours)
    cells = recording.rows_of(contours, contours.kind == KINDS.index("cell"))
    assert len(cells) > 3 and cells.contour.shape[1:] == (16, 2)
    np.testing.assert_allclose(areas(cells.contour, cells.n_contour).sum(), 76)
    real = np.arange(16) < cells.n_contour[:, None]
    end = np.take_along_axis(cells.contour, (np.arange(16) + 1)[None, :, None] % cells.n_contour[:, None, None], axis=1)
    mean = np.where(real, np.linalg.norm(end - cells.contour, axis=-1), 0).sum(axis=1) / cells.n_contour
    np.testing.assert_allclose(cells.l_s, mean)
    scaled = recording.contours_of(found)
    scaled = scaled.l_s[scaled.kind == KINDS.index("cell")]
    np.testing.assert_allclose(scaled, mean * superimpose(cells.contour, cells.n_contour).scale)


def test_recording_changes_no_mesh():
    domain = domains.random_domains(np.random.default_rng(SEED), 6)
    requests = [Request([d.loop], 1.0) for d in domain]
    plain = mesh_domains(requests, Settings(boundary="keep"))
    with recording.recording():
        recorded = mesh_domains(requests, Settings(boundary="keep"))
    for a, b in zip(plain, recorded, strict=True):
        assert isinstance(a, ContourError) or (
            np.array_equal(a.vertices, b.vertices) and np.array_equal(a.triangles, b.triangles)
        )


def test_the_library_is_as_it_was_after_recording_even_after_an_error():
    before = [getattr(module, name) for module, name in PLACES]
    with pytest.raises(RuntimeError), recording.recording():
        assert all(getattr(module, name) is not call for (module, name), call in zip(PLACES, before, strict=True))
        raise RuntimeError
    assert all(getattr(module, name) is call for (module, name), call in zip(PLACES, before, strict=True))


STRAIGHT = [(0, 0), (1, 0), (2, 0), (3, 0), (1.5, 2)]


@pytest.mark.parametrize(
    ("points", "fit"),
    [
        (STRAIGHT, True),
        (STRAIGHT[::-1], False),
        ([(0, 0), (2, 0), (2, 2), (0, 2)], True),
        ([(0, 0), (2, 2), (2, 0), (0, 2)], False),
        ([(0, 0), (3, 0), (3, 2), (1.5, 0.001), (0, 2)], False),
        ([(0, 0), (3, 0), (3, 2), (1.5, -0.5), (0, 2)], False),
        ([(0, 0), (1, 0), (1, 0.001), (1, 1), (0, 1)], False),
        ([(0, 0), (100, 0), (100, 1), (0, 1)], False),
    ],
)
def test_unfit_contours_are_told_from_fit_ones(points, fit):
    for scale in (1, 1e-3):
        contour = np.zeros((1, 16, 2))
        contour[0, : len(points)] = scale * np.array(points)
        assert recording.is_fit(contour, np.array([len(points)]))[0] == fit


def test_random_domains_are_nearly_all_fit_to_mesh_and_coarse_ones_among_them():
    drawn = domains.random_domains(np.random.default_rng(SEED), 80)
    refused = sum(isinstance(result, ContourError) for result in clean_domains([[d.loop] for d in drawn]))
    edges = [np.linalg.norm(d.loop - np.roll(d.loop, 1, axis=0), axis=1).mean() for d in drawn if d.keep]
    assert refused <= 4 and 10 < len(edges) < 45 and max(edges) > 3


def test_real_domains_are_the_same_each_time_and_can_all_be_meshed():
    first, second = domains.real_domains(), domains.real_domains()
    assert len(first) > 500 and {d.keep for d in first} == {True, False}
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a.loop, b.loop)
    assert not any(isinstance(result, ContourError) for result in clean_domains([[d.loop] for d in first]))


def test_evaluation_has_as_many_contours_as_asked_for():
    for points, n_contour, l_s in (running.refinement_contours(SEED, 40), running.real_contours(40)):
        assert points.shape == (40, 16, 2) and n_contour.shape == l_s.shape == (40,)
        check_contours(points, n_contour)


def test_training_sees_no_real_domain(monkeypatch):
    def never():
        raise AssertionError

    monkeypatch.setattr(running, "real_domains", never)
    running.pool(np.random.default_rng(SEED), 10)
