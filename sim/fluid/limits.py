"""Largest stable time steps, for every solver (Monaghan 1992, sec. 10; `half` is half the support radius)."""

import math


def force_limit(half: float, acceleration: float) -> float:
    """0.25 sqrt(half / a) [s]."""
    return 0.25 * math.sqrt(half / acceleration) if acceleration > 0 else math.inf


def viscosity_limit(half: float, viscosity: float) -> float:
    """0.125 half^2 / nu [s], for explicit viscosity [m^2/s]."""
    return 0.125 * half * half / viscosity if viscosity > 0 else math.inf


def way_limit(half: float, cfl: float, speed: float, acceleration: float) -> float:
    """The step t [s] in which a particle moves `cfl` times `half`: v t + a t^2 = cfl half."""
    way = cfl * half
    root = math.sqrt(speed * speed + 4.0 * acceleration * way)
    return 2.0 * way / (speed + root) if root > 0 else math.inf
