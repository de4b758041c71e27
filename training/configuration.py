"""The configuration file, read once."""

from __future__ import annotations

import tomllib
from pathlib import Path

FILE = Path(__file__).with_name("config.toml")
ROOT = Path(__file__).resolve().parents[1]


def read() -> dict:
    """The whole of ``config.toml``."""
    return tomllib.loads(FILE.read_text())
