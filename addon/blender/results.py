"""From what was meshed to objects in the scene, as the settings say."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from .linked import is_linked, link, mark_as_current, remember_quality, unlink
from .preferences import collection_name
from .writing import write_again, write_in_place, write_joined, write_mesh

if TYPE_CHECKING:
    from .meshing import Meshed


def write_results(made: list[Meshed]) -> list[bpy.types.Object]:
    """Make the objects, all by the settings of the first; none of them is selected. `made` has one at least."""
    settings = made[0].task.settings
    if settings.result == "JOIN":
        objects = [write_joined([(meshed.task.obj, list(meshed.pieces)) for meshed in made])]
        remember_quality(objects[0], made)
    else:
        write = write_in_place if settings.result == "REPLACE" else write_mesh
        objects = []
        for meshed in made:
            obj = write(meshed.task.obj, list(meshed.pieces))
            remember_quality(obj, [meshed])
            if settings.result == "REPLACE" and is_linked(obj):
                unlink(obj)  # else it would be thrown away when its source changes
            if settings.keep_linked and settings.result == "NEW":
                link(obj, meshed)
            objects.append(obj)
    name = collection_name()
    if name and settings.result != "REPLACE":
        _move(objects, name)
    return objects


def rewrite(target: bpy.types.Object, meshed: Meshed, draft: bool = False) -> None:
    """Give a linked mesh its new geometry; draft: whether that is poorer than its settings say."""
    write_again(target, list(meshed.pieces))
    remember_quality(target, [meshed])
    mark_as_current(target, meshed, draft)


def select(
    context: bpy.types.Context, made: list[bpy.types.Object], sources: list[bpy.types.Object], active: int
) -> bool:
    """Select the new objects in place of their sources, as Blender's own Convert does; whether any is to be seen.

    active: which of them is the active one, or of their sources, where they were joined.
    """
    for source in sources:
        source.select_set(False)
    context.view_layer.update()  # before that, it does not know of new collections
    there = set(context.view_layer.objects)
    shown = [obj for obj in made if obj in there]
    for obj in shown:
        obj.select_set(True)
    if shown:
        context.view_layer.objects.active = shown[min(active, len(shown) - 1)]
    return any(obj.visible_get() for obj in shown)


def _move(objects: list[bpy.types.Object], name: str) -> None:
    """Into a collection of the scene, which is made if it is not there."""
    collection = bpy.data.collections.get(name)
    if collection is None:
        collection = bpy.data.collections.new(name)
    if collection.library is not None:
        return  # nothing can be put into it, and results are better beside their sources than nowhere
    if collection not in bpy.context.scene.collection.children_recursive:
        bpy.context.scene.collection.children.link(collection)
    for obj in objects:
        old = [each for each in obj.users_collection if each != collection]
        if collection.objects.get(obj.name) != obj:
            collection.objects.link(obj)
        for each in old:
            each.objects.unlink(obj)
