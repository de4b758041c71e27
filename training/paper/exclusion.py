"""The radius of exclusion (section 3.2.2): ``python -m training.paper.exclusion``. What it costs, on training meshes.

The paper excludes grid points closer to a chosen vertex than 0.1 l_s, which is less than the grid's spacing.
"""

from __future__ import annotations

import numpy as np

from tessera import paper
from tessera.cavity import even_lengths
from tessera.paper_placement import decode
from tessera.scheme import join_vertices
from tessera.stopwatch import Stopwatch

from ..evaluate.meshers import by_delaunay
from . import settings
from .comparing import as_contours, errors, mean_errors, write
from .data import load
from .train import chosen

MESHES = 300  # of a group
RADII = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8)  # in even edge lengths


def main() -> None:
    """Compare, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    compare_radii(config)


def compare_radii(config: dict) -> None:
    """ē_worst of NN2 alone by radius, for every second of its groups of several vertices."""
    folder, found = config["folders"]["models"], []
    for n in config["data"]["train"]:
        for m in [m for m in config["nn2"]["groups"][n] if m > 1 and m % 2 == 0]:
            group = chosen(load(config, "train", n).group(m), MESHES)
            if not (len(group) and paper.is_trained("nn2", (n, m), folder)):
                continue
            contours, wanted = as_contours(group.contour, group.l_s), np.full(len(group), m)
            scores = paper.score(folder, contours.points, contours.n_contour, wanted, group.l_s, Stopwatch())
            even = even_lengths(contours.points, contours.n_contour, wanted)
            for radius in (None, *RADII):
                exclusion = 0.1 * group.l_s if radius is None else radius * even
                placed = decode(scores, contours.points, contours.n_contour, wanted, group.l_s, exclusion)
                points = join_vertices(contours.points, contours.n_contour, *placed)
                error = errors(by_delaunay(contours, points, placed[1]), contours, group.quality)
                found.append({"n": n, "m": m, "radius": radius, **mean_errors(error)})
        print(f"N_C {n}", flush=True)
    write(config, "exclusion", found)


if __name__ == "__main__":
    main()
