"""What an object has besides its geometry, given to another."""

from functools import cache

import bpy

# What is the other object's own, what follows from the rest, and what is copied by a way of its own.
_NOT_COPIED = frozenset(
    """
    rna_type name data type mode tag use_fake_user library asset_data override_library
    matrix_world matrix_local matrix_basis dimensions parent parent_type parent_bone parent_vertices
    active_material active_material_index active_shape_key_index show_only_shape_key use_simulation_cache
    instance_type instance_collection
    """.split()
)


def copy_object(source: bpy.types.Object, target: bpy.types.Object, everything: bool = False) -> None:
    """Give an object the source's transform, parent, constraints, display and custom properties.

    everything: also its animation, and what add-ons keep with an object.
    """
    target.rotation_mode = source.rotation_mode  # first, as a change of mode converts the rotation
    target.parent = source.parent
    for name in ("parent_type", "parent_bone", "parent_vertices"):
        setattr(target, name, getattr(source, name))
    copy_settings(source, target, everything)
    for constraint in source.constraints:
        target.constraints.copy(constraint)
    copy_custom_properties(source, target)
    if everything:
        _copy_animation(source, target)


def link_beside(source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Link to the source's collections; where none can be linked to (they are a library's), to the scene's own."""
    every = (*bpy.data.collections, *(scene.collection for scene in bpy.data.scenes))
    # Asking each for the name takes a tenth of `users_collection`, which lists all objects of each.
    own = [collection for collection in every if collection.objects.get(source.name) == source]
    editable = [collection for collection in own or source.users_collection if collection.library is None]
    for collection in editable or [bpy.context.scene.collection]:
        collection.objects.link(target)


def copy_settings(source: bpy.types.bpy_struct, target: bpy.types.bpy_struct, of_add_ons: bool = False) -> None:
    """Every setting of the source that can be set, except what is an object's own; both are of one type.

    of_add_ons: also those that Blender knows only while an add-on is on.
    """
    kind = source.bl_rna.identifier
    settings, groups = _blenders(kind)
    if of_add_ons:
        of_these, groups_of_these = _names(source.bl_rna, runtime=True)
        settings, groups = settings + of_these, groups + groups_of_these
    for name in settings:
        value = getattr(source, name)
        if value != getattr(target, name):
            setattr(target, name, value)
    for name in groups:
        inside = getattr(source, name), getattr(target, name)
        if None not in inside:
            copy_settings(*inside, of_add_ons)


@cache
def _blenders(kind: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The settings of Blender's own at a type, by its name; looking at them takes longer than copying them."""
    return _names(getattr(bpy.types, kind).bl_rna, runtime=False)


def _names(rna: bpy.types.Struct, runtime: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The settings that can be copied, and the groups of settings in which there are more."""
    own = [p for p in rna.properties if p.is_runtime == runtime and p.identifier not in _NOT_COPIED]
    groups = [p for p in own if p.type == "POINTER" and (p.is_readonly or runtime) and _is_group(p)]
    settings = [p for p in own if not p.is_readonly and p.type != "COLLECTION" and p not in groups]
    return tuple(p.identifier for p in settings), tuple(p.identifier for p in groups)


def _is_group(prop: bpy.types.PointerProperty) -> bool:
    """Whether a pointer is to settings that belong to the object, not to another object or the like."""
    if prop.is_runtime:
        return issubclass(getattr(bpy.types, prop.fixed_type.identifier, object), bpy.types.PropertyGroup)
    return prop.identifier in {"display", "field"}


def copy_custom_properties(source: bpy.types.ID, target: bpy.types.ID) -> None:
    """Custom properties, with their limits and tooltips; not what add-ons keep there."""
    for name, value in source.items():
        if name in source.bl_rna.properties:
            continue
        target[name] = value
        if isinstance(value, (int, float, str)) or getattr(value, "typecode", "") in ("i", "f", "d", "b"):
            target.id_properties_ui(name).update_from(source.id_properties_ui(name))


def _copy_animation(source: bpy.types.Object, target: bpy.types.Object) -> None:
    """Action, drivers and NLA strips."""
    if source.animation_data is None:
        return
    old, new = source.animation_data, target.animation_data_create()
    copy_settings(old, new)
    for driver in old.drivers:
        new.drivers.from_existing(src_driver=driver)
    for track in old.nla_tracks:
        made = new.nla_tracks.new()
        made.name = track.name
        for strip in track.strips:
            if strip.action is not None:
                other = made.strips.new(strip.name, int(strip.frame_start), strip.action)
                other.name = strip.name  # before Blender 4.4, the action's
                copy_settings(strip, other)
        copy_settings(track, made)
