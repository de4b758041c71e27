"""The report's tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from . import texts
from .answers import MEASURED, Claim
from .comparing import OURS, PAPER
from .epochs import connection_epochs, epochs, exceptions
from .fitting import BATCH
from .stage_claims import NAMED

TABLE_1 = {("random", 1): 689, ("random", 2): 1378, ("random", 4): 2756}  # mean population by sampling and N_I
TABLE_1 |= {("adaptive", m): 450 * m for m in (1, 2, 4)}


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (columns, ["---"] * len(columns), *rows))


def claim_table(answers: Sequence[Claim]) -> str:
    """A line for each claim, and how many of each answer by what is measured."""
    rows = [[c.what, c.paper, c.ours, f"**{c.answer}**", c.shipped] for c in answers]
    counts = []
    for name in MEASURED:
        own = [claim.answer for claim in answers if claim.of == name]
        count = ", ".join(f"{own.count(kind)} {kind}" for kind in sorted(set(own)))
        counts.append(f"- {len(own)} about {name}: {count}." if own else "")
    columns = ["claim", "paper", "the paper's networks, here", "answer", "the shipped networks"]
    return "\n".join([f"Of {len(answers)} claims:", "", *filter(None, counts), "", table(columns, rows)])


def population_table(config: dict, found: dict) -> str:
    """Of each N_C: contours, meshes of the groups, and epochs of each role, from what the networks' files say."""
    rows, folder = [], config["folders"]["models"]
    for row in found["populations"]["by edges"]:
        n = row["n"]
        placed, connected = config["nn2"]["groups"][n], config["nn3"]["groups"].get(n, ())
        meshes = [row["groups"][m] for m in placed if m < len(row["groups"])]
        seen = [connection_epochs(config, n, m, meshes_of(found, n, m)) for m in connected]
        rows.append(
            [
                str(n),
                f"{texts.PAPER_POPULATIONS[n]:,}" if n in texts.PAPER_POPULATIONS else "not said",
                f"{row['contours']:,}",
                _range([epochs(folder / f"nn1_{n}.onnx")]),
                f"{_ints(placed)}: {min(meshes, default=0):,} to {max(meshes, default=0):,}",
                f"{100 * row['covered']:.0f} %",
                _range([epochs(folder / f"nn2_{n}_{m}.onnx") for m in placed]),
                _ints(connected) if connected else "—",
                _range([random for random, _ in seen]),
                _range([references for _, references in seen]),
            ]
        )
    columns = ["N_C", "contours, paper", "contours", "NN1: epochs (3000)", "NN2's groups N_I: meshes", "of all meshes"]
    columns += ["NN2: epochs (5000)", "NN3's groups N_I"]
    return table([*columns, "NN3: epochs of random vertices (5000)", "of Gmsh's meshes (5000)"], rows)


def meshes_of(found: dict, n: int, m: int) -> int:
    """Training meshes of a group."""
    groups = next((row["groups"] for row in found["populations"]["by edges"] if row["n"] == n), ())
    return groups[m] if m < len(groups) else 0


def population_text(config: dict) -> str:
    """What populations and epochs are, and which networks are exceptions."""
    return texts.POPULATIONS.format(**config, exceptions=exceptions(config))


def learning_text(config: dict, found: dict) -> str:
    """With how many times as many epochs the paper has."""
    folder, parts = config["folders"]["models"], []
    groups = {role: [(n, m) for n, inner in config[role]["groups"].items() for m in inner] for role in ("nn2", "nn3")}
    seen = {
        "NN1": (3000, [epochs(folder / f"nn1_{n}.onnx") for n in config["data"]["train"]]),
        "NN2": (5000, [epochs(folder / "nn2_{}_{}.onnx".format(*key)) for key in groups["nn2"]]),
        "NN3's random vertices": (
            5000,
            [connection_epochs(config, *key, meshes_of(found, *key))[0] for key in groups["nn3"]],
        ),
    }
    for name, (paper, here) in seen.items():
        ratios = [paper / value for value in here if value]
        parts += [f"{min(ratios):.0f} to {max(ratios):.0f} ({name})"] if ratios else []
    return texts.LEARNING.format(ratios=", ".join(parts))


def _range(values: Sequence[float | None]) -> str:
    values = [value for value in values if value is not None]
    if not values:
        return "—"
    low, high = f"{min(values):.0f}", f"{max(values):.0f}"
    return low if low == high else f"{low}–{high}"


def _ints(values: Sequence[int]) -> str:
    """1, 2, 3, 5 as 1–3, 5."""
    parts: list[list[int]] = []
    for value in values:
        if parts and value == parts[-1][-1] + 1:
            parts[-1].append(value)
        else:
            parts.append([value])
    return ", ".join(f"{part[0]}–{part[-1]}" if len(part) > 1 else str(part[0]) for part in parts)


def count_table(rows: list[dict]) -> str:
    """Both networks' errors by N_C and target edge length."""
    targets = sorted({row["l_s"] for row in rows})
    lines = []
    for n in sorted({row["n"] for row in rows}):
        cells = []
        for l_s in targets:
            pair = [
                next(r["error"] for r in rows if (r["n"], r["l_s"], r["networks"]) == (n, l_s, name))
                for name in (PAPER, OURS)
            ]
            spread = next(r["deviation"] for r in rows if (r["n"], r["l_s"]) == (n, l_s))
            cells.append(f"{pair[0]:.2f} / {pair[1]:.2f} ({spread:.1f})")
        lines.append([str(n), *cells])
    return "By l_s: the paper's networks / the shipped ones (standard deviation of N_I).\n\n" + table(
        ["N_C", *(f"{t:g}" for t in targets)], lines
    )


def resolution_table(rows: list[dict]) -> str:
    """Mean squared distances by N_C and grid."""
    lines = []
    for n in sorted({row["n"] for row in rows}):
        own = [row for row in rows if row["n"] == n]
        cells = [f"{row['error']:.4f} ± {row['spread']:.4f}" for row in sorted(own, key=lambda row: row["grid"])]
        lines.append([str(n), str(own[0]["meshes"]), str(own[0]["contours"]), *cells])
    grids = sorted({row["grid"] for row in rows})
    return table(["N_C", "meshes learnt from", "tested", *(f"{grid}×{grid}" for grid in grids)], lines)


def exclusion_table(rows: list[dict]) -> str:
    """NN2's ē_worst on training meshes, by the radius of exclusion: means over groups."""
    radii = sorted({row["radius"] for row in rows}, key=lambda radius: radius or 0)
    means = []
    for radius in radii:
        values = [row["worst"] for row in rows if row["radius"] == radius and row["worst"] is not None]
        means.append(f"{np.mean(values):+.1f}" if values else "—")
    names = ["the paper's 0.1 l_s" if radius is None else f"{radius:g} even edges" for radius in radii]
    return table(["radius of exclusion", *names], [["mean of the groups' ē_worst, %, training meshes", *means]])


def mixture_part(config: dict, found: dict) -> str:
    """NN3's ē_worst by the share of the reference's vertices that it learns from."""
    wanted = config["nn3"]
    fewest = round(wanted["steps"] * wanted["share"] * BATCH / wanted["references"])
    lines = []
    for row in found["shares"]:
        cells = (
            "—" if of["worst"] is None else f"{of['worst']:+.1f} ± {of['worst_spread']:.1f}"
            for of in row["vertices"].values()
        )
        shares = (f"{100 * row['share'].get(name, 0):.0f} %" for name in ("reference", "placed"))
        lines.append([*shares, *cells])
    names = [f"on {name} vertices: ē_worst, %" for name in found["shares"][0]["vertices"]]
    one_in = round(1 / found["shares"][0]["share"]["reference"])
    text = texts.MIXTURE.format(one_in=one_in, fewest=fewest, **found)
    return texts.filled(text) + "\n\n" + table(["examples of the reference's vertices", "of NN2's", *names], lines)


def stage_parts(config: dict, found: dict) -> list[str]:
    """Figs. 22, 24, 25 and 27, each with its sentence, picture and table of groups."""
    parts, rows = [], found["stages"]
    tested = {(row["n"], of["m"]): of for row in found["populations"]["by edges"] for of in row["tested"]}
    star = config["nn3_star"]["n_contour"], 1
    for figure, (title, text) in texts.STAGES.items():
        own = [row for row in rows if row["figure"] == figure and row["m"] is not None]
        text = text.format(few=meshes_of(found, *star))
        parts += [f"## Fig. {figure}: {title}", texts.section(text, f"stages {figure}")]
        if figure == 27:
            parts.append(_shares(rows))
        if figure == 22:
            parts.append(exclusion_table(found["exclusion"]))
        if figure == 25:
            parts.append(mixture_part(config, found["mixture"]))
        table_of = stage_table(own, figure, {} if figure == 27 else tested)
        parts += [f"![Fig. {figure}](reproduction/fig_{figure}.png)", table_of]
    return parts


def stage_table(rows: list[dict], figure: int, tested: dict[tuple[int, int], dict]) -> str:
    """A line for each group: ē_worst / ē_mean by both networks; tested: of how many contours its meshes are."""
    lines = []
    for n, m in sorted({(row["n"], row["m"]) for row in rows}):
        own = [row for row in rows if (row["n"], row["m"]) == (n, m)]
        cells = []
        for name in (PAPER,) if figure == 24 else (PAPER, OURS):
            row = next((row for row in own if row["networks"] == name and row["contours"]), None)
            cells.append(
                "—" if row is None else f"{row['worst']:+.1f} ± {row['worst_spread']:.1f} / {row['mean']:+.1f}"
            )
        if figure == 25:
            row = next((row for row in own if row.get("rest by CDT") is not None), None)
            cells.insert(1, "—" if row is None else f"{row['rest by CDT']:+.1f}")
        named = NAMED[figure].get((n, m))
        counts = [str(own[0]["contours"]), *([str(tested[n, m]["contours"])] if (n, m) in tested else [])]
        lines.append([str(n), str(m), *counts, "" if named is None else f"{named:g}", *cells])
    names = ["calculated tables"] if figure == 24 else [PAPER, OURS]
    errors = [f"{name}: ē_worst / ē_mean, %" for name in names]
    if figure == 25:
        errors.insert(1, f"{PAPER}, sub-contours by CDT: ē_worst, %")
    head = ["N_C", "N_I", "meshes", *(["of contours"] if tested else []), "paper's ē_worst", *errors]
    return f"<details><summary>All groups</summary>\n\n{table(head, lines)}\n\n</details>"


def _shares(rows: list[dict]) -> str:
    shares = [row for row in rows if row["figure"] == 27 and row["m"] is None]
    text = ", ".join(
        f"{100 * row['in trained groups'] / max(1, row['meshes']):.0f} % (N_C {row['n']})" for row in shares
    )
    own = [row for row in rows if row["figure"] == 27 and row["m"] and row["networks"] == PAPER and row["contours"]]
    fell = np.average([r["fallbacks"] for r in own], weights=[r["contours"] for r in own]) if own else 0.0
    return (
        f"The share of meshes for which NN1 asks for a trained group: {text}. Sub-contours of groups without a network "
        f"have no table, and take the constrained Delaunay triangulation's element: {fell:.2f} elements a mesh."
    )


def adaptive_table(rows: list[dict]) -> str:
    """Table 1, with what was found beside it."""
    lines = [
        [
            str(row["m"]),
            row["sampling"],
            f"{row['population']:.0f} ({TABLE_1[row['sampling'], row['m']]})",
            str(row["level"]),
            str(row["size"]),
            f"{row['contours learnt from']}",
            f"{row['epochs']:.0f}",
            f"{row['loss'] ** 0.5:.3f}",
            "—" if row["worst"] is None else f"{row['worst']:+.1f} ± {row['worst_spread']:.1f}",
            str(row["contours"]),
        ]
        for row in rows
    ]
    columns = ["N_I", "sampling", "inner vertices a contour (paper)", "confidence, %", "sample", "contours", "epochs"]
    return table([*columns, "training loss (root)", "ē_worst, %", "meshes tested"], lines)


def domain_table(rows: list[dict]) -> str:
    """Table 2."""
    lines = []
    for row in rows:
        worst, mean = row["paper"]
        left_out = "—" if row["q_left_out"] is None else f"{row['q_left_out']:.2f}"
        ours = f"{row['q_worst']:.2f}, {row['q_mean']:.2f}"
        lines.append([row["name"], f"{worst:.2f}, {mean:.2f}", ours, left_out, str(row["triangles"])])
    columns = ["", "paper: q_worst, q_mean", "the shipped networks", "the element in the sharp tail", "triangles"]
    return table(columns, lines)


def speed_table(rows: list[dict]) -> str:
    """Milliseconds a contour."""
    names = [name for name in rows[0] if name not in ("n", "contours")] if rows else []
    lines = [[str(row["n"]), str(row["contours"]), *(f"{row[name]:.2f}" for name in names)] for row in rows]
    return table(["N_C", "contours", *(f"{name}, ms" for name in names)], lines)


def learning_table(rows: list[dict]) -> str:
    """Sizes and losses."""
    lines = [
        [
            row["role"],
            row["what"],
            ", ".join(f"{row['steps'][i]:,}: {row['training'][i]:.3g}" for i in _quarters(len(row["steps"]))),
            ", ".join(f"{size:,}: {loss:.3g}" for size, loss in zip(row["size"], row["loss"], strict=True)),
        ]
        for row in rows
    ]
    return table(
        ["", "on test contours", "batches seen, of the largest population: training loss", "population: loss"], lines
    )


def _quarters(count: int) -> list[int]:
    """Numbers of a quarter, a half and the whole of some."""
    return sorted({max(0, count * k // 4 - 1) for k in (1, 2, 4)})
