"""Domains to mesh: random curves of many sorts that a user would draw, and real ones, which training never sees."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tessera import ContourError, boundary
from tessera.contour import clean_domains

TRIANGLES = 50, 600  # that random domains are to have, about
_KEPT = 0.3  # share of random domains that keep the boundary they have
_FONTS = "DejaVuSans.ttf", "DejaVuSerif.ttf", "DejaVuSansMono-Bold.ttf", "STIXGeneralItalic.ttf", "cmr10.ttf"
_GLYPHS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789?!&%$#*+"
_NACA = "0006", "0012", "0021", "1408", "2412", "2424", "4412", "6409", "8315"


@dataclass(frozen=True)
class Domain:
    """A closed curve (k, 2) in units of its target edge length; keep: whether its vertices are the mesh's boundary."""

    loop: np.ndarray
    keep: bool


def random_domains(rng: np.random.Generator, count: int) -> list[Domain]:
    """Random domains without holes; some keep their own boundary, mostly several times as coarse as the target.

    A few whose coarse boundary crosses itself are left to the library to refuse.
    """
    return [_random_domain(rng) for _ in range(count)]


def real_domains() -> list[Domain]:
    """Glyphs of several fonts (the outer loop), NACA airfoils and sections of steel beams, each at two target lengths.

    Every second is meshed with the boundary as it is, which for a glyph is fine along bends and coarse along stems.
    """
    shapes = _glyphs() + [naca(digits) for digits in _NACA] + _sections()
    return [
        Domain(_scaled(shape, wanted), keep=(number + size) % 2 == 1)
        for number, shape in enumerate(shapes)
        for size, wanted in enumerate((90, 350))
    ]


def _random_domain(rng: np.random.Generator) -> Domain:
    while True:
        shape = _SORTS[int(rng.integers(len(_SORTS)))](rng)
        if not isinstance(clean_domains([[shape]])[0], ContourError):
            break
    turn = rng.uniform(0, 2 * np.pi)
    shape = shape @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    wanted = np.exp(rng.uniform(*np.log(TRIANGLES)))
    if rng.random() > _KEPT:
        return Domain(_scaled(shape, wanted), keep=False)
    # Beside long edges elements are long, so that there must be room for more of them.
    coarse, wanted = (rng.uniform(2, 5), 2 * wanted) if rng.random() < 0.7 else (1.0, wanted)
    loop = boundary.resample(_scaled(shape, wanted), coarse)
    if rng.random() < 0.5:  # uneven, as by hand
        loop = loop + 0.15 * coarse * rng.uniform(-1, 1, loop.shape)
    return Domain(loop, keep=True)


def _scaled(shape: np.ndarray, triangles: float) -> np.ndarray:
    """The shape, counter-clockwise, so large that it holds so many equilateral triangles of edge length 1."""
    area = _area(shape)
    if area < 0:
        shape = shape[::-1]
    return np.ascontiguousarray(shape * (triangles * 3**0.5 / 4 / abs(area)) ** 0.5)


def _area(shape: np.ndarray) -> float:
    x, y = shape.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def _blob(rng: np.random.Generator) -> np.ndarray:
    """A smooth closed curve: an ellipse with waves."""
    angle = np.linspace(0, 2 * np.pi, 150, endpoint=False)
    wave = np.arange(2, 8)
    size = rng.normal(0, rng.uniform(0, 0.5), len(wave)) / wave
    radius = np.exp((size * np.cos(angle[:, None] * wave + rng.uniform(0, 2 * np.pi, len(wave)))).sum(axis=1))
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1) * [1, rng.uniform(0.35, 1)]


def _polygon(rng: np.random.Generator) -> np.ndarray:
    """Straight sides, with sharp, blunt and reflex corners; the regular polygon's now and then."""
    n = int(rng.integers(3, 14))
    rough = rng.choice([0, 0.6, 1], p=[0.1, 0.5, 0.4])
    angle = 2 * np.pi * (np.arange(n) + rough * rng.uniform(0, 0.9, n)) / n
    radius = 1 - rough * rng.uniform(0, 0.8, n)
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1) * [1, rng.uniform(0.4, 1)]


def _rounded(rng: np.random.Generator) -> np.ndarray:
    """A polygon with its corners cut again and again, into a smooth curve with bays."""
    points = _polygon(rng)
    for _ in range(4):
        after = np.roll(points, -1, axis=0)
        points = np.stack([0.75 * points + 0.25 * after, 0.25 * points + 0.75 * after], axis=1).reshape(-1, 2)
    return points


def _band(rng: np.random.Generator) -> np.ndarray:
    """Long and thin, straight or bent (U, S, C), its ends blunt or pointed."""
    s = np.linspace(0, 1, 60)
    direction = rng.uniform(-4, 4) * s + rng.uniform(-2, 2) * np.sin(2 * np.pi * s) if rng.random() < 0.7 else 0 * s
    line = np.cumsum(np.stack([np.cos(direction), np.sin(direction)], axis=1), axis=0) / len(s)
    normal = np.stack([-np.sin(direction), np.cos(direction)], axis=1)
    width = rng.uniform(0.03, 0.15) * (1 + rng.uniform(-0.6, 0.6) * s)
    if rng.random() < 0.3:
        width = width * (1 - s**4)
    left, right = line + normal * width[:, None], line - normal * width[:, None]
    return np.concatenate([right, left[::-1] if width[-1] > 0 else left[-2::-1]])


def _rounded_rectangle(rng: np.random.Generator) -> np.ndarray:
    """A rectangle with circular corners, or none."""
    height = rng.uniform(0.2, 1)
    radius = height * rng.uniform(0.02, 0.5)
    if rng.random() < 0.2:
        return np.array([[0, 0], [1, 0], [1, height], [0, height]])
    quarter = np.linspace(0, np.pi / 2, 12)
    centres = np.array([[1, height], [0, height], [0, 0], [1, 0]])
    inward = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * radius
    corners = [
        centre + shift + radius * np.stack([np.cos(quarter + k * np.pi / 2), np.sin(quarter + k * np.pi / 2)], axis=1)
        for k, (centre, shift) in enumerate(zip(centres, inward, strict=True))
    ]
    return np.concatenate(corners)


def _gear(rng: np.random.Generator) -> np.ndarray:
    """Teeth around a circle: flat, or pointed as a star's."""
    n = int(rng.integers(4, 17))
    depth = rng.uniform(0.1, 0.6)
    if rng.random() < 0.4:
        angle = np.pi * np.arange(2 * n) / n
        radius = np.where(np.arange(2 * n) % 2, 1 - depth, 1)
    else:
        share = np.array([0, rng.uniform(0.05, 0.25), 0.5, 0.5 + rng.uniform(0.05, 0.25)])
        angle = 2 * np.pi * (np.arange(n)[:, None] + share).ravel() / n
        radius = np.tile([1 - 0.6 * depth, 1, 1, 1 - 0.6 * depth], n)
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _skyline(rng: np.random.Generator) -> np.ndarray:
    """Right angles only: L, T, U, stairs."""
    n = int(rng.integers(2, 6))
    x = np.concatenate([[0], np.cumsum(rng.uniform(0.3, 1, n))])
    top = rng.uniform(0.3, 2, n)
    bottom = -rng.uniform(0.1, 1, n) * (rng.random() < 0.4)
    upper = np.stack([np.repeat(x, 2)[1:-1], np.repeat(top, 2)], axis=1)
    lower = np.stack([np.repeat(x, 2)[1:-1], np.repeat(bottom, 2)], axis=1)
    points = np.concatenate([lower, upper[::-1]])
    return points[np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-9]


_SORTS = _blob, _blob, _polygon, _polygon, _rounded, _band, _rounded_rectangle, _gear, _skyline


def _glyphs() -> list[np.ndarray]:
    # Here, as training itself does without matplotlib.
    import matplotlib
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    shapes = []
    for font in _FONTS:
        properties = FontProperties(fname=str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / font))
        for glyph in _GLYPHS:
            loops = TextPath((0, 0), glyph, size=100, prop=properties).to_polygons()
            outer = max(loops, key=lambda loop: abs(_area(loop)))[:-1]
            shapes.append(outer[np.linalg.norm(outer - np.roll(outer, 1, axis=0), axis=1) > 1e-6])
    return shapes


def naca(digits: str) -> np.ndarray:
    """A NACA airfoil of four digits, its trailing edge closed."""
    camber, place, thickness = int(digits[0]) / 100, max(int(digits[1]), 1) / 10, int(digits[2:]) / 100
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 60)))
    y = 5 * thickness * (0.2969 * np.sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))))
    ahead = x < place
    line = np.where(ahead, x * (2 * place - x) / place**2, (1 - 2 * place + x * (2 * place - x)) / (1 - place) ** 2)
    slope = np.where(ahead, 1 / place**2, 1 / (1 - place) ** 2) * 2 * camber * (place - x)
    normal = np.stack([-slope, np.ones_like(x)], axis=1) / np.hypot(slope, 1)[:, None]
    middle, offset = np.stack([x, camber * line], axis=1), y[:, None] * normal
    return np.concatenate([(middle - offset)[:-1], (middle + offset)[:0:-1]])


def _sections() -> list[np.ndarray]:
    """Rolled steel: IPE 200, HEB 200, UPE 200, L 100 x 10, T 100, in millimetres."""
    shapes = []
    for height, width, web, flange in ((200, 100, 5.6, 8.5), (200, 200, 9, 15)):
        right = [(web / 2, height / 2 - flange), (width / 2, height / 2 - flange), (width / 2, height / 2)]
        upper = right + [(-x, y) for x, y in right[::-1]]
        shapes.append(np.array(upper + [(-x, -y) for x, y in upper]))
    shapes.append(np.array([(0, 0), (80, 0), (80, 11), (6, 11), (6, 189), (80, 189), (80, 200), (0, 200)]))
    shapes.append(np.array([(0, 0), (100, 0), (100, 10), (10, 10), (10, 100), (0, 100)]))
    shapes.append(np.array([(-5.5, 0), (5.5, 0), (5.5, 89), (50, 89), (50, 100), (-50, 100), (-50, 89), (-5.5, 89)]))
    return [np.asarray(shape, dtype=np.float64) for shape in shapes]
