"""How frames are divided into steps."""

from __future__ import annotations

import pytest

from sim.run.time_steps import fit


def steps(length: float, fps: float, frames: int, *, even: bool) -> int:
    """How many steps a run of so many frames takes, none of which may be longer than `length` [s]."""
    time, number = 0.0, 0
    for frame in range(1, frames + 1):
        while time < frame / fps - 1e-12:
            rest = frame / fps - time
            dt = fit(length, rest, even=even)
            time = frame / fps if dt == rest else time + dt
            number += 1
    return number


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize(("fps", "in_a_frame"), [(500, 1), (100, 5), (25, 20), (50, 10), (20, 25)])
def test_a_step_that_fits_into_a_frame_is_taken_as_often_as_it_fits(fps, in_a_frame, even):
    """Rounding of times made some frames a step longer: 500 frames of 2 ms took 968 steps of up to 2 ms."""
    assert steps(1 / (fps * in_a_frame), fps, 500, even=even) == 500 * in_a_frame


def test_no_step_is_longer_than_it_may_be_and_the_last_two_are_even():
    assert fit(0.3, 1.0, even=True) == 0.3
    assert fit(0.3, 0.4, even=True) == 0.2
    assert fit(0.3, 0.4, even=False) == 0.3
    assert fit(0.3, 0.25, even=True) == 0.25
