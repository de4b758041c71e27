"""The settings of a mesh: one table, of which operators, linked meshes, preferences and the command line are made.

No `bpy` here: `properties.py` makes Blender's properties of the table, `options.py` the command line's options.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields

import numpy as np

# A length of 0 is chosen by the size of each object: so many edges along the longer side of its largest outline.
EDGES_ALONG = 25
# Of the target edge length, where a length at the boundary, under full weight or at an object is 0.
NEAR_SHARE = 0.25


@dataclass(frozen=True)
class Shown:
    """How one setting is shown. group: the part of the panel; applies: whether it has an effect, given all of them.

    choices: (identifier, label, description) each; low, high: bounds, soft_high: where a slider ends; unit: "length"
    (world units) or "angle" (degrees), else the number is plain; names: "object" or "weight", if it is the name of one;
    a library's object may be a pair of its name and the library's path. remembered: whether the next use of the
    operator starts with it.
    """

    label: str
    description: str
    group: str
    applies: Callable[[Settings], bool]
    choices: tuple[tuple[str, str, str], ...] = ()
    low: float = 0.0
    high: float = float("inf")
    soft_high: float | None = None
    unit: str = ""
    names: str = ""
    remembered: bool = True


def _always(_: Settings) -> bool:
    return True


def _setting(default, label, description, group, applies=_always, **more):
    return field(default=default, metadata={"shown": Shown(label, description, group, applies, **more)})


def _length(default, label, description, group, applies=_always, **more):
    return _setting(default, label, description, group, applies, unit="length", soft_high=1000.0, **more)


@dataclass(frozen=True)
class Settings:
    """Everything that a mesh depends on besides its curve; what `Shown` says of each is beside it.

    Choices are upper case words; lengths are in world units, and 0 where they are chosen; angles are in degrees.
    Numbers are as Blender's properties can hold them, so that panel, script and command make the same mesh.
    """

    size_by: str = _setting(
        "EDGE_LENGTH",
        "Size by",
        "What says how large triangles are",
        "size",
        choices=(
            ("EDGE_LENGTH", "Edge Length", "Triangles whose edges are about as long as this"),
            ("TRIANGLE_COUNT", "Triangle Count", "About so many triangles for each object, within 10 %"),
        ),
    )
    edge_length: float = _length(
        0.0,
        "Edge Length",
        "Target length of the triangles' edges, and the longest one where a sizing is chosen below, in world units. "
        "0: by the size of each object, 1/25 of the longer side of its largest outline",
        "size",
        lambda s: s.size_by == "EDGE_LENGTH",
        remembered=False,  # a length that suits one object rarely suits another
    )
    triangle_count: int = _setting(
        1000,
        "Triangles",
        "How many triangles each object's mesh should have; within 10 % where the outline allows it",
        "size",
        lambda s: s.size_by == "TRIANGLE_COUNT",
        low=1,
        high=5_000_000,
        soft_high=100_000,
    )
    use_curvature: bool = _setting(
        False, "By Curvature", "Smaller triangles where the outline is curved; corners have no curvature", "sizing"
    )
    curvature_ratio: float = _setting(
        0.3,
        "Edge / Radius",
        "Length of an edge as a share of the outline's radius of curvature: 0.3 makes about 21 edges of a circle",
        "sizing",
        lambda s: s.use_curvature,
        low=0.01,
        high=10.0,
        soft_high=2.0,
    )
    use_distance: bool = _setting(
        False, "By Boundary", "Smaller triangles along the outline, larger ones away from it", "sizing"
    )
    distance_length: float = _length(
        0.0,
        "At Boundary",
        "Length of edges at the outline, in world units. 0: a quarter of the target edge length",
        "sizing",
        lambda s: s.use_distance,
    )
    distance_reach: float = _length(
        0.0,
        "Reach",
        "Distance from the outline at which edges have their full length, in world units. 0: as soon as the gradation "
        "allows",
        "sizing",
        lambda s: s.use_distance,
    )
    use_thickness: bool = _setting(
        False, "By Thickness", "At least so many triangles across thin parts of the outline", "sizing"
    )
    thickness_elements: float = _setting(
        3.0,
        "Across",
        "How many triangles there are at least across thin parts",
        "sizing",
        lambda s: s.use_thickness,
        low=0.5,
        high=100.0,
        soft_high=10.0,
    )
    use_weight: bool = _setting(
        False, "By Weight", "Smaller triangles where a vertex group or attribute of the source is painted", "sizing"
    )
    weight_name: str = _setting(
        "",
        "Weights",
        "Name of the vertex group or of the float attribute: 0 is the full edge length, 1 is that under full weight",
        "sizing",
        lambda s: s.use_weight,
        names="weight",
    )
    weight_length: float = _length(
        0.0,
        "At Weight 1",
        "Length of edges under full weight, in world units. 0: a quarter of the target edge length",
        "sizing",
        lambda s: s.use_weight,
    )
    use_object: bool = _setting(
        False,
        "By Object",
        "Smaller triangles near an empty, a mesh, a curve or grease-pencil strokes",
        "sizing",
        remembered=False,
    )
    object_name: str | tuple[str, str] = _setting(
        "",
        "Object",
        "An empty, mesh, curve or grease-pencil object; what counts are its vertices, projected onto the outline's "
        "plane",
        "sizing",
        lambda s: s.use_object,
        names="object",
        remembered=False,
    )
    object_length: float = _length(
        0.0,
        "At Object",
        "Length of edges at the object, in world units. 0: a quarter of the target edge length",
        "sizing",
        lambda s: s.use_object,
    )
    object_reach: float = _length(
        0.0,
        "Reach",
        "Distance from the object at which edges have their full length, in world units. 0: as soon as the gradation "
        "allows",
        "sizing",
        lambda s: s.use_object,
    )
    min_edge_length: float = _length(
        0.0,
        "Shortest Edge",
        "No edge is asked to be shorter than this, in world units. 0: a hundredth of the target edge length, for what "
        "is found in the outline's shape",
        "limits",
        lambda s: graded(s),
        remembered=False,
    )
    gradation: float = _setting(
        1.3,
        "Gradation",
        "By what factor edges may be longer from one triangle to the next: small is gradual, large is quick",
        "limits",
        lambda s: graded(s),
        low=1.01,
        high=100.0,
        soft_high=3.0,
    )
    boundary: str = _setting(
        "RESAMPLE",
        "Boundary",
        "Which vertices the mesh has on the outline",
        "boundary",
        choices=(
            ("RESAMPLE", "Resample", "Vertices at the target edge length along the outline; corners are kept"),
            ("KEEP", "Keep", "Exactly the vertices of the outline at the curve's resolution, and no other"),
        ),
    )
    corner_angle: float = _setting(
        32.0,
        "Corner Angle",
        "A vertex of the outline that turns by more than this, in degrees, is a corner and stays",
        "boundary",
        lambda s: s.boundary == "RESAMPLE" or s.use_curvature,
        low=1.0,
        high=179.0,
        unit="angle",
    )
    passes: int = _setting(
        3,
        "Relaxation Passes",
        "How often the networks place every inner vertex anew: more is more even and takes longer, 0 is a draft",
        "finish",
        high=100,
        soft_high=10,
    )
    flips: bool = _setting(
        False, "Flip Edges", "Exchange edges where that betters the worse of two triangles", "finish"
    )
    smooth: int = _setting(
        0,
        "Smoothing Steps",
        "How often every inner vertex moves to better the poorest triangles around it; 3 steps do most of it",
        "finish",
        high=1000,
        soft_high=20,
    )
    result: str = _setting(
        "NEW",
        "Result",
        "What becomes of the meshes and of their sources",
        "result",
        choices=(
            ("NEW", "New Objects", "A mesh object beside each source, which stays as it is"),
            ("REPLACE", "In Place", "Each source becomes the mesh, as Object > Convert does"),
            ("JOIN", "One Joined Object", "One mesh object of all that is selected; the sources stay as they are"),
        ),
    )
    keep_linked: bool = _setting(
        False,
        "Keep Linked",
        "The mesh remembers its source and these settings: it can be meshed again from the sidebar, or at each change",
        "result",
        lambda s: s.result == "NEW",
    )

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, float):
                object.__setattr__(self, each.name, _as_kept(value, each.metadata["shown"].unit == "angle"))


def _as_kept(value: float, is_angle: bool) -> float:
    """The shortest decimal that Blender keeps as it keeps the value: in single precision, and an angle in radians."""

    def kept(number: float) -> float:
        return float(np.float32(math.radians(number) if is_angle else number))

    exact = math.degrees(kept(value)) if is_angle else kept(value)
    decimals = (float(f"{exact:.{digits}g}") for digits in range(1, 17))
    return next((decimal for decimal in decimals if kept(decimal) == kept(value)), exact)


def table() -> dict[str, Shown]:
    """How each setting is shown, by its name, in order."""
    return {each.name: each.metadata["shown"] for each in fields(Settings)}


def graded(settings: Settings) -> bool:
    """Whether any sizing is chosen, so that the wanted edge length is not the same everywhere."""
    return any(getattr(settings, f"use_{kind}") for kind in ("curvature", "distance", "thickness", "weight", "object"))
