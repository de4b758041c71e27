"""Calculated connection tables lead the triangulation close to CDT (the paper: 1.9 and 1.5 %)."""

import numpy as np

from tessera.quality import element_quality
from tessera.triangulation import triangulate
from training import contours, meshing, reference, tables

# Numbers of edges, and target edge lengths at which few different numbers of inner vertices are likely.
GROUPS = ((6, 0.7), (8, 0.6), (10, 0.6))


def contours_with_reference_vertices(seed: int, each: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sector contours with Gmsh's inner vertices: points (B, V, 2), n_contour (B,), n_inner (B,)."""
    reference.start()
    rng = np.random.default_rng(seed)
    members = [
        (n, reference.mesh(contours.transformed_sector(rng, n), rng.uniform(0.9, 1.1) * l_s)[0])
        for n, l_s in GROUPS
        for _ in range(each)
    ]
    points = np.zeros((len(members), max(len(vertices) for _, vertices in members), 2))
    for row, (_, vertices) in zip(points, members, strict=True):
        row[: len(vertices)] = vertices
    return points, np.array([n for n, _ in members]), np.array([len(vertices) - n for n, vertices in members])


def delaunay_quality(vertices: np.ndarray, n_contour: int) -> tuple[float, float]:
    opposite = np.empty((len(vertices), len(vertices)), dtype=np.int64)
    assert meshing.delaunay(vertices, n_contour, len(vertices), opposite)
    return meshing.qualities(vertices, opposite, len(vertices))


def errors_against_cdt(points, n_contour, n_inner, result) -> np.ndarray:
    """(B, 2) ē_worst and ē_mean of each contour."""
    flat = result.triangles + result.owner[:, None] * points.shape[1]
    quality = element_quality(points.reshape(-1, 2), flat)
    worst = np.ones(len(points))
    np.minimum.at(worst, result.owner, quality)
    ours = np.column_stack([worst, np.bincount(result.owner, quality) / np.bincount(result.owner)])
    cdt = np.array([delaunay_quality(row[: n + m], n) for row, n, m in zip(points, n_contour, n_inner, strict=True)])
    return (cdt - ours) / cdt


def test_tables_of_no_numbers_lead_to_cdt():
    """What happens where the table leads nowhere is of good quality."""
    contours_and_vertices = contours_with_reference_vertices(seed=1001, each=60)
    result = triangulate(*contours_and_vertices, lambda *rest: np.full((len(rest[-1]), 2), np.nan))
    assert result.fallbacks.all()
    e_worst, e_mean = np.abs(errors_against_cdt(*contours_and_vertices, result)).mean(axis=0)
    assert e_worst < 1e-3 and e_mean < 1e-3


def test_calculated_tables_lead_close_to_cdt():
    points, n_contour, n_inner = contours_with_reference_vertices(seed=1000, each=450)

    def calculated(points, n_contour, n_inner, entries):
        return tables.connection_tables(points, n_contour, n_inner)[tuple(entries.T)]

    result = triangulate(points, n_contour, n_inner, calculated)
    assert not result.fallbacks.any()
    error = errors_against_cdt(points, n_contour, n_inner, result)
    checked = 0
    for group in np.unique(np.column_stack([n_contour, n_inner]), axis=0):
        rows = (n_contour == group[0]) & (n_inner == group[1])
        if rows.sum() >= 50:
            e_worst, e_mean = error[rows].mean(axis=0)
            assert e_worst <= 0.01 and e_mean <= 0.005, f"N_C, N_I = {group}: {e_worst:.4f}, {e_mean:.4f}"
            checked += rows.sum()
    assert checked >= 1000
