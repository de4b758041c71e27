"""How much the exported networks were trained, from what their files say."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import onnx

from .fitting import BATCH


def about(file: Path) -> dict | None:
    """An exported network's notes; None where it is not there."""
    if not file.exists():
        return None
    return {entry.key: json.loads(entry.value) for entry in onnx.load(file).metadata_props}


def epochs(file: Path) -> float | None:
    """How often an exported network has seen its examples on average; None where it is not there."""
    notes = about(file)
    return None if notes is None else notes["step"] * BATCH / notes["examples"]


def connection_epochs(config: dict, n: int, m: int, meshes: int) -> tuple[float | None, float | None]:
    """How often the NN3 of a group has seen each group of random vertices, and each of the reference's meshes.

    meshes: of the group, of which at most ``references`` are learnt from; None where there are none, or no network.
    """
    wanted, notes = config["nn3"], about(config["folders"]["models"] / f"nn3_{n}_{m}.onnx")
    if notes is None:
        return None, None
    references = min(meshes, wanted["references"]) if m else 0
    rows = round(wanted["share"] * BATCH) if references else 0
    random = notes["examples"] - references
    return notes["step"] * (BATCH - rows) / random, notes["step"] * rows / references if references else None


def exceptions(config: dict) -> str:
    """Sentences on the networks that had more batches, or others than the configuration says now."""
    folder, parts = config["folders"]["models"], []
    longer = {}
    for name, steps in config["nn3"]["longer"].items():
        longer.setdefault(steps, []).append(f"({name.replace('_', ', ')})")
    if longer:
        more = ", ".join(f"{' and '.join(names)} {steps:,}" for steps, names in longer.items())
        parts.append(f"Of NN3, groups (N_C, N_I) that the paper names had more batches: {more}.")
    placed = {n: [about(folder / f"nn2_{n}_{m}.onnx") for m in inner] for n, inner in config["nn2"]["groups"].items()}
    steps = {n: notes["step"] for n, found in placed.items() for notes in found if notes}
    other = [n for n, step in steps.items() if step != config["nn2"]["steps"]]
    if other:
        parts.append(
            f"NN2 of N_C {_listed(other)} had {_numbers(steps[n] for n in other)} batches, the others "
            f"{config['nn2']['steps']:,}."
        )
    return " ".join(parts)


def _listed(values: Sequence[int]) -> str:
    return ", ".join(map(str, values))


def _numbers(values: Sequence[int]) -> str:
    return " or ".join(f"{value:,}" for value in sorted(set(values)))
