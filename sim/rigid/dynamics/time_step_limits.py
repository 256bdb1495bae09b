"""Largest time steps of bodies that obey forces."""

TURN = 0.1
"""Greatest turn of a body in a step [rad]."""
DISPLACEMENT = 0.5
"""Greatest displacement of a body in a step, over its own size."""
TERMS = {"rigid step": "rigid.max_step", "spin": "the spin of a body", "travel": "the speed of a body"}
"""What limits steps, in words."""


def step_limits(longest: float, relative_speed: float, spin: float) -> dict[str, float]:
    """Steps [s] by what limits them: the `longest` that the scene allows, the greatest speed over a body's own size
    [1/s], and the greatest angular velocity [rad/s]."""
    limits = {"rigid step": longest}
    if spin > 0:
        limits["spin"] = TURN / spin
    if relative_speed > 0:
        limits["travel"] = DISPLACEMENT / relative_speed
    return limits


def limiting_term(term: str, speed: float, spin: float) -> tuple[str, str]:
    """What one of `step_limits` comes from, by the greatest speed [m/s] and angular velocity [rad/s], and what would
    help."""
    match term:
        case "spin":
            return f"{TERMS[term]} ({spin:.3g} rad/s)", "let it turn more slowly"
        case "travel":
            return f"{TERMS[term]} ({speed:.3g} m/s)", "use lower speeds or larger bodies"
    return TERMS[term], "raise it"
