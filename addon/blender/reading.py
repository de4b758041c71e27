"""From a curve or text object, as modifiers and animation leave it, to planar loops."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ..tessera.errors import ContourError
from .outline import outline_edges, polylines
from .plane import Plane, fit_plane

# Modifiers that Blender always applies to control points, whether or not "Apply on Spline" is set.
_ON_SPLINE = frozenset({"HOOK", "SOFT_BODY", "MESH_DEFORM"})

_NOTHING = "There is no outline in it. Draw or type something first."


@dataclass(frozen=True)
class Outline:
    """loops: (k, 2) float64 each, in the plane and in world units, none repeating its first point."""

    loops: tuple[np.ndarray, ...]
    plane: Plane

    @property
    def size(self) -> float:
        """The longer side of the bounding box of the largest loop, in world units."""
        return max(float(np.ptp(loop, axis=0).max()) for loop in self.loops)


def read_outline(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Outline:
    """The closed polylines of an object, at the resolution that Blender shows.

    A fill, extrusion or bevel is left out: the outline is what is meshed, holes and islands by the even-odd rule as in
    Blender's own fill, but of splines of all materials together. Raises ContourError: "open", "not-planar",
    "too-few-points", "zero-area", "not-finite".
    """
    evaluated = obj.evaluated_get(depsgraph)
    with _wire(evaluated, depsgraph) as mesh:
        if mesh is None:  # what Blender makes of an empty text
            raise ContourError("too-few-points", _NOTHING)
        points = np.empty((len(mesh.vertices), 3), dtype=np.float32)
        edges = np.empty((len(mesh.edges), 2), dtype=np.int32)
        face_edges = np.empty(len(mesh.loops), dtype=np.int32)
        mesh.vertices.foreach_get("co", points.ravel())
        mesh.edges.foreach_get("vertices", edges.ravel())
        mesh.loops.foreach_get("edge_index", face_edges)
    points = points.astype(np.float64)
    chains = _closed_chains(points, _chains(len(points), edges, face_edges))
    used = np.concatenate([points[chain] for chain in chains])
    plane = fit_plane(used, np.array(evaluated.matrix_world.to_3x3(), dtype=np.float64))
    return Outline(tuple(plane.flatten(points[chain]) for chain in chains), plane)


def _chains(n_points: int, edges: np.ndarray, face_edges: np.ndarray) -> list[tuple[np.ndarray, bool]]:
    """Chains of the edges that bound something; vertices inside a face are no chain."""
    bounding = outline_edges(edges, face_edges)
    chains = polylines(n_points, bounding)
    if len(face_edges):
        chains = [(chain, closed) for chain, closed in chains if len(chain) > 1]
    return chains


def _closed_chains(points: np.ndarray, chains: list[tuple[np.ndarray, bool]]) -> list[np.ndarray]:
    """Every chain closed, or a ContourError that counts splines as Blender lists them, from 1."""
    if not chains:
        raise ContourError("too-few-points", _NOTHING)
    tolerance = 1e-6 * float(np.ptp(points, axis=0).max())
    closed_chains = []
    for number, (chain, closed) in enumerate(chains, start=1):
        if len(chain) < 3:
            count = "1 point" if len(chain) == 1 else f"{len(chain)} points"
            raise ContourError(
                "too-few-points",
                f"Spline {number} has {count}, and an outline needs at least 3. Add points, or delete it.",
            )
        if not closed:
            first, last = points[chain[0]], points[chain[-1]]
            if np.abs(first - last).max() > tolerance:
                raise ContourError(
                    "open",
                    f"Spline {number} is open. Close it in Edit Mode, with Curve > Toggle Cyclic.",
                    place=(float(first[0]), float(first[1])),
                )
            chain = chain[:-1]
        closed_chains.append(chain)
    return closed_chains


@contextmanager
def _wire(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.Mesh | None]:
    """A temporary mesh of the outline's edges; nothing of it is left afterwards."""
    if _has_mesh_modifiers(evaluated):
        # These work on what Blender tessellates, fill included; the borders of the faces are the outline then.
        mesh = evaluated.to_mesh()
        try:
            yield mesh
        finally:
            evaluated.to_mesh_clear()
        return
    curve = evaluated.to_curve(depsgraph, apply_modifiers=True).copy()
    evaluated.to_curve_clear()
    curve.dimensions = "3D"
    curve.extrude = curve.bevel_depth = 0.0
    curve.bevel_mode = "ROUND"
    curve.bevel_object = None
    holder = bpy.data.objects.new(curve.name, curve)
    try:
        yield holder.to_mesh()
    finally:
        holder.to_mesh_clear()
        bpy.data.objects.remove(holder)
        bpy.data.curves.remove(curve)


def _has_mesh_modifiers(evaluated: bpy.types.Object) -> bool:
    """Whether a modifier works on the tessellated curve, and not on control points."""
    modifiers = list(evaluated.modifiers)
    on_spline = [i for i, m in enumerate(modifiers) if m.use_apply_on_spline or m.type in _ON_SPLINE]
    after = modifiers[on_spline[-1] + 1 :] if on_spline else modifiers
    return any(modifier.show_viewport for modifier in after)
