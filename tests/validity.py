"""Is a mesh valid? Code of its own: it shares nothing with the library that it judges.

A mesh whose triangles are all counter-clockwise, whose edges are in one triangle or in two that run along them in
opposite directions, and whose edges in one triangle are exactly the edges of the domain's boundary, covers the domain
exactly once: the number of triangles over a point is the winding number of the boundary around it.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np


def exact_double_area(a, b, c) -> Fraction:
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(float(x)) for x in p] for p in (a, b, c))
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def signs_of_areas(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Exact signs of the areas of triangles a, b, c (..., 2), broadcast against each other."""
    a, b, c = np.broadcast_arrays(a, b, c)
    left = (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1])
    right = (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
    sign = np.sign(left - right).astype(int)
    # Any error is far below this share of the products, so only what lies under it needs fractions.
    for place in np.argwhere(~(np.abs(left - right) > 1e-14 * (np.abs(left) + np.abs(right)))):
        area = exact_double_area(*(p[tuple(place)] for p in (a, b, c)))
        sign[tuple(place)] = (area > 0) - (area < 0)
    return sign


def positive_areas(corners: np.ndarray) -> np.ndarray:
    """Which triangles (m, 3, 2) are counter-clockwise with an area above zero, exactly."""
    return signs_of_areas(*np.moveaxis(corners, 1, 0)) > 0


def polygon_area(loop: np.ndarray) -> float:
    x, y = (np.asarray(loop) - np.asarray(loop)[0]).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def boundary_edges(triangles: np.ndarray) -> np.ndarray:
    """The directed edges (k, 2) of one triangle only; asserts that all others are in two, once in each direction."""
    directed = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    base = int(triangles.max()) + 1
    key = directed[:, 0] * base + directed[:, 1]
    assert len(np.unique(key)) == len(key), "two triangles run along an edge in the same direction"
    return directed[~np.isin(key, directed[:, 1] * base + directed[:, 0])]


def check_mesh(vertices: np.ndarray, triangles: np.ndarray, loops, keep: bool = True) -> None:
    """Assert that the mesh covers the domain bounded by `loops` exactly once.

    vertices (n, 2), triangles (m, 3), loops: sequence of simple (k, 2) polygons in any winding. keep: the boundary is
    exactly the loops' edges; otherwise it is closed polygons of its own, with their vertices on the loops' edges.
    """
    vertices, triangles = np.asarray(vertices), np.asarray(triangles)
    loops = [without_repeats(np.asarray(loop, dtype=float)) for loop in loops]
    assert vertices.ndim == 2 and vertices.shape[1] == 2 and np.isfinite(vertices).all()
    assert triangles.ndim == 2 and triangles.shape[1] == 3 and len(triangles)
    assert triangles.min() >= 0 and triangles.max() < len(vertices), "triangle of a vertex that does not exist"
    assert len(np.unique(triangles)) == len(vertices), "vertex that no triangle uses"
    assert len(np.unique(vertices, axis=0)) == len(vertices), "two vertices in one place"
    assert positive_areas(vertices[triangles]).all(), "inverted or empty triangle"
    boundary = boundary_edges(triangles)
    n_edges = (3 * len(triangles) + len(boundary)) // 2
    cycles = boundary_cycles(boundary)
    assert len(cycles) == len(loops), f"{len(cycles)} boundary loops, not {len(loops)}"
    pieces = count_pieces(len(vertices), triangles)
    outer = sum(polygon_area(vertices[cycle]) > 0 for cycle in cycles)
    assert outer == pieces, "a piece of the mesh without one outer boundary"
    assert len(vertices) - n_edges + len(triangles) == pieces - (len(cycles) - outer), "Euler characteristic"
    domain = sum(polygon_area(vertices[cycle]) for cycle in cycles)
    if keep:
        assert {edge_key(*vertices[e]) for e in boundary} == loop_edges(loops), "boundary is not the contour's edges"
        # An outer loop is one that lies inside an even number of others.
        domain = sum(abs(polygon_area(p)) * (-1) ** depth(p, loops) for p in loops)
    else:
        on_the_loops(vertices[np.unique(boundary)], loops)
        for cycle in cycles:
            assert polygon_is_simple(vertices[cycle]), "the boundary crosses itself"
    corners = vertices[triangles]
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * float(np.sum(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]))
    # The sums' own rounding counts only for needles, whose area is tiny beside the square of their size.
    rounding = len(vertices) * np.finfo(float).eps * np.ptp(vertices, axis=0).max() ** 2
    assert abs(area - domain) <= 1e-9 * abs(domain) + rounding, f"triangles' area {area}, domain's {domain}"


def without_repeats(loop: np.ndarray) -> np.ndarray:
    return loop[np.any(loop != np.roll(loop, 1, axis=0), axis=1)]


def edge_key(a, b) -> frozenset:
    return frozenset([tuple(map(float, a)), tuple(map(float, b))])


def loop_edges(loops) -> set:
    return {edge_key(a, b) for loop in loops for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)}


def boundary_cycles(boundary: np.ndarray) -> list[np.ndarray]:
    """Directed boundary edges as closed vertex cycles; asserts that each vertex is left once and entered once."""
    following = {int(a): int(b) for a, b in boundary}
    assert len(following) == len(boundary) and set(following) == set(following.values()), "boundary touches itself"
    cycles = []
    while following:
        start = min(following)
        cycle = [start]
        while (vertex := following.pop(cycle[-1])) != start:
            cycle.append(vertex)
        cycles.append(np.array(cycle))
    return cycles


def count_pieces(n_vertices: int, triangles: np.ndarray) -> int:
    """Number of connected pieces of the mesh: every vertex takes the smallest number that it can reach."""
    label = np.arange(n_vertices)
    while True:
        smallest = label[triangles].min(axis=1)
        new = label.copy()
        np.minimum.at(new, triangles.ravel(), np.repeat(smallest, 3))
        new = new[new]
        if np.array_equal(new, label):
            return len(np.unique(label))
        label = new


def depth(loop: np.ndarray, loops) -> int:
    """How many of the other loops surround this one (they do not cross, so the middle of one edge decides)."""
    x, y = 0.5 * (loop[0] + loop[1])
    count = 0
    for other in loops:
        if other is not loop:
            (ax, ay), (bx, by) = other.T, np.roll(other, -1, axis=0).T
            spans = (ay > y) != (by > y)
            crossing = ax[spans] + (y - ay[spans]) / (by[spans] - ay[spans]) * (bx[spans] - ax[spans])
            count += int(np.sum(crossing > x)) % 2
    return count


def on_the_loops(points: np.ndarray, loops) -> None:
    """Assert that points (n, 2) lie on the loops' edges, to 1e-9 of the loops' size."""
    start = np.concatenate(loops)
    along = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops]) - start
    # Rounding of coordinates far from the origin is no fault of the mesh.
    tolerance = 1e-9 * np.ptp(start, axis=0).max() + 8 * np.spacing(np.abs(start).max())
    for block in np.array_split(points, 1 + len(points) * len(start) // 2_000_000):
        to_point = block[:, None] - start
        share = np.clip(np.sum(to_point * along, axis=-1) / np.sum(along**2, axis=-1), 0, 1)
        distance = np.linalg.norm(to_point - share[..., None] * along, axis=-1).min(axis=1)
        assert (distance <= tolerance).all(), "boundary vertex that is not on the contour"


def polygon_is_simple(loop: np.ndarray) -> bool:
    """Whether no two edges of the polygon (k, 2) meet but neighbours, at their common vertex."""
    a, b = np.asarray(loop, dtype=float), np.roll(loop, -1, axis=0)
    n = len(a)
    low, high = np.minimum(a, b), np.maximum(a, b)
    for first in range(0, n, 256):
        last = min(first + 256, n)
        meet = np.all((high[first:last, None] >= low) & (high >= low[first:last, None]), axis=-1)
        for i, j in zip(*np.nonzero(meet), strict=True):
            i += first
            if i < j and edges_conflict(a[i], b[i], a[j], b[j], (j - i) % n == 1, (i - j) % n == 1):
                return False
    return n >= 3


def edges_conflict(a, b, c, d, c_is_b: bool, d_is_a: bool) -> bool:
    """Whether edges ab and cd, with meeting boxes, meet where they should not (float signs, fractions when close)."""
    if c_is_b or d_is_a:
        if c_is_b and d_is_a:
            return True
        shared, x, y = (b, a, d) if c_is_b else (a, b, c)
        back = (x[0] - shared[0]) * (y[0] - shared[0]) + (x[1] - shared[1]) * (y[1] - shared[1])
        return back > 0 and side(shared, x, y) == 0
    return side(a, b, c) * side(a, b, d) <= 0 and side(c, d, a) * side(c, d, b) <= 0


def side(a, b, c) -> int:
    left, right = (b[0] - a[0]) * (c[1] - a[1]), (b[1] - a[1]) * (c[0] - a[0])
    area = left - right
    if abs(area) <= 1e-14 * (abs(left) + abs(right)):
        area = exact_double_area(a, b, c)
    return int(np.sign(area))


def check_many(
    points: np.ndarray, n_contour: np.ndarray, n_inner: np.ndarray, triangles: np.ndarray, owner: np.ndarray
) -> None:
    """Assert that every contour of a batch is covered exactly once by its triangles; without loops, for thousands.

    points (B, V, 2): each row its n_contour contour vertices, then its n_inner inner ones, then padding; triangles
    (t, 3) slots of the row owner (t,). The contours are simple and counter-clockwise.
    """
    n_rows, width = points.shape[:2]
    n_used = n_contour + n_inner
    assert (triangles >= 0).all() and (triangles < n_used[owner][:, None]).all(), "triangle of a missing vertex"
    assert positive_areas(points[owner[:, None], triangles]).all(), "inverted or empty triangle"
    flat = triangles.astype(np.int64) + (owner.astype(np.int64) * width)[:, None]
    assert len(np.unique(flat)) == n_used.sum(), "vertex that no triangle uses"
    boundary = boundary_edges(flat)
    row, slot = np.nonzero(np.arange(width) < n_contour[:, None])
    contour = np.column_stack([row * width + slot, row * width + (slot + 1) % n_contour[row]])
    assert np.array_equal(np.unique(boundary, axis=0), np.unique(contour, axis=0)), "not the contour's edges"
    # Euler characteristic 1: edges = (3 t + contour edges) / 2.
    count = np.bincount(owner, minlength=n_rows)
    assert np.array_equal(count, n_contour + 2 * n_inner - 2), "number of triangles"
    corners = points[owner[:, None], triangles] - points[owner, :1]
    (ax, ay), (bx, by), (cx, cy) = np.moveaxis(corners, 0, -1)
    covered = np.bincount(owner, 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)), minlength=n_rows)
    x, y = np.moveaxis(points - points[:, :1], -1, 0)
    nxt = np.where(np.arange(width) + 1 < n_contour[:, None], np.arange(width) + 1, 0)
    inside = np.arange(width) < n_contour[:, None]
    cross = x * np.take_along_axis(y, nxt, axis=1) - y * np.take_along_axis(x, nxt, axis=1)
    area = 0.5 * np.sum(np.where(inside, cross, 0.0), axis=1)
    # The sums' own rounding counts only for needles, whose area is tiny beside the square of their size.
    size = np.abs(np.where(inside[..., None], points - points[:, :1], 0)).max(axis=(1, 2))
    rounding = width * np.finfo(float).eps * size**2
    assert (np.abs(covered - area) <= 1e-9 * area + rounding).all(), "triangles' area is not the contour's"


def check_partition(vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Assert that triangles are counter-clockwise and meet in whole edges, and that no vertex is spare or double."""
    assert np.isfinite(vertices).all() and triangles.min() >= 0
    assert len(np.unique(triangles)) == len(vertices), "vertex that no triangle uses, or does not exist"
    assert len(np.unique(vertices, axis=0)) == len(vertices), "two vertices in one place"
    assert positive_areas(vertices[triangles]).all(), "inverted or empty triangle"
    boundary_edges(triangles)


def check_regions(vertices, triangles, region, regions, keep: bool = True, tolerance: float = 3e-6) -> None:
    """Assert that the triangles of each region cover the region's loops, exactly once.

    The triangles, each counter-clockwise, meet in whole edges, so those of a region cover what the region's outline
    goes around, as often as it does. That outline has its vertices on the loops; with `keep` it is as long as they are
    and lies on them, so it is the loops. regions: sequence of sequences of loops; tolerance: of places, as a share of
    the size of all.
    """
    check_partition(vertices, triangles)
    size = float(np.ptp(np.concatenate([loop for loops in regions for loop in loops]), axis=0).max())
    assert 0 <= region.min() and region.max() < len(regions)
    for number, loops in enumerate(regions):
        loops = [without_repeats(np.asarray(loop, dtype=float)) for loop in loops]
        own = triangles[region == number]
        assert len(own), f"region {number} has no triangle"
        outline = boundary_edges(own)
        near(vertices[np.unique(outline)], loops, tolerance * size)
        covered = sum(polygon_area(vertices[corners]) for corners in own)
        perimeter = sum(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).sum() for loop in loops)
        along = np.linalg.norm(vertices[outline[:, 0]] - vertices[outline[:, 1]], axis=1).sum()
        assert along <= perimeter * (1 + 1e-5) + tolerance * size * len(outline)
        if keep:
            wanted = sum(abs(polygon_area(loop)) * (-1) ** depth(loop, loops) for loop in loops)
            assert abs(covered - wanted) <= tolerance * size * perimeter, f"area of region {number}"
            near(vertices[outline].mean(axis=1), loops, tolerance * size)
            assert abs(along - perimeter) <= 1e-5 * perimeter + tolerance * size * len(outline)


def near(points: np.ndarray, loops, tolerance: float) -> None:
    """Assert that points (n, 2) are no farther from the loops' edges than the tolerance."""
    for point in points:
        assert min(distances(point, loop, np.roll(loop, -1, axis=0)).min() for loop in loops) <= tolerance


def distances(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(e,) how far a point (2,) is from edges from start to end (e, 2)."""
    along = end - start
    share = np.clip(np.sum((point - start) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-300), 0, 1)
    return np.linalg.norm(point - start - share[:, None] * along, axis=1)


def check_points(vertices: np.ndarray, points, tolerance: float = 0.0) -> None:
    """Assert that each of the points (k, 2) is a vertex."""
    for point in np.asarray(points, dtype=float).reshape(-1, 2):
        assert np.abs(vertices - point).max(axis=1).min() <= tolerance, f"{point} is no vertex"


def check_line(vertices: np.ndarray, triangles: np.ndarray, line, size: float, keep: bool = False) -> None:
    """Assert that edges of the mesh lead along a polyline (k, 2), from its start to its end, with vertices on it.

    size: of the domain; keep: all the line's vertices are the mesh's; otherwise the first and the last of an open one.
    """
    line = np.asarray(line, dtype=float)
    line = line[np.append(True, np.any(line[1:] != line[:-1], axis=1))]
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = {frozenset(pair) for pair in sides.tolist()}
    stops, passed, tolerance = [], 0.0, 3e-6 * size
    for a, b in pairwise(line):
        length = float(np.linalg.norm(b - a))
        share = np.clip((vertices - a) @ (b - a) / length**2, 0, 1)
        on = np.flatnonzero(np.linalg.norm(vertices - a - share[:, None] * (b - a), axis=1) <= tolerance)
        stops += [(passed + share[k] * length, int(k)) for k in on]
        passed += length
    stops.sort()
    path = [k for n, (_, k) in enumerate(stops) if n == 0 or k != stops[n - 1][1]]
    if np.array_equal(line[0], line[-1]):
        path += path[:1] if path[0] != path[-1] else []
    else:
        assert stops[0][0] <= tolerance and stops[-1][0] >= passed - tolerance, "a line's end is no vertex"
    assert len(path) > 1, "the line has no edge"
    assert all(frozenset(pair) in edges for pair in pairwise(path)), "the line is not of edges"
    if keep:
        check_points(vertices, line, tolerance)
