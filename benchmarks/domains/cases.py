"""The domains of the table: the paper's three, glyphs of a font, and coasts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import matplotlib
import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

import tessera
from tessera.budget import MOST_TRIANGLES
from tessera.contour import clean_domains
from tessera.gradation import prepare
from tessera.settings import Request, Settings

from . import outlines

FONT = "DejaVuSans.ttf"
UNIFORM, THIN = "MSB8g@", "kW7&RQ"  # glyphs meshed at one length, and by their thickness
EM = 100.0
EVEN = "Ireland", "New Guinea", "Baffin Island"  # coasts that are meshed at one length


@dataclass(frozen=True)
class Case:
    """A domain and what is asked of its mesh.

    loops: (k, 2) arrays; options: further arguments of `tessera.mesh`; left_out: the elements at this vertex (2,) do
    not count for q_worst; paper, goal: (q_worst, q_mean), where there are any.
    """

    name: str
    kind: str
    loops: list[np.ndarray]
    edge_length: float
    options: dict = field(default_factory=dict)
    left_out: np.ndarray | None = None
    paper: tuple[float, float] | None = None
    goal: tuple[float, float] | None = None


def all_cases() -> list[Case]:
    """The domains, in the table's order."""
    return [*paper_cases(), *glyphs(), *islands()]


def paper_cases() -> list[Case]:
    """The paper's three (Table 2)."""
    return [circle(0.101), airfoil(), plate()]


def round_loop(radius: float = 1.0, n: int = 400) -> np.ndarray:
    """(n, 2) vertices of a circle around the origin."""
    angle = 2 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def circle(edge_length: float) -> Case:
    """The unit circle; of thousandths, 0.101 comes nearest to 400 nodes."""
    return Case("circle", "circle", [round_loop()], edge_length, paper=(0.88, 0.97), goal=(0.88, 0.985))


def airfoil() -> Case:
    """NACA 0012 with a closed trailing edge, of chord 1: small elements at its nose and its tail.

    Its boundary is kept: vertices evenly spaced all along by the sizing function, but for the two edges that meet in
    the tail. Even spacing there would force a second, poorer element on every mesher, as the tail has 16 degrees.
    """
    tip = 0.03
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 2001)))
    y = 0.6 * (0.2969 * np.sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))))
    points = np.stack([x, y], axis=1)[::-1]
    points[0] = 1, 0

    def sizing(points: np.ndarray) -> np.ndarray:
        """As thick as the tail, small at the nose: (n, 2) -> (n,)."""
        nose, tail = np.linalg.norm(points, axis=1), np.linalg.norm(points - [1, 0], axis=1)
        return np.minimum(np.minimum(0.03, 0.006 + 0.15 * nose), 0.25 * np.maximum(tail, tip))

    start = int(np.argmax(np.linalg.norm(points - [1, 0], axis=1) >= tip))
    middle = 0.5 * (points[start:-1] + points[start + 1 :])
    edges = np.linalg.norm(np.diff(points[start:], axis=0), axis=1) / sizing(middle)
    along = np.concatenate([[0], np.cumsum(edges)])
    even = np.linspace(0, along[-1], round(along[-1]) + 1)
    upper = np.stack([np.interp(even, along, column) for column in points[start:].T], axis=1)
    upper[-1] = 0
    loop = np.concatenate([[[1.0, 0.0]], upper, upper[-2::-1] * [1, -1]])
    options = {"sizing": sizing, "boundary": "keep"}
    return Case("NACA 0012", "airfoil", [loop], 0.03, options, loop[0], paper=(0.69, 0.90), goal=(0.72, 0.95))


def plate() -> Case:
    """A square with a round hole, around which elements are small."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    sizing = tessera.by_distance(0.04, round_loop(0.4, 100), reach=0.8)
    loops = [square, round_loop(0.4)]
    return Case("plate with a hole", "plate", loops, 0.2, {"sizing": sizing}, paper=(0.66, 0.85), goal=(0.75, 0.96))


def glyphs() -> list[Case]:
    """Letters of one piece, with and without holes, in a font that matplotlib ships; lengths in 1/100 em."""
    font = FontProperties(fname=f"{matplotlib.get_data_path()}/fonts/ttf/{FONT}")
    thin = {"sizing": tessera.by_thickness(3), "min_edge_length": 0.01 * EM}
    cases = []
    for letters, length, options in ((UNIFORM, 0.035 * EM, {}), (THIN, 0.08 * EM, thin)):
        for letter in letters:
            # Closed polygons end where they started.
            loops = [loop[:-1] for loop in TextPath((0, 0), letter, size=EM, prop=font).to_polygons()]
            cases.append(Case(letter, "glyph", loops, length, options))
    return cases


def islands() -> list[Case]:
    """Coasts: some at the mean length of their edges; others from there, finer in thin parts, coarser inland."""
    cases = []
    for name, *place in outlines.ISLANDS:
        loop = outlines.outline(*place)
        length = float(np.linalg.norm(loop - np.roll(loop, 1, axis=0), axis=1).mean())
        graded = tessera.smallest(tessera.by_thickness(2), tessera.by_distance(length))
        options = {} if name in EVEN else {"sizing": graded, "min_edge_length": length / 5}
        title = f"{name}, {len(loop):,} vertices"
        cases.append(Case(title, "outline", [loop], 6 * length if options else length, options))
    return cases


def target_of(case: Case) -> float | Callable[[np.ndarray], np.ndarray]:
    """The sizing function that the case's mesh follows, limited and graded: a length, or (n, 2) -> (n,)."""
    own = (case.options.get(name) for name in ("sizing", "min_edge_length"))
    sizing, limits = Request(case.loops, case.edge_length, *own).checked(Settings())
    if sizing is None:
        return case.edge_length
    target, errors = prepare({0: clean_domains([case.loops])[0]}, [(sizing, limits)], MOST_TRIANGLES)
    if errors:
        raise errors[0]
    return lambda points: target(points, np.zeros(len(points), dtype=np.int64))
