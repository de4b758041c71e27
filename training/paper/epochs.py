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


def is_earlier(config: dict, notes: dict) -> bool:
    """Whether a NN3 is from before the configuration had a share of the reference's vertices: fewer batches say so."""
    return notes["role"] == "nn3" and notes["step"] < config["nn3"]["steps"]


def connection_epochs(config: dict, n: int, m: int, meshes: int) -> tuple[float | None, float | None]:
    """How often the NN3 of a group has seen each group of random vertices, and each of the reference's meshes.

    meshes: of the group, of which at most ``references`` are learnt from; None where there are none, or no network.
    """
    wanted, notes = config["nn3"], about(config["folders"]["models"] / f"nn3_{n}_{m}.onnx")
    if notes is None:
        return None, None
    if is_earlier(config, notes):
        every = notes["step"] * BATCH / notes["examples"]
        return every, every if meshes else None
    references = min(meshes, wanted["references"]) if m else 0
    rows = round(wanted["share"] * BATCH) if references else 0
    random = notes["examples"] - references
    return notes["step"] * (BATCH - rows) / random, notes["step"] * rows / references if references else None


def exceptions(config: dict) -> str:
    """Sentences on the kept networks that the configuration, as it is now, would make otherwise."""
    folder, parts = config["folders"]["models"], []
    groups = [(n, m) for n, inner in config["nn3"]["groups"].items() for m in inner]
    earlier = {key: notes for key in groups if (notes := about(folder / "nn3_{}_{}.onnx".format(*key)))}
    earlier = {key: notes["step"] for key, notes in earlier.items() if is_earlier(config, notes)}
    if earlier:
        names = _names(list(earlier), config["nn3"]["groups"])
        parts.append(
            f"NN3 of {names} are from an earlier recipe: {_numbers(earlier.values())} batches, and at most 500 of the "
            "reference's meshes, drawn as often as the other examples."
        )
    placed = {n: [about(folder / f"nn2_{n}_{m}.onnx") for m in inner] for n, inner in config["nn2"]["groups"].items()}
    steps = {n: notes["step"] for n, found in placed.items() for notes in found if notes}
    other = [n for n, step in steps.items() if step != config["nn2"]["steps"]]
    if other:
        parts.append(
            f"NN2 of N_C {_listed(other)} had {_numbers(steps[n] for n in other)} batches, the others "
            f"{config['nn2']['steps']:,}."
        )
    return " ".join(parts)


def _names(groups: Sequence[tuple[int, int]], trained: dict[int, list[int]]) -> str:
    """Groups in words, whole N_C by their number alone."""
    parts = []
    for n in dict.fromkeys(n for n, _ in groups):
        own = [m for of, m in groups if of == n]
        inner = "" if own == list(trained[n]) else f", N_I {_listed(own)}"
        parts.append(f"N_C {n}{inner}")
    return " and of ".join(parts)


def _listed(values: Sequence[int]) -> str:
    return ", ".join(map(str, values))


def _numbers(values: Sequence[int]) -> str:
    return " or ".join(f"{value:,}" for value in sorted(set(values)))
