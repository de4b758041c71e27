import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tessera.contour import clean_domains, clean_loop, nesting, signed_area
from tessera.errors import ContourError
from tests.library.polygons import circle, comb, placed, placements, seeds, simple_polygons, star
from tests.validity import polygon_is_simple

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)


@given(simple_polygons, placements, seeds)
@settings(deadline=None)
def test_simple_polygons_come_back_whatever_their_winding_and_repeats(polygon, placement, seed):
    polygon = placed(polygon, placement)
    rng = np.random.default_rng(seed)
    given_points = np.repeat(polygon[:: rng.choice([-1, 1])], rng.integers(1, 3, len(polygon)), axis=0)
    if rng.random() < 0.5:
        given_points = np.vstack([given_points, given_points[:1]])
    cleaned = clean_loop(given_points)
    assert signed_area(cleaned) > 0
    assert {tuple(p) for p in cleaned} == {tuple(p) for p in polygon} and len(cleaned) == len(polygon)


@given(seeds, st.integers(3, 9), st.booleans(), placements)
@settings(deadline=None)
def test_agrees_with_the_independent_test_of_simplicity(seed, n, on_a_grid, placement):
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 4, (n, 2)).astype(float) if on_a_grid else rng.normal(size=(n, 2))
    points = placed(points, (placement[0], 0.0, placement[2]))
    keep = np.any(points != np.roll(points, 1, axis=0), axis=1)
    try:
        clean_loop(points)
        simple = True
    except ContourError as error:
        simple = False
        assert error.reason in ("self-intersection", "zero-area", "too-few-points")
        if error.reason == "zero-area":  # on one line to rounding: simple by luck, perhaps
            assert np.linalg.svd(points - points[0])[1][1] < 1e-11 * placement[0]
            return
    assert simple == (keep.sum() >= 3 and polygon_is_simple(points[keep]))


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize(
    ("reason", "points", "place"),
    [
        ("too-few-points", [], None),
        ("too-few-points", [[0, 0]], (0, 0)),
        ("too-few-points", [[0, 0], [1, 1], [0, 0], [1, 1]], (0, 0)),
        ("zero-area", [[0, 0], [1, 1], [2, 2], [3, 3]], (0, 0)),
        ("self-intersection", [[0, 0], [2, 2], [2, 0], [0, 2]], (1, 1)),
        ("self-intersection", [[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]], (2, 0)),  # a vertex on an edge
        ("self-intersection", [[0, 0], [2, 0], [1, 1], [2, 2], [0, 2], [1, 1]], (1, 1)),  # a vertex twice
        ("self-intersection", [[0, 0], [2, 0], [2, 2], [2, 5], [2, 2], [0, 2]], (2, 2)),  # a spike folded back
    ],
)
def test_bad_contours_have_their_reason_and_place(reason, points, place, scale):
    with pytest.raises(ContourError) as raised:
        clean_loop(np.array(points) * scale)
    assert raised.value.reason == reason
    if place is None:
        assert raised.value.place is None
    elif reason == "self-intersection" and place == (2, 2):
        assert raised.value.place[0] == pytest.approx(2 * scale)
    else:
        assert raised.value.place == pytest.approx(np.array(place) * scale)
    assert "." in str(raised.value)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_not_finite(bad):
    with pytest.raises(ContourError, match="Point 2") as raised:
        clean_loop([[0, 0], [1, 0], [1, bad]])
    assert raised.value.reason == "not-finite"


def test_one_of_several_contours_is_named_by_its_number():
    square = np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)])
    broken = np.where(square == [1, 1], np.nan, square / 4 + 0.5)
    (error,) = clean_domains([[square, broken]])
    assert "Point 1 of contour 1, counted from 0" in str(error)
    with pytest.raises(ValueError, match=r"contour 1 is an array of shape \(k, 2\), not \(4, 3\)"):
        clean_domains([[square, np.zeros((4, 3))]])


def test_wrong_shape_is_a_plain_value_error():
    with pytest.raises(ValueError, match="shape") as raised:
        clean_loop(np.zeros((4, 3)))
    assert not isinstance(raised.value, ContourError)


def test_domains_are_judged_each_for_itself():
    bow = SQUARE[[0, 2, 1, 3]]
    results = clean_domains([[SQUARE], [bow], [SQUARE, SQUARE + 0.5], [SQUARE, SQUARE + 1], [SQUARE, SQUARE + 2], [[]]])
    assert [r.reason if isinstance(r, ContourError) else len(r) for r in results] == [
        1, "self-intersection", "crossing", "crossing", 2, "too-few-points",
    ]  # fmt: skip
    assert results[3].place == (1.0, 1.0)


def test_many_bad_domains_beside_a_scribble():
    scribble = np.random.default_rng(0).normal(size=(2000, 2))
    results = clean_domains([[scribble], *[[SQUARE[[0, 2, 1, 3]]], [SQUARE]] * 50])
    assert [isinstance(r, ContourError) for r in results] == [True, *[True, False] * 50]


@pytest.mark.parametrize("polygon", [circle(20000), star(10000), comb(5000)], ids=["circle", "star", "comb"])
def test_large_contours(polygon):
    assert len(clean_loop(polygon)) == len(polygon)
    polygon = polygon.copy()
    polygon[777] = polygon[len(polygon) // 2] + [-1e-3, 2e-3]
    with pytest.raises(ContourError, match="crosses"):
        clean_loop(polygon)


def test_nesting_is_even_odd():
    rings = [SQUARE * s + (1 - s) / 2 for s in (1.0, 0.8, 0.6, 0.4)]
    loops = [rings[2], SQUARE + 5, rings[0], rings[3], rings[1], SQUARE * 0.1 + 5.2]
    result = nesting([clean_loop(p) for p in loops])
    assert result.outer.tolist() == [0, 1, 2]
    assert dict(zip(result.holes.tolist(), result.parent.tolist(), strict=True)) == {3: 0, 4: 2, 5: 1}
    assert nesting([SQUARE]).holes.tolist() == []
