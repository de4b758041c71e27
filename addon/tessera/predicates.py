"""Exact geometric predicates: the sign is right for every finite input that neither overflows nor underflows."""

import numpy as np

# With u = 2^-53, the four differences and the two products of the determinant each have a relative error of at most u,
# so each product is off by at most (1 + u)^3 - 1 of itself and the final subtraction adds u of the result. Shewchuk
# (Adaptive Precision Floating-Point Arithmetic, 1997, section 4) sums this to (3 + 16 u) u of |left| + |right|, the
# rounding of the differences and of the bound itself included: if |det| is above that, its sign is right.
_UNIT = 2.0**-53
_ERROR_BOUND = (3.0 + 16.0 * _UNIT) * _UNIT
# Below this the products may have lost bits to underflow, which the bound does not know of.
_UNDERFLOW = 1e-280
_UNKNOWN = 2


def orientation(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Exact sign of the signed area of triangles (a, b, c): +1 counter-clockwise, 0 collinear, -1 clockwise.

    a, b, c: (..., 2) float64, broadcast against each other -> (...) int8.
    """
    a, b, c = (np.asarray(p, dtype=np.float64) for p in (a, b, c))
    acx, acy = a[..., 0] - c[..., 0], a[..., 1] - c[..., 1]
    bcx, bcy = b[..., 0] - c[..., 0], b[..., 1] - c[..., 1]
    left, right = acx * bcy, acy * bcx
    determinant = left - right
    total = np.abs(left) + np.abs(right)
    sign = np.asarray(np.sign(determinant), dtype=np.int8)
    unsure = np.asarray(~((np.abs(determinant) > _ERROR_BOUND * total) & (total > _UNDERFLOW)))
    # A difference of floats is zero only if it is exactly zero, so products of such factors are exact: axis-parallel
    # collinear points, the commonest degenerate case, end here.
    unsure &= ~(((acx == 0) | (bcy == 0)) & ((acy == 0) | (bcx == 0)))
    if not np.any(unsure):
        return sign
    shape = unsure.shape + (2,)
    corners = np.stack([np.broadcast_to(p, shape)[unsure] for p in (a, b, c)], axis=1)
    close = _close_orientation(corners)
    left_open = close == _UNKNOWN
    close[left_open] = _exact_orientation(corners[left_open])
    sign[unsure] = close
    return sign


def _close_orientation(corners: np.ndarray) -> np.ndarray:
    """Sign of the area of triangles (k, 3, 2), whose float64 determinant is too small, or `_UNKNOWN` -> (k,) int8.

    With the errors of differences and products, which are float64 numbers themselves (Shewchuk, section 2), the
    determinant is known to twice as many bits, up to the errors of its smallest terms.
    """
    a, b, c = corners.transpose(1, 2, 0)
    (acx, acy), (acx_error, acy_error) = _difference(a, c)
    (bcx, bcy), (bcx_error, bcy_error) = _difference(b, c)
    left, left_error = _product(acx, bcy)
    right, right_error = _product(acy, bcx)
    products = np.stack([acx * bcy_error, acx_error * bcy, -acy * bcx_error, -acy_error * bcx])
    error = left_error - right_error
    # left - right is exact, as they are nearly equal.
    total = (left - right) + (error + products.sum(axis=0))
    small = np.abs(error) + np.abs(products).sum(axis=0)
    size = np.abs(left) + np.abs(right)
    # Rounded are the sums, by less than 2^-50 of the small terms, and left out are products of two errors.
    sure = np.abs(total) > 2.0**-50 * small + 2.0**-100 * size
    exact = (acx_error == 0) & (acy_error == 0) & (bcx_error == 0) & (bcy_error == 0)
    sure |= exact & (left == right) & (left_error == right_error)
    return np.where(sure & (size > _UNDERFLOW), np.sign(total), _UNKNOWN).astype(np.int8)


def _difference(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """a - b rounded, and what it is off by."""
    difference = a - b
    of_b = a - difference
    return difference, (a - (difference + of_b)) + (of_b - b)


def _product(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """a b rounded, and what it is off by."""
    product = a * b
    (a_high, a_low), (b_high, b_low) = _halves(a), _halves(b)
    return product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)


def _halves(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sum of two numbers of half as many bits."""
    scaled = a * (2.0**27 + 1)
    high = scaled - (scaled - a)
    return high, a - high


def _exact_orientation(corners: np.ndarray) -> np.ndarray:
    """Sign of the area of triangles (k, 3, 2), by python integers -> (k,) int8."""
    mantissa, exponent = np.frexp(corners)
    mantissa = np.ldexp(mantissa, 53).astype(np.int64).astype(object)
    # The zero coordinate has exponent 0, which only makes the shifts longer.
    shift = (exponent - exponent.min(axis=(1, 2), keepdims=True)).astype(object)
    integer = mantissa << shift
    a, b, c = integer[:, 0], integer[:, 1], integer[:, 2]
    determinant = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1]) - (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    return (determinant > 0).astype(np.int8) - (determinant < 0).astype(np.int8)


def segments_cross(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Whether segments ab and cd have a point in common other than a shared, identical end point; exact.

    a, b, c, d: (..., 2) float64, broadcast against each other, a != b -> (...) bool. Touching (an end of one on the
    other) and overlapping count, and so does the same segment twice. c = d is a point, which counts where it lies on ab
    between its ends.
    """
    a, b, c, d = np.broadcast_arrays(*(np.asarray(p, dtype=np.float64) for p in (a, b, c, d)))
    boxes_meet = np.all((np.maximum(a, b) >= np.minimum(c, d)) & (np.maximum(c, d) >= np.minimum(a, b)), axis=-1)
    boxes_meet = np.asarray(boxes_meet)
    result = np.zeros(boxes_meet.shape, dtype=bool)
    if boxes_meet.any():
        result[boxes_meet] = _meeting_boxes_cross(*(p[boxes_meet] for p in (a, b, c, d)))
    return result


def _meeting_boxes_cross(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> np.ndarray:
    """`segments_cross` for segments (k, 2) whose bounding boxes meet."""
    sides_ab = orientation(a, b, c) * orientation(a, b, d)
    sides_cd = orientation(c, d, a) * orientation(c, d, b)
    # Collinear segments have all signs zero, and then meet exactly where their boxes do.
    meet = (sides_ab <= 0) & (sides_cd <= 0)
    # Sharing an end, they meet elsewhere only if the other ends lie on one line on the same side of it.
    pairs = ((a, b, c, d), (a, b, d, c), (b, a, c, d), (b, a, d, c))
    shared = [np.all(p == q, axis=-1) for p, _, q, _ in pairs]
    for same, (p, p_end, _, q_end) in zip(shared, pairs, strict=True):
        rows = np.nonzero(same & meet)[0]
        if len(rows):
            start, x, y = p[rows], p_end[rows], q_end[rows]
            same_side = np.all(np.sign(x - start) == np.sign(y - start), axis=-1)
            meet[rows] = same_side & (orientation(start, x, y) == 0)
    return meet
