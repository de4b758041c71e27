"""An object as modifiers, parents and animation leave it, also where its view layer has it switched off."""

import bpy
import numpy as np

from .errors import OutlineError
from .kinds import shows_collection


def evaluated_object(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[bpy.types.Object, np.ndarray]:
    """The evaluated object, and its world matrix (4, 4) float64.

    Blender does not evaluate what is switched off in the view layer, as by Exclude or Disable in Viewports (what is
    hidden by the eye, it does): such an object is as it stands, unless something else has a say in that. Raises
    OutlineError "not-evaluated" then, and "not-finite" for a transform that is no number.
    """
    evaluated = obj.evaluated_get(depsgraph)
    # What is referred to is evaluated wherever it is, but for its modifiers.
    left_out = _is_modified(obj) if evaluated.is_evaluated else _depends(obj)
    if left_out and _is_off(obj, depsgraph.view_layer):
        message = (
            "It is switched off in this view layer, so that Blender does not evaluate its modifiers, parent or "
            "animation. Switch it and its collection on, and hide it by the eye (H) instead."
        )
        raise OutlineError("not-evaluated", message)
    # The world matrix of what is not evaluated may be out of date.
    world = np.array(evaluated.matrix_world if evaluated.is_evaluated else obj.matrix_basis, dtype=np.float64)
    if not np.isfinite(world).all():
        raise OutlineError("not-finite", "Its transform has a number that is not finite. Correct it.")
    return evaluated, world


def _is_off(obj: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> bool:
    """Whether an object is not in the view layer, or switched off there, itself or with all its collections."""
    if obj.visible_get(view_layer=view_layer):
        return False
    waiting = [] if obj.hide_viewport else [view_layer.layer_collection]
    while waiting:
        layer = waiting.pop()
        if layer.collection.hide_viewport:
            continue
        if not layer.exclude and layer.collection.objects.get(obj.name) == obj:
            return False
        waiting += layer.children
    return True


def _is_modified(obj: bpy.types.Object) -> bool:
    return any(modifier.show_viewport for modifier in obj.modifiers)


def _depends(obj: bpy.types.Object) -> bool:
    """Whether more than the object's own data and transform says what it looks like."""
    data = obj.data
    return (
        obj.parent is not None
        or shows_collection(obj)
        or len(obj.constraints) > 0
        or _is_modified(obj)
        or any(getattr(one, "animation_data", None) is not None for one in (obj, data))
        or any(getattr(data, name, None) is not None for name in ("shape_keys", "follow_curve"))
    )
