"""Tessera: planar closed curves to even triangle meshes, by three small neural networks.

>>> import tessera
>>> mesh = tessera.mesh([[(0, 0), (4, 0), (4, 3), (0, 3)]], 0.5)
>>> mesh.report.q_worst > 0.5
True
"""

from .allocation import keep_freed_memory
from .errors import ContourError
from .mesh import Mesh, Report
from .meshing import mesh, mesh_contour, mesh_in_steps, mesh_many, mesh_regions
from .quality import element_quality
from .runtime import RuntimeProblem
from .sizing import by_curvature, by_distance, by_thickness, from_values, smallest
from .steps import Progress

__all__ = [
    "ContourError",
    "Mesh",
    "Progress",
    "Report",
    "RuntimeProblem",
    "by_curvature",
    "by_distance",
    "by_thickness",
    "element_quality",
    "from_values",
    "mesh",
    "mesh_contour",
    "mesh_in_steps",
    "mesh_many",
    "mesh_regions",
    "smallest",
]

keep_freed_memory()
