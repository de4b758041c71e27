"""The configuration of the paper's networks, and the folders it names."""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path

from ..configuration import ROOT

FILE = Path(__file__).with_name("config.toml")


def read(file: Path = FILE) -> dict:
    """A configuration file; the tables by N_C get whole numbers for keys, the folders are absolute."""
    config = tomllib.loads(Path(file).read_text())
    for split in ("train", "test"):
        config["data"][split] = {int(n): count for n, count in config["data"][split].items()}
    for section in ("nn2", "nn3"):
        if section in config:
            config[section]["groups"] = {int(n): inner for n, inner in config[section]["groups"].items()}
    config["folders"] = {name: ROOT / folder for name, folder in config["folders"].items()}
    return config


def from_command_line(description: str | None, *more: tuple[str, dict]) -> tuple[dict, argparse.Namespace]:
    """The configuration that a command is given with --config, and its arguments; more: further ones of argparse."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", type=Path, default=FILE, help="another configuration file")
    for name, options in more:
        parser.add_argument(name, **options)
    arguments = parser.parse_args()
    return read(arguments.config), arguments
