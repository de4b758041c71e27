"""Where a network comes from: the code and the data that it was trained with."""

from __future__ import annotations

import hashlib
import subprocess
from pathlib import Path

from tessera.runtime import MODELS

from . import configuration


def fingerprint(*files: Path) -> str:
    """A hash over the contents of files, of those that are there."""
    digest = hashlib.sha256()
    for file in files:
        if file.exists():
            digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:16]


def data_fingerprint() -> str:
    """Of the training data's file and, where it has been made, NN2's own placements."""
    folder = configuration.ROOT / configuration.read()["data"]["folder"]
    return fingerprint(folder / "train.npz", folder / "train_placed.npz")


def network_hashes() -> dict[str, str]:
    """Of the networks that the library uses, by file."""
    return {file.name: fingerprint(file) for file in sorted(MODELS.glob("*.onnx"))}


def code_version() -> str:
    """The commit, with what is not committed marked."""
    command = ["git", "-C", str(configuration.ROOT), "describe", "--always", "--dirty"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or "unknown"
