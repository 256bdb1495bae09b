"""Estimates of the time left, by series of what frames took."""

from __future__ import annotations

import pytest

from common.time_left import RECENT, TimeLeft, duration

CONSTANT = [0.02] + 24 * [1.5]
"""Frame 0 is only written; every other one is as dear as the others."""
RENDERED = [4.1, 0.82, 0.80, 0.83, 0.81, 0.79, 0.80, 0.82]
"""A block of pictures: the first loads the scene and Cycles' kernels."""
DROP = [
    *(0.05, 0.61, 0.60, 0.59, 0.60, 0.62, 0.60, 0.61, 0.60, 0.63, 1.9, 4.8, 6.2),
    *(6.0, 5.8, 5.9, 6.1, 5.9, 6.0, 5.8, 5.9, 6.0, 5.9, 6.1, 5.8),
]
"""A drop falls, and meets the floor in frame 10: steps get ten times shorter."""


def estimates(series):
    """What is estimated after each frame, over what the others will take; None where nothing is."""
    left, found = TimeLeft(len(series)), []
    for index, seconds in enumerate(series):
        left.took(seconds)
        rest = sum(series[index + 1 :])
        found.append(None if left.seconds is None else left.seconds / rest)
    return found


@pytest.mark.parametrize("series", [CONSTANT, RENDERED, DROP])
def test_nothing_is_said_before_it_can_be_known(series):
    ratios = estimates(series)
    assert ratios[0] is None
    assert None not in ratios[1:-1]
    assert ratios[-1] is None


def test_constant_costs():
    assert estimates(CONSTANT)[1:-1] == pytest.approx([1.0] * (len(CONSTANT) - 2))


def test_a_slow_first_frame_does_not_count():
    assert estimates(RENDERED)[1:-1] == pytest.approx([1.0] * (len(RENDERED) - 2), rel=0.05)


def test_steps_that_get_shorter():
    """Nobody knows of the impact before; soon after it, it is as if it had always been so."""
    ratios = estimates(DROP)
    assert min(ratios[1:10]) > 0.1
    assert ratios[12 + RECENT - 1 : -1] == pytest.approx([1.0] * (len(DROP) - 12 - RECENT), rel=0.1)


def test_words():
    left = TimeLeft(100)
    left.took(300)
    assert str(left) == ""
    left.took(2)
    assert str(left) == ", about 3 min left"
    assert [duration(s) for s in (4.4, 89, 90, 3600, 3900)] == ["4 s", "89 s", "2 min", "1 h 00 min", "1 h 05 min"]
