"""``python -m training.paper``: everything, in its order. What is there is not made again."""

from __future__ import annotations

from . import settings
from .adaptive import compare_samplings
from .counts import compare_counts
from .domains import mesh_all
from .exclusion import compare_radii
from .export import export_all
from .generate import make_all
from .learning import measure_curves
from .mixture import compare_shares
from .populations import count_all
from .report import write_report
from .resolution import compare_grids
from .speed import measure_speed
from .stages import compare_all
from .surfaces import keep_examples
from .train import train_all

STEPS = (
    make_all,
    train_all,
    compare_samplings,
    keep_examples,
    export_all,
    count_all,
    compare_radii,
    compare_shares,
    compare_counts,
    compare_grids,
    compare_all,
    measure_speed,
    mesh_all,
    measure_curves,
    write_report,
)


def everything(config: dict) -> None:
    """All steps."""
    for step in STEPS:
        step(config)


if __name__ == "__main__":
    everything(settings.from_command_line(__doc__)[0])
