"""How the settings are laid out, in Adjust Last Operation, the sidebar and the preferences."""

from __future__ import annotations

import textwrap
from collections.abc import Container
from dataclasses import fields
from itertools import groupby

import bpy

from . import notes
from .settings import EDGES_ALONG, Settings, table

_TITLES = {"sizing": "Smaller"}


def draw_settings(
    layout: bpy.types.UILayout,
    owner: bpy.types.bpy_struct,
    source: bpy.types.Object | None = None,
    without: Container[str] = (),
) -> None:
    """All settings of an operator or a group, those that have no effect greyed out; none of a group in `without`.

    source: the object whose vertex groups are offered for weights.
    """
    layout.use_property_split = True
    layout.use_property_decorate = False
    shown = table()
    names = [each.name for each in fields(Settings)]
    for group, members in groupby(names, key=lambda name: shown[name].group):
        if group in without:
            continue
        column = layout.column(heading=_TITLES.get(group, ""))
        for name in members:
            row = column.row()
            row.active = shown[name].applies(owner)
            _draw_one(row, owner, name, shown[name].names, source)
            if name == "edge_length" and owner.size_by == "EDGE_LENGTH" and not owner.edge_length:
                column.label(text=f"0: 1/{EDGES_ALONG} of each object's longer side")


def _draw_one(row, owner, name: str, names: str, source: bpy.types.Object | None) -> None:
    if names == "object" and isinstance(getattr(owner, name), str):
        row.prop_search(owner, name, bpy.data, "objects")
    elif names == "weight" and source is not None and len(source.vertex_groups):
        row.prop_search(owner, name, source, "vertex_groups")
    else:
        row.prop(owner, name)


def draw_text(layout: bpy.types.UILayout, text: str, width: int) -> None:
    """A sentence in lines of so many characters."""
    for line in textwrap.wrap(text, width):
        layout.label(text=line)


def draw_failures(layout: bpy.types.UILayout, most: int, width: int) -> None:
    """Each failure of the last use, with a button that leads to its place."""
    failed = notes.still_there()
    for noted in failed[:most]:
        column = layout.column(align=True)
        draw_text(column, noted.sentence, width)
        if noted.place is not None:
            text = "Show the Place" if bpy.data.objects[noted.obj].type == "FONT" else "Select the Point"
            button = column.operator("tessera.select_place", text=text, icon="RESTRICT_SELECT_OFF")
            button.object_name, button.spline, button.place = noted.obj, noted.spline, noted.place
    if len(failed) > most:
        layout.label(text=f"… and {len(failed) - most} more: see the Info editor")
