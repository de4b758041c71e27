"""The settings as options of the command line: `--edge-length` is `Settings.edge_length`, and so on. No `bpy` here."""

import argparse
from collections.abc import Callable
from dataclasses import fields

import numpy as np

from .settings import Settings, Shown, table


def add_options(parser: argparse.ArgumentParser) -> None:
    """An option for each setting, in groups; lengths may also be `automatic`, which is 0."""
    shown = table()
    names = dict.fromkeys(how.group for how in shown.values())  # each once, in order
    groups = {name: parser.add_argument_group(f"{name} settings") for name in names}
    for each in fields(Settings):
        how = shown[each.name]
        group = groups[how.group]
        option = f"--{each.name.replace('_', '-')}"
        text = how.description.replace("%", "%%")
        if isinstance(each.default, bool):
            group.add_argument(option, action=argparse.BooleanOptionalAction, default=each.default, help=text)
        elif how.choices:
            words = [word.lower().replace("_", "-") for word, _, _ in how.choices]
            chosen = each.default.lower().replace("_", "-")
            group.add_argument(option, choices=words, default=chosen, help=f"{text} ({chosen})")
        else:
            default = "automatic" if each.default == 0 and how.unit == "length" else each.default
            kind = str if isinstance(each.default, str) else _number(type(each.default), how)
            text = text if isinstance(each.default, str) else f"{text} ({default})"
            group.add_argument(option, type=kind, default=each.default, metavar=_metavar(each.default, how), help=text)


def settings_from(options: argparse.Namespace) -> Settings:
    """The settings that the parsed options say."""
    values = {}
    for name, how in table().items():
        value = getattr(options, name)
        values[name] = value.upper().replace("-", "_") if how.choices else value
    return Settings(**values)


def _number(kind: type, how: Shown) -> Callable[[str], float]:
    """What argparse makes a number of a word with, refused out of bounds, and of what Blender's properties hold."""
    high = min(how.high, float(np.finfo(np.float32).max))

    def number(word: str) -> float:
        value = kind(0) if word == "automatic" and how.unit == "length" else kind(word)
        if not how.low <= value <= high:  # nor is "nan"
            raise argparse.ArgumentTypeError(f"{word} is not between {how.low:g} and {high:g}")
        return value

    number.__name__ = "length" if how.unit == "length" else "number"
    return number


def _metavar(default: float | str, how: Shown) -> str:
    if isinstance(default, str):
        return "NAME"
    return {"length": "LENGTH", "angle": "DEGREES"}.get(how.unit, "N" if isinstance(default, int) else "X")
