"""What a valid contour is: cleaning, orientation, simplicity, and which loop is a hole of which."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .crossings import MOST_PAIRS, crossing_pairs, crossing_place
from .errors import ContourError
from .predicates import orientation

# Points closer than this share of the loop's size are one point, and a loop thinner than it has no area.
TOLERANCE = 1e-12
# The squares of lengths, and products of them, must neither overflow nor vanish.
SMALLEST_SIZE, LARGEST_COORDINATE = 1e-100, 1e100
# Edges are at least so many times as long as what coordinates are rounded by, and contours four times as many.
_ROUNDINGS = 16


@dataclass(frozen=True)
class Nesting:
    """Loops by the even-odd rule: `outer` (o,) and `holes` (h,) by number, and each hole's `parent` (h,)."""

    outer: np.ndarray
    holes: np.ndarray
    parent: np.ndarray


def signed_area(points: np.ndarray) -> float:
    """Area of a polygon (k, 2), positive if counter-clockwise."""
    points = np.asarray(points, dtype=np.float64)
    x, y = (points - points[0]).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def neighbours(length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The vertex before and after each vertex, for loops of `length` (m,) one behind the other."""
    first = np.cumsum(length) - length
    before, after = np.arange(length.sum()) - 1, np.arange(length.sum()) + 1
    before[first], after[first + length - 1] = first + length - 1, first
    return before, after


def edges_of(loops: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The start and the end (n, 2) of every edge of polygons (k, 2), one polygon behind the other."""
    start = np.concatenate(loops)
    return start, start[neighbours(np.array([len(loop) for loop in loops]))[1]]


def clean_loop(points: ArrayLike) -> np.ndarray:
    """A closed loop of points (k, 2) as a simple counter-clockwise polygon (n, 2) float64 of the same points.

    Consecutive repeated points are dropped, collinear ones stay. Raises ContourError "not-finite", "too-few-points",
    "out-of-range", "zero-area" or "self-intersection"; ValueError if the shape is not (k, 2).
    """
    (result,) = clean_domains([[points]])
    if isinstance(result, ContourError):
        raise result
    return result[0]


def clean_domains(domains: Sequence[Sequence[ArrayLike]]) -> list[list[np.ndarray] | ContourError]:
    """`clean_loop` for every loop of every domain, all at once; loops of one domain must not meet either ("crossing").

    Gives for each domain its loops, or the error that it has.
    """
    results: list[list[np.ndarray] | ContourError] = []
    for loops in domains:
        try:
            results.append([without_repeats(points) for points in checked_curves(loops, "contour")])
        except ContourError as error:
            results.append(error)
    complete = False
    while not complete:
        errors, complete = _meeting_errors(results)
        results = [errors.get(i, result) for i, result in enumerate(results)]
    return [r if isinstance(r, ContourError) else [_counter_clockwise(p) for p in r] for r in results]


def _counter_clockwise(loop: np.ndarray) -> np.ndarray:
    # Exact, unlike the sum of the area: a simple polygon turns as it runs at its leftmost (then lowest) vertex.
    corner = np.lexsort((loop[:, 1], loop[:, 0]))[0]
    turn = orientation(loop[corner - 1], loop[corner], loop[(corner + 1) % len(loop)])
    return loop if turn > 0 else loop[::-1].copy()


def real_numbers(values: ArrayLike, name: str) -> np.ndarray:
    """A new float64 array of the values; raises ValueError where something else than real numbers is among them."""
    try:
        numbers = np.array(values)
        if numbers.dtype.kind in "biufO":
            return numbers.astype(np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} is an array of real numbers: {error}") from error
    raise ValueError(f"{name} is an array of real numbers, not of {numbers.dtype}")


def checked_points(points: ArrayLike, name: str = "a contour") -> np.ndarray:
    """Points (k, 2) as float64; raises ContourError "not-finite", or ValueError for what is no such array."""
    points = real_numbers(points, name)
    if points.size == 0:
        points = points.reshape(0, 2)
    if points.ndim != 2 or points.shape[1] != 2:
        message = f"{name} is an array of shape (k, 2), not {points.shape}"
        raise ValueError(message + ("; a domain is a sequence of contours" if points.shape == (2,) else ""))
    bad = np.nonzero(~np.isfinite(points).all(axis=1))[0]
    if len(bad):
        message = f"Point {bad[0]} of {name}, counted from 0, has a coordinate that is not a finite number. "
        raise ContourError("not-finite", message + "Remove the point or correct it.")
    return points


def without_repeats(points: np.ndarray) -> np.ndarray:
    """The points that are not at the place of the one before; raises if no polygon is left."""
    place = tuple(map(float, points[0])) if len(points) else None
    if len(points):
        size = float(np.ptp(points, axis=0).max())
        apart = np.abs(points - np.roll(points, 1, axis=0)).max(axis=1) > TOLERANCE * size
        # Of a closing point repeated at the end, the first point stays.
        if not apart[0] and apart.any():
            apart[0], apart[np.nonzero(apart)[0][-1]] = True, False
        points = points[apart]
    if len(np.unique(points, axis=0)) < 3:
        message = "The contour has fewer than three distinct points. Add points, so that it encloses an area."
        raise ContourError("too-few-points", message, place)
    if size < SMALLEST_SIZE or np.abs(points).max() > LARGEST_COORDINATE:
        message = (
            f"The contour is {size:.3g} long, and its largest coordinate is {np.abs(points).max():.3g}: more than "
        )
        message += f"{SMALLEST_SIZE:g} and less than {LARGEST_COORDINATE:g} can be computed with. Scale it."
        raise ContourError("out-of-range", message, place)
    relative = (points - points[0]) / size
    far = relative[np.argmax(np.sum(relative**2, axis=1))]
    across = relative[:, 0] * far[1] - relative[:, 1] * far[0]
    if np.abs(across).max() <= TOLERANCE * np.linalg.norm(far):
        message = "All points of the contour lie on one line, so it encloses no area. Move some of them off the line."
        raise ContourError("zero-area", message, place)
    return points


def checked_curves(curves: Sequence[ArrayLike], kind: str) -> list[np.ndarray]:
    """`checked_points` of each of some curves of a kind; what is wrong with one of several names it by its number."""
    curves = list(curves)
    names = [f"{kind} {number}" for number in range(len(curves))] if len(curves) > 1 else [f"a {kind}"]
    return [checked_points(*one) for one in zip(curves, names, strict=False)]


def lost_in_rounding(loops: Sequence[np.ndarray], edge_length: float) -> ContourError | None:
    """The error "out-of-range" of loops (k, 2) too far from the origin for edges of a length, or for themselves."""
    points = np.concatenate(loops)
    x, y = map(float, points[np.abs(points).max(axis=1).argmax()])
    rounding = float(np.spacing(max(abs(x), abs(y))))
    smallest = min(float(np.ptp(loop, axis=0).max()) for loop in loops)
    if min(edge_length, smallest / 4) >= _ROUNDINGS * rounding:
        return None
    message = (
        f"Coordinates are rounded by {rounding:.2g} at ({x:.9g}, {y:.9g}), which is too much for a contour of the size "
        f"{smallest:.3g} or an edge length of {edge_length:.3g}. Move the curve nearer to the origin."
    )
    return ContourError("out-of-range", message, (x, y))


def _meeting_errors(results: list) -> tuple[dict[int, ContourError], bool]:
    """Errors of the domains whose edges meet, by domain, and whether these are all there are."""
    valid = [(i, loop) for i, result in enumerate(results) if isinstance(result, list) for loop in result]
    if not valid:
        return {}, True
    length = np.array([len(loop) for _, loop in valid])
    domain = np.repeat([i for i, _ in valid], length)
    loop = np.repeat(np.arange(len(valid)), length)
    start = np.concatenate([p for _, p in valid])
    end = start[neighbours(length)[1]]
    errors: dict[int, ContourError] = {}
    pairs = crossing_pairs(start, end, domain)
    for first, second in pairs[np.unique(domain[pairs[:, 0]], return_index=True)[1]]:
        place = crossing_place(start, end, np.array([first, second]))
        errors[int(domain[first])] = meeting_error(loop[first] == loop[second], place)
    for first, second in _repeated_points(start, domain):
        same = loop[first] == loop[second]
        errors.setdefault(int(domain[first]), meeting_error(same, (float(start[first, 0]), float(start[first, 1]))))
    return errors, len(pairs) <= MOST_PAIRS


def _repeated_points(points: np.ndarray, domain: np.ndarray) -> np.ndarray:
    """Pairs (k, 2) of points of one domain in the same place: one that edges meet in without crossing."""
    order = np.lexsort((points[:, 1], points[:, 0], domain))
    one, other = order[:-1], order[1:]
    same = np.all(points[one] == points[other], axis=1) & (domain[one] == domain[other])
    return np.column_stack([one, other])[same]


def meeting_error(same_loop: bool, place: tuple[float, float]) -> ContourError:
    """The error of a contour that meets itself, "self-intersection", or of two that meet, "crossing"."""
    where = f"near ({place[0]:.9g}, {place[1]:.9g})"
    if same_loop:
        message = f"The contour crosses or touches itself {where}. Move points there to keep its edges apart."
        return ContourError("self-intersection", message, place)
    message = f"Two contours cross or touch each other {where}. Move them apart, or join them into one contour."
    return ContourError("crossing", message, place)


def nesting(loops: Sequence[np.ndarray]) -> Nesting:
    """Which of the cleaned loops (k, 2) of one domain, that do not meet, are outer contours and which are holes."""
    n = len(loops)
    low, high = (np.array([extreme(p, axis=0) for p in loops]).reshape(n, 2) for extreme in (np.min, np.max))
    order, begin, end = starting_between(low[:, 0], low[:, 0], high[:, 0])
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    for i, loop in enumerate(loops):
        near = order[begin[i] : end[i]]
        near = near[np.all((low[i] < low[near]) & (high[near] < high[i]), axis=1)]
        if len(near):
            near = near[points_inside(np.array([loops[j][0] for j in near]), loop)]
            pairs.append(np.column_stack([near, np.full(len(near), i)]))
    inner, outer = np.concatenate(pairs).T
    depth = np.bincount(inner, minlength=n)
    # The loop directly around another is the one around it that itself lies deepest: the last to be written.
    parent, last = np.full(n, -1), np.argsort(depth[outer], kind="stable")
    parent[inner[last]] = outer[last]
    holes = np.flatnonzero(depth % 2 == 1)
    return Nesting(np.flatnonzero(depth % 2 == 0), holes, parent[holes])


def starting_between(values: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, ...]:
    """The order of values (n,), and from where to where (k,) in it those from low to high (k,) are.

    So that what lies in a box need not be looked for among all.
    """
    order = np.argsort(values, kind="stable")
    return order, np.searchsorted(values[order], low), np.searchsorted(values[order], high, side="right")


def points_inside(points: np.ndarray, loop: np.ndarray) -> np.ndarray:
    """Whether points (n, 2), none of them on the polygon (k, 2), lie inside it; exact -> (n,) bool."""
    start, end = loop, np.roll(loop, -1, axis=0)
    inside = np.zeros(len(points), dtype=bool)
    for rows in np.array_split(np.arange(len(points)), 1 + len(points) * len(loop) // 1_000_000):
        height = points[rows, None, 1]
        point, edge = np.nonzero((start[:, 1] > height) != (end[:, 1] > height))
        rising = np.where(end[edge, 1] > start[edge, 1], 1, -1)
        to_the_right = orientation(start[edge], end[edge], points[rows[point]]) == rising
        inside[rows] = np.bincount(point, to_the_right, minlength=len(rows)).astype(int) % 2 == 1
    return inside
