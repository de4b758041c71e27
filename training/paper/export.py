"""Export the paper's networks: ``python -m training.paper.export``, to ``paper_models/*.onnx``.

One file for each network, named by role, N_C and N_I, checked against the framework's own output; its metadata say what
it was trained with. NN3* are those of the largest adaptive samples (`adaptive`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import torch

from . import settings
from .networks import Network, nn1, nn2, nn3, nn3_star, one_of

TOLERANCE = 1e-4  # of the largest answer
MOST_BYTES = 15_000_000  # of all files together


class _Single(torch.nn.Module):
    """A stack of one network, on plain rows."""

    def __init__(self, net: Network) -> None:
        super().__init__()
        self.net = net

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        return self.net(rows[None])[0]


def main() -> None:
    """Export all that is trained."""
    config, _ = settings.from_command_line(__doc__)
    export_all(config)


def export_all(config: dict) -> None:
    """Export all that is trained, and see that the files are small enough together."""
    folder: Path = config["folders"]["models"]
    folder.mkdir(parents=True, exist_ok=True)
    written = [export(folder / f"{name}.onnx", net, notes) for name, net, notes in trained(config)]
    total = sum(file.stat().st_size for file in folder.glob("*.onnx"))
    print(f"{len(written)} networks, {total / 1e6:.1f} MB together")
    if total > MOST_BYTES:
        raise SystemExit(
            f"{folder} holds {total / 1e6:.1f} MB, more than {MOST_BYTES / 1e6:.0f} MB: export fewer groups"
        )


def trained(config: dict) -> Iterator[tuple[str, Network, dict]]:
    """Name, network and notes of all networks that have been trained, of every file their last checkpoint."""
    for n in config["data"]["train"]:
        yield from _of(config, f"nn1_{n}", [f"nn1_{n}"], lambda n=n: nn1(n))
        yield from _of(config, f"nn2_{n}", None, lambda n=n: nn2(n))
        for m in config["nn3"]["groups"].get(n, ()):
            yield from _of(config, f"nn3_{n}_{m}", [f"nn3_{n}_{m}"], lambda n=n, m=m: nn3(n, m))
    star = config["nn3_star"]
    for m in star["groups"]:
        name, n = f"nn3_star_{star['n_contour']}_{m}", star["n_contour"]
        names = [name if sort == ["adaptive", star["levels"][-1]] else None for sort in star_sorts(config)]
        yield from _of(config, name, names, lambda n=n, m=m: nn3_star(n, m))


def star_sorts(config: dict) -> list[list]:
    """The samplings and confidence levels of the NN3* that are trained side by side."""
    return [[sampling, level] for sampling in ("random", "adaptive") for level in config["nn3_star"]["levels"]]


def _of(config: dict, run: str, names: list[str | None] | None, make: Callable[[], Network]) -> Iterator[tuple]:
    """The networks of a run's stack, under their names; None: not wanted. Without names, by their numbers of N_I."""
    file = config["folders"]["runs"] / f"{run}.pt"
    if not file.exists():
        return
    state = torch.load(file, weights_only=False)
    notes, stack = state["notes"], state["network"]
    names = names or [f"{run}_{m}" for m in notes["numbers"]]
    for number, name in enumerate(names):
        if name is not None:
            yield (
                name,
                one_of(stack, make(), number),
                notes | {"examples": notes["examples"][number], "step": state["step"]},
            )


def export(file: Path, net: Network, notes: dict) -> Path:
    """Write a network's file, and check it."""
    single, rows = _Single(net).eval(), torch.randn(5, net.inputs)
    torch.onnx.export(
        single,
        (rows,),
        file,
        input_names=["rows"],
        output_names=["answers"],
        dynamic_axes={"rows": {0: "rows"}, "answers": {0: "rows"}},
        opset_version=17,
        dynamo=False,
    )
    model = onnx.load(file)
    about = {name: notes[name] for name in ("role", "seed", "step", "examples", "code")}
    onnx.helper.set_model_props(model, {name: json.dumps(value) for name, value in about.items()})
    for node in model.graph.node:
        node.doc_string = ""
    onnx.save(model, file)
    session = onnxruntime.InferenceSession(file, providers=["CPUExecutionProvider"])
    for batch in (1, 7, 300):
        rows = torch.randn(batch, net.inputs)
        with torch.no_grad():
            ours = single(rows).numpy()
        (theirs,) = session.run(None, {"rows": rows.numpy()})
        if np.abs(ours - theirs).max() > TOLERANCE * max(1, np.abs(ours).max()):
            raise SystemExit(f"{file.name} departs from the framework's output")
    return file


if __name__ == "__main__":
    main()
