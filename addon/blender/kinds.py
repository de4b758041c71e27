"""Which objects can be read; apart from the reading itself, so that menus need not load the mesher."""

import bpy

# Those whose strokes are in drawings of attributes: not the Grease Pencil of Blender 4.2, which is GPENCIL.
STROKES = frozenset({"CURVES", "GREASEPENCIL"})
READABLE = frozenset({"CURVE", "FONT", "CURVES", "GREASEPENCIL", "GPENCIL", "MESH"})


def is_readable(obj: bpy.types.Object) -> bool:
    """Whether the object may have outlines: it is of a readable kind, or an empty that shows a collection."""
    return obj.type in READABLE or shows_collection(obj)


def shows_collection(obj: bpy.types.Object) -> bool:
    """Whether the object is a collection's instance."""
    return obj.instance_type == "COLLECTION" and obj.instance_collection is not None
