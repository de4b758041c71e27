"""The shipped networks against Gmsh on test contours, from seeds that training never uses.

``python -m training.evaluate`` (`make evaluate`) prints and writes ``docs/results/scheme.md`` and what it links to.
"""

from .meshers import qualities, reference_meshes
from .sets import held_out

__all__ = ["held_out", "qualities", "reference_meshes"]
