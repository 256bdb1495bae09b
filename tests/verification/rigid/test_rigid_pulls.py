"""A critically damped spring: x - to = (x0 - to) (1 + w t) exp(-w t), with w = 2 pi / period."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.bodies import G, ball, box, part, step

PERIOD, FAR = 0.4, 0.3
PACE = 2 * np.pi / PERIOD


def off(dt: float) -> float:
    """Greatest difference to the closed form, over the way, in one period."""
    body = box((0.1, 0.2, 0.3), position=(1, 2, 3), pulls=[{"to": (1, 2 + FAR, 3), "period": PERIOD}])
    made = part({"body": body}, gravity=(0, 0, 0))
    wrong = []

    def look(time: float) -> None:
        left = FAR * (1 + PACE * time) * np.exp(-PACE * time)
        wrong.append(np.abs(made.position[0] - [1, 2 + FAR - left, 3]).max() / FAR)

    step(made, PERIOD, look, dt)
    return max(wrong)


def test_a_body_is_drawn_as_by_a_critically_damped_spring():
    coarse, fine = off(0.002), off(0.001)
    assert fine < PACE * 0.001
    assert coarse / fine == pytest.approx(2.0, rel=0.1), "implicit Euler is of first order"


def test_its_weight_stretches_the_spring():
    made = part({"ball": ball(0.05, position=(0, 1, 0), pulls=[{"to": (0, 1, 0), "period": PERIOD}])})
    step(made, 5 * PERIOD, dt=0.002)
    assert made.position[0, 1] == pytest.approx(1 - G / PACE**2, abs=1e-6)


def test_two_springs_draw_to_the_middle_however_long_the_step():
    pulls = [{"to": (x, 0, 0), "period": 0.02} for x in (-1, 1)]
    made = part({"ball": ball(0.05, position=(0.3, 0, 0), pulls=pulls)}, gravity=(0, 0, 0))
    ways = []
    step(made, 2.0, lambda time: ways.append(abs(made.position[0, 0])), dt=0.1)
    assert max(ways) <= 0.3 and ways[-1] < 1e-3
