"""Curve and text objects to polylines, as modifiers and animation leave them."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import bpy
import numpy as np

from ..tessera.contour import signed_area
from . import splines
from .errors import OutlineError
from .outline import Polyline
from .reading_mesh import borders

# Modifiers that Blender always applies to control points, whether or not "Apply on Spline" is set.
_ON_SPLINE = frozenset({"HOOK", "SOFT_BODY", "MESH_DEFORM"})


def read_curve(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[Polyline]:
    """One polyline a spline, at the resolution that Blender shows; a fill, extrusion or bevel is left out.

    Raises OutlineError "not-planar" where modifiers work on an extrusion or a bevel.

    After a modifier that works on what Blender makes of the curve, the borders of its faces are the outline.
    """
    with _control_points(evaluated, depsgraph) as curve:
        drawn = [_polyline(spline, number) for number, spline in enumerate(curve.splines, start=1)]
        if evaluated.type == "FONT":
            drawn = _legible(drawn, [spline.type == "POLY" for spline in curve.splines])
    if not _has_mesh_modifiers(evaluated):
        return drawn
    data = evaluated.data
    if data.extrude or data.bevel_depth or (data.bevel_mode == "OBJECT" and data.bevel_object is not None):
        message = (
            "Its modifiers work on what its extrusion or bevel makes, which has no outline. Set these to 0, or switch "
            "the modifiers off."
        )
        raise OutlineError("not-planar", message)
    mesh = evaluated.to_mesh()
    try:
        made = [] if mesh is None else borders(mesh)
    finally:
        evaluated.to_mesh_clear()
    if len(made) != len(drawn):
        return made
    # As many as there are splines: they are theirs, in the same order.
    return [
        Polyline(chain.points, chain.closed, spline.spline, spline.material, spline.smooth)
        for chain, spline in zip(made, drawn, strict=True)
    ]


def _legible(drawn: list[Polyline], underlines: list[bool]) -> list[Polyline]:
    """A text's polylines, without the single points that some fonts leave in their letters.

    Underlines run around as letters do: else what both cover would be wound around zero times.
    """
    areas = [signed_area(polyline.points[:, :2]) for polyline in drawn]
    way = sum(area for area, is_underline in zip(areas, underlines, strict=True) if not is_underline)
    return [
        replace(polyline, points=polyline.points[::-1]) if is_underline and area * way < 0 else polyline
        for polyline, area, is_underline in zip(drawn, areas, underlines, strict=True)
        if len(polyline.points) > 2
    ]


@contextmanager
def _control_points(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.Curve]:
    """The curve that modifiers on control points leave, or that a text is; nothing of it is left afterwards."""
    if evaluated.type == "CURVE" and evaluated.mode == "EDIT" and not evaluated.modifiers:
        yield evaluated.data  # the splines as they are being edited
        return
    try:
        yield evaluated.to_curve(depsgraph, apply_modifiers=True)
    finally:
        evaluated.to_curve_clear()


def _polyline(spline: bpy.types.Spline, number: int) -> Polyline:
    cyclic, resolution = spline.use_cyclic_u, max(spline.resolution_u, 1)
    if spline.type == "BEZIER":
        control = spline.bezier_points
        points, left, right = (_coordinates(control, name, 3) for name in ("co", "handle_left", "handle_right"))
        leaves, arrives = (
            np.array([getattr(point, name) == "VECTOR" for point in control], dtype=bool)
            for name in ("handle_right_type", "handle_left_type")
        )
        straight = leaves & np.roll(arrives, -1)
        points = splines.bezier(points, left, right, straight, cyclic, resolution)
    else:
        weighted = _coordinates(spline.points, "co", 4)
        points = weighted[:, :3]
        if spline.type == "NURBS":
            knots = spline.use_endpoint_u, spline.use_bezier_u
            points = splines.nurbs(points, weighted[:, 3], spline.order_u, cyclic, *knots, resolution)
    return Polyline(points, cyclic, number, spline.material_index, spline.use_smooth)


def _coordinates(points: bpy.types.bpy_prop_collection, name: str, width: int) -> np.ndarray:
    """(n, width) float64."""
    out = np.empty((len(points), width), dtype=np.float32)
    points.foreach_get(name, out.ravel())
    return out.astype(np.float64)


def _has_mesh_modifiers(evaluated: bpy.types.Object) -> bool:
    """Whether a modifier works on the tessellated curve, and not on control points."""
    modifiers = list(evaluated.modifiers)
    on_spline = [i for i, m in enumerate(modifiers) if m.use_apply_on_spline or m.type in _ON_SPLINE]
    after = modifiers[on_spline[-1] + 1 :] if on_spline else modifiers
    return any(modifier.show_viewport for modifier in after)
