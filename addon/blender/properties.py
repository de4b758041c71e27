"""The settings as Blender's properties: for operators, linked meshes and preferences, from the one table."""

import math
from collections.abc import Callable, Container
from dataclasses import fields

import bpy

from .settings import Settings, Shown, table

# Numbers are shown with so many digits after the point.
_DIGITS = 4


def annotations(
    *, pointers: bool = False, update: Callable | None = None, without: Container[str] = ()
) -> dict[str, object]:
    """A property for each setting, to become the annotations of a class that is registered with Blender.

    pointers: objects are referred to by pointer, which follows a renaming, and which operators cannot hold. update: is
    called with the group and the context after each change. without: groups of settings that are left out.
    """
    shown = table()
    return {
        each.name: _property(each.default, shown[each.name], pointers, update)
        for each in fields(Settings)
        if shown[each.name].group not in without
    }


def read_settings(owner: bpy.types.bpy_struct) -> Settings:
    """The settings that an operator or a property group holds; those that it lacks have their defaults."""
    values = {}
    for name, shown in table().items():
        if name not in _known(owner):
            continue
        value = getattr(owner, name)
        if _is_pointer(owner, name):
            value = _named(value)
        values[name] = math.degrees(value) if shown.unit == "angle" else value
    return Settings(**values)


def write_settings(settings: Settings, owner: bpy.types.bpy_struct) -> None:
    """Set all properties of a property group that it has."""
    for name in table():
        if name in _known(owner):
            write_setting(settings, name, owner)


def start_with(settings: Settings, operator: bpy.types.Operator) -> None:
    """Set what neither a script, a preset nor, if it is to be remembered, the operator's last use says.

    (Blender's own SKIP_SAVE would keep what is not remembered out of presets, too.)
    """
    for name, shown in table().items():
        # A ghost is a value of the last use.
        if name in _known(operator) and not operator.properties.is_property_set(name, ghost=not shown.remembered):
            write_setting(settings, name, operator)


def write_setting(settings: Settings, name: str, owner: bpy.types.bpy_struct) -> None:
    """Set one property of an operator or a property group."""
    value = getattr(settings, name)
    if table()[name].unit == "angle":
        value = math.radians(value)
    setattr(owner, name, bpy.data.objects.get(value) if _is_pointer(owner, name) else value)


def _named(obj: bpy.types.Object | None) -> str | tuple[str, str]:
    """As `bpy.data.objects.get` takes it: a plain name is that of this file's own object, where there is one."""
    if obj is None:
        return ""
    return obj.name if obj.library is None else (obj.name, obj.library.filepath)


def _is_pointer(owner: bpy.types.bpy_struct, name: str) -> bool:
    return _known(owner)[name].type == "POINTER"


def _known(owner: bpy.types.bpy_struct):
    """What properties there are: an operator's are not its own, but those of its `properties`."""
    return getattr(owner, "properties", owner).bl_rna.properties


def _is_another(owner: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj != owner.id_data


def _property(default: bool | int | float | str, shown: Shown, pointers: bool, update: Callable | None):
    """One bpy.props definition."""
    common = {"name": shown.label, "description": shown.description, "update": update}
    if pointers and shown.names == "object":
        return bpy.props.PointerProperty(type=bpy.types.Object, poll=_is_another, **common)
    if isinstance(default, str):
        if shown.choices:
            return bpy.props.EnumProperty(items=shown.choices, default=default, **common)
        return bpy.props.StringProperty(default=default, **common)
    if isinstance(default, bool):
        return bpy.props.BoolProperty(default=default, **common)
    bounds = {"min": shown.low, "soft_min": shown.low}
    if shown.high < math.inf:
        bounds |= {"max": shown.high, "soft_max": shown.soft_high or shown.high}
    elif shown.soft_high:
        bounds["soft_max"] = shown.soft_high
    if isinstance(default, int):
        return bpy.props.IntProperty(default=default, **{name: int(bound) for name, bound in bounds.items()}, **common)
    if shown.unit == "angle":
        bounds = {name: math.radians(bound) for name, bound in bounds.items()}
        return bpy.props.FloatProperty(default=math.radians(default), subtype="ANGLE", **bounds, **common)
    kind = {"subtype": "DISTANCE", "precision": _DIGITS} if shown.unit == "length" else {"precision": 2}
    return bpy.props.FloatProperty(default=default, **kind, **bounds, **common)
