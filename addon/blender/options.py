"""The settings as options of the command line: `--edge-length` is `Settings.edge_length`, and so on. No `bpy` here."""

import argparse
from dataclasses import fields

from .settings import Settings, table


def add_options(parser: argparse.ArgumentParser) -> None:
    """An option for each setting, in groups; lengths may also be `automatic`, which is 0."""
    groups = {}
    shown = table()
    for each in fields(Settings):
        how = shown[each.name]
        group = groups.setdefault(how.group, None) or parser.add_argument_group(f"{how.group} settings")
        groups[how.group] = group
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


def _number(kind: type, how) -> type:
    """What argparse makes a number of a word with, refused out of bounds."""

    def number(word: str) -> float:
        value = kind(0) if word == "automatic" and how.unit == "length" else kind(word)
        if not how.low <= value <= how.high:
            raise argparse.ArgumentTypeError(f"{word} is not between {how.low:g} and {how.high:g}")
        return value

    number.__name__ = "length" if how.unit == "length" else "number"
    return number


def _metavar(default, how) -> str:
    if isinstance(default, str):
        return "NAME"
    return {"length": "LENGTH", "angle": "DEGREES"}.get(how.unit, "N" if isinstance(default, int) else "X")
