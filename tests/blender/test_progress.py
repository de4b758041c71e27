"""Work in steps: run to its end, in slices, and as a part of more."""

import time

import pytest

from addon.blender.progress import Done, advance, finish, within
from addon.tessera import Progress


def work(n_steps=10, seconds=0.0):
    for number in range(n_steps):
        time.sleep(seconds)
        yield Progress("stage", number / n_steps)
    return "made"


def test_steps_run_to_their_end():
    assert finish(work()) == "made"


def test_slices_are_about_as_long_as_asked_for():
    steps, outcomes, slices = work(20, 0.01), [], []
    while not isinstance(outcomes[-1] if outcomes else None, Done):
        start = time.perf_counter()
        outcomes.append(advance(steps, 0.05))
        slices.append(time.perf_counter() - start)
    assert outcomes[-1] == Done("made")
    assert 3 <= len(outcomes) <= 6
    assert all(0.05 <= took < 0.2 for took in slices[:-1])


def test_steps_as_a_part_of_more():
    steps, seen = within(work(4), 0.5, 0.75, "Logo"), []
    with pytest.raises(StopIteration) as end:
        while True:
            seen.append(next(steps))
    assert [progress.share for progress in seen] == pytest.approx([0.5, 0.5625, 0.625, 0.6875])
    assert seen[0].stage == "Logo: stage" and end.value.value == "made"


def test_what_is_closed_stops():
    stopped = []

    def watched():
        try:
            yield from work()
        finally:
            stopped.append(True)

    steps = within(watched(), 0, 1)
    next(steps)
    steps.close()
    assert stopped
