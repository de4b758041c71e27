"""What many outlines want, asked of the library together: a batch takes a small part of the time of one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .. import tessera
from ..tessera.counting import mesh_to_counts
from ..tessera.domains import domains_in_steps
from ..tessera.settings import Request
from ..tessera.settings import Settings as MeshSettings
from ..tessera.steps import Steps, within
from .outline import Outline
from .settings import NEAR_SHARE, Settings
from .targets import Targets, sizing_of

Outcomes = list[tessera.Mesh | tessera.ContourError]


@dataclass(frozen=True)
class Wanted:
    """One outline, and how it is to be meshed: at an edge length in world units, or with so many triangles."""

    outline: Outline
    targets: Targets
    settings: Settings
    edge_length: float
    n_triangles: int

    @property
    def by_count(self) -> bool:
        """Whether it is the number of triangles that counts."""
        return self.settings.size_by == "TRIANGLE_COUNT"


def mesh_wanted(wanted: Sequence[Wanted]) -> Steps[Outcomes]:
    """A mesh, or the ContourError that it has, for each outline; those whose settings allow it in one batch."""
    groups: dict[tuple[bool, MeshSettings], list[int]] = {}
    for number, one in enumerate(wanted):
        groups.setdefault((one.by_count, _mesh_settings(one)), []).append(number)
    results, done = {}, 0.0
    for (by_count, settings), numbers in groups.items():
        some, end = [wanted[number] for number in numbers], done + len(numbers) / len(wanted)
        if by_count:
            steps = _to_counts(some, settings)
        else:
            steps = _at_lengths(some, [one.edge_length for one in some], settings)
        results |= zip(numbers, (yield from within(steps, done, end)), strict=True)
        done = end
    return [results[number] for number in range(len(wanted))]


def _mesh_settings(one: Wanted) -> MeshSettings:
    settings = one.settings
    return MeshSettings(
        gradation=settings.gradation,
        boundary="keep" if settings.boundary == "KEEP" or one.outline.part is not None else "resample",
        corner_angle=settings.corner_angle,
        passes=settings.passes,
        flips=settings.flips,
        smooth=settings.smooth,
    )


def _to_counts(some: list[Wanted], settings: MeshSettings) -> Steps[Outcomes]:
    def mesh_at(numbers: list[int], lengths: list[float]) -> Steps[Outcomes]:
        return _at_lengths([some[number] for number in numbers], lengths, settings)

    return mesh_to_counts([one.outline.domain for one in some], [one.n_triangles for one in some], mesh_at)


def _at_lengths(some: list[Wanted], lengths: list[float], settings: MeshSettings) -> Steps[Outcomes]:
    requests, errors = [], {}
    for number, (one, length) in enumerate(zip(some, lengths, strict=True)):
        try:
            requests.append(_request(one, length))
        except tessera.ContourError as error:  # of its sizing
            errors[number] = error
    made = iter((yield from domains_in_steps(requests, settings)))
    return [errors[number] if number in errors else next(made) for number in range(len(some))]


def _request(one: Wanted, length: float) -> Request:
    sizing = sizing_of(one.settings, one.targets, length, NEAR_SHARE * length)
    return Request(one.outline.domain, length, sizing, min(one.settings.min_edge_length, length) or None)
