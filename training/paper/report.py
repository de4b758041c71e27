"""The report: ``python -m training.paper.report`` writes ``docs/reproduction.md`` and its pictures.

From what the experiments have left in ``training/paper/results/``, which is in the repository: neither data nor runs
are needed. The sentences on differences are in `texts`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tessera.paper_placement import grid_points

from .. import reference
from . import markdown, plots, settings, texts
from .claims import claims
from .comparing import read
from .sampling import GRID
from .stages import FIGURES
from .surfaces import inside, quality_surfaces, sampled, smoothed

NAMES = (
    *("populations", "counts", "resolution", "exclusion", "mixture"),
    *("adaptive", "surfaces", "domains", "speed", "learning"),
)


def main() -> None:
    """Write the report."""
    config, _ = settings.from_command_line(__doc__)
    print(write_report(config))


def write_report(config: dict) -> Path:
    """Write the text and draw the pictures; returns the text's file."""
    found = results(config)
    folder = config["folders"]["docs"]
    (folder / "reproduction").mkdir(parents=True, exist_ok=True)
    draw(folder / "reproduction", config, found)
    file = folder / "reproduction.md"
    file.write_text(text_of(config, found))
    return file


def results(config: dict) -> dict:
    """What all experiments have left, by name; the rows of all figures of stages together."""
    found = {name: read(config, name) for name in NAMES}
    return found | {"stages": [row for figure in FIGURES for row in read(config, f"fig_{figure}")]}


def text_of(config: dict, found: dict) -> str:
    """The whole page."""
    tested = [(row["n"], of) for row in found["populations"]["by edges"] for of in row["tested"]]
    parts = [
        "# The paper, reproduced",
        texts.filled(f"{texts.introduction(config, reference.VERSION)}\n\n{texts.clusters(tested)}"),
    ]
    parts += ["## The paper's claims", markdown.claim_table(claims(found))]
    parts += ["## Departures from the paper", texts.DEPARTURES]
    parts += ["## Populations and epochs", texts.section(markdown.population_text(config), "populations")]
    parts += [markdown.population_table(config, found), _picture("Figs. 17 and 18", "populations")]
    parts += [*figures(config, found), *tables_and_speed(config, found)]
    return "\n\n".join(filter(None, parts)) + "\n"


def figures(config: dict, found: dict) -> list[str]:
    """Sentences, pictures and tables of all figures from 19 to 27."""
    adaptive = texts.ADAPTIVE.format(contours=config["nn3_star"]["contours"])
    return [
        "## Fig. 19: the number of inner vertices (NN1)",
        texts.section(texts.COUNTS, "counts"),
        _picture("Fig. 19", "counts"),
        markdown.count_table(found["counts"]),
        "## Fig. 21: the grid's resolution (NN2)",
        texts.section(texts.RESOLUTION, "resolution"),
        _picture("Fig. 21", "resolution"),
        markdown.resolution_table(found["resolution"]),
        *markdown.stage_parts(config, found),
        "## Table 1, Figs. 15, 16 and 26: adaptive sampling (NN3*)",
        texts.section(
            f"{adaptive} Figs. 15 and 16 are drawn of what `python -m training.paper.surfaces` keeps.", "adaptive"
        ),
        *(_picture(f"Fig. {14 + m}", f"surface_{m}") for m in (1, 2)),
        _picture("Fig. 26", "adaptive"),
        markdown.adaptive_table(found["adaptive"]),
    ]


def tables_and_speed(config: dict, found: dict) -> list[str]:
    """Sentences, pictures and tables of the rest."""
    return [
        "## Table 2, Figs. 28 to 30: larger domains",
        texts.section(texts.DOMAINS, "domains"),
        _picture("Figs. 28 to 30", "domains"),
        markdown.domain_table(found["domains"]),
        "## Section 5: speed",
        texts.section(texts.SPEED, "speed"),
        markdown.speed_table(found["speed"]),
        "## What larger populations would give",
        texts.section(markdown.learning_text(config, found), "learning"),
        _picture("Learning curves", "learning"),
        markdown.learning_table(found["learning"]),
    ]


def _picture(title: str, name: str) -> str:
    return f"![{title}](reproduction/{name}.png)"


def draw(folder: Path, config: dict, found: dict) -> None:
    """All pictures."""
    plots.draw_populations(folder / "populations.png", found["populations"])
    plots.draw_counts(folder / "counts.png", found["counts"])
    plots.draw_resolution(folder / "resolution.png", found["resolution"])
    for figure in texts.STAGES:
        plots.draw_stage(folder / f"fig_{figure}.png", found["stages"], figure)
    plots.draw_adaptive(folder / "adaptive.png", found["adaptive"])
    plots.draw_learning(folder / "learning.png", found["learning"])
    with np.load(config["folders"]["results"] / "domains.npz") as meshes:
        names = [row["name"] for row in found["domains"]]
        plots.draw_meshes(
            folder / "domains.png", {n: (meshes[f"{n} vertices"], meshes[f"{n} triangles"]) for n in names}
        )
    for example in found["surfaces"]:
        contour, inner = (np.array(example[name]) for name in ("contour", "inner"))
        draw_surface(folder / f"surface_{len(inner)}.png", contour, inner, example["l_s"])


def draw_surface(path: Path, contour: np.ndarray, inner: np.ndarray, l_s: float) -> None:
    """Figs. 15 and 16: what one edge's vertices are sampled from, the mesh's other inner vertices given."""
    spots, others = inside(contour, l_s), inner[1:]
    surfaces = quality_surfaces(contour, others, spots)
    smooth = smoothed(surfaces, spots)
    numbers = sampled(np.random.default_rng(0), surfaces, spots)[0]
    plots.draw_surfaces(path, contour, (surfaces[0], smooth[0]), grid_points(GRID)[numbers], others)


if __name__ == "__main__":
    main()
