"""Springs that draw bodies to places."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.rigid.spec import Pull


def pulled(pulls: Sequence[Pull], position: np.ndarray, velocity: np.ndarray, dt: float) -> np.ndarray:
    """Mean acceleration [m/s^2] by critically damped springs over a step of dt [s], shape [3], of a body that would
    have `velocity` [m/s] after it by whatever else acts.

    x'' = w^2 (to - x) - 2 w x' with w = 2 pi / period, of each spring; all together by implicit Euler, which holds for
    any dt.
    """
    rate, damping = np.zeros(3), 1.0
    for pull in pulls:
        frequency = 2 * math.pi / pull.period
        rate += frequency**2 * (np.array(pull.to) - position)
        damping += 2 * frequency * dt + (frequency * dt) ** 2
    return ((velocity + dt * rate) / damping - velocity) / dt
