"""Largest time steps of bodies that obey forces."""

TURN = 0.1
"""Greatest turn of a body in a step [rad]."""
WAY = 0.5
"""Greatest way of a body in a step, over its own size."""
TERMS = {"rigid step": "rigid.max_step", "spin": "the spin of a body", "travel": "the speed of a body"}
"""What limits steps, in words."""


def step_limits(longest: float, pace: float, spin: float) -> dict[str, float]:
    """Steps [s] by what limits them: the `longest` that the scene allows, the greatest speed over a body's own size
    [1/s], and the greatest angular velocity [rad/s]."""
    limits = {"rigid step": longest}
    if spin > 0:
        limits["spin"] = TURN / spin
    if pace > 0:
        limits["travel"] = WAY / pace
    return limits
