"""Table 2, Figs. 28 to 30: ``python -m training.paper.domains``. A circle, an airfoil and a plate with a hole.

By the shipped networks alone: domains are divided into sub-contours of 3 to 16 edges, and the paper's networks know
even numbers of random contours only. The paper does not give its contours; these are the benchmark's
(``benchmarks/domains/cases.py``), which are like its figures.
"""

from __future__ import annotations

import numpy as np

import tessera
from benchmarks.domains.cases import paper_cases, target_of
from benchmarks.domains.measures import measure
from benchmarks.domains.meshers import Meshed

from . import settings
from .comparing import write


def main() -> None:
    """Mesh, and keep what was found."""
    config, _ = settings.from_command_line(__doc__)
    mesh_all(config)


def mesh_all(config: dict) -> None:
    """Qualities of the three meshes, and the meshes themselves for the picture.

    q_left_out: of the element in the airfoil's sharp tail, which q_worst leaves out; None where none is left out.
    """
    found, arrays = [], {}
    for case in paper_cases():
        mesh = tessera.mesh(case.loops, case.edge_length, **case.options)
        of = measure(Meshed(mesh.vertices, mesh.triangles, 0.0), target_of(case), case.left_out)
        row = {"name": case.name, "paper": case.paper, "q_worst": of.q_worst, "q_mean": of.q_mean}
        row["q_left_out"] = None if case.left_out is None else of.q_left_out
        found.append(row | {"triangles": of.triangles})
        arrays |= {f"{case.name} vertices": mesh.vertices, f"{case.name} triangles": mesh.triangles}
        print(f"{case.name}: ({of.q_worst:.2f}, {of.q_mean:.2f}), {of.triangles} triangles", flush=True)
    write(config, "domains", found)
    np.savez(config["folders"]["results"] / "domains.npz", **arrays)


if __name__ == "__main__":
    main()
