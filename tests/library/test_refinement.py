"""Refinement of meshes as they can come out of a division: flat elements, far from the origin."""

import numpy as np

from tessera.refinement import refine
from tessera.steps import finish
from tessera.stopwatch import Stopwatch
from tests.validity import check_partition


def test_flat_elements_far_from_the_origin_are_not_split_into_ones_that_rounding_turns_over():
    """A billion away, coordinates are rounded to 1e-7: the elements' parts would be as flat as that."""
    angles, heights = (grid.ravel() for grid in np.meshgrid(np.arange(0.1, 1.5, 0.074), [2e-5, 1e-4]))
    x, y = (np.tile(values, (len(angles), 1)) for values in ([0, 0.43, 1, 0.5], [0, 0, 0, 0.4]))
    y[:, 1] = -heights
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    vertices = np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1) + 1e9
    domain = np.repeat(np.arange(len(angles)), 2)
    triangles = np.tile([(0, 1, 2), (0, 2, 3)], (len(angles), 1)) + 4 * domain[:, None]
    vertices = vertices.reshape(-1, 2)
    refined = finish(refine(vertices, triangles, domain, lambda points, _: np.full(len(points), 0.1), Stopwatch()))
    for number in range(len(angles)):
        used, local = np.unique(refined.triangles[domain[refined.parent] == number], return_inverse=True)
        check_partition(refined.vertices[used], local.reshape(-1, 3))
