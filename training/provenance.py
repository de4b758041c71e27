"""Where a network comes from: the code and the data that it was trained with."""

from __future__ import annotations

import hashlib
import subprocess

from . import configuration


def data_fingerprint() -> str:
    """A hash over the training data's file and, where it has been made, NN2's own placements."""
    folder = configuration.ROOT / configuration.read()["data"]["folder"]
    files = (folder / "train.npz", folder / "train_placed.npz")
    return hashlib.sha256(b"".join(hashlib.sha256(f.read_bytes()).digest() for f in files if f.exists())).hexdigest()[
        :16
    ]


def code_version() -> str:
    """The commit, with what is not committed marked."""
    command = ["git", "-C", str(configuration.ROOT), "describe", "--always", "--dirty"]
    return subprocess.run(command, capture_output=True, text=True).stdout.strip() or "unknown"
