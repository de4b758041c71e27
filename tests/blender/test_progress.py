"""Work in steps: in slices, with its names, and closed."""

import time

import pytest

from addon import tessera
from addon.blender.progress import WORDS, Done, advance, named
from addon.tessera import Progress


def work(n_steps=10, seconds=0.0):
    for number in range(n_steps):
        time.sleep(seconds)
        yield Progress("networks", number / n_steps)
    return "made"


def test_slices_are_about_as_long_as_asked_for():
    steps, outcomes, slices = work(20, 0.01), [], []
    while not isinstance(outcomes[-1] if outcomes else None, Done):
        start = time.perf_counter()
        outcomes.append(advance(steps, 0.05))
        slices.append(time.perf_counter() - start)
    assert outcomes[-1] == Done("made")
    assert 3 <= len(outcomes) <= 6
    assert all(0.05 <= took < 0.2 for took in slices[:-1])


def test_steps_say_what_they_work_on():
    steps, seen = named(work(4), "Logo"), []
    with pytest.raises(StopIteration) as end:
        while True:
            seen.append(next(steps))
    assert [progress.share for progress in seen] == [0, 0.25, 0.5, 0.75]
    assert seen[0].stage == "Logo: placing triangles" and end.value.value == "made"


def test_there_are_words_for_every_stage():
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    stages = {progress.stage for progress in tessera.mesh_in_steps([square], 0.2, smooth=1)}
    assert stages == set(WORDS)


def test_what_is_closed_stops():
    stopped = []

    def watched():
        try:
            yield from work()
        finally:
            stopped.append(True)

    steps = named(watched(), "Logo")
    next(steps)
    steps.close()
    assert stopped
