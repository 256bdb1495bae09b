"""Steps of a world without files, none of which a run would repeat."""

from __future__ import annotations

from typing import Any

from sim.run.failure import find_fault


def advance(world: Any, dt: float, until: float) -> dict[str, float]:
    """Step by dt [s] to a time [s]; returns what solvers tell of the step.

    Raises AssertionError where the step cannot be trusted, as a run finds it.
    """
    stats = world.advance(dt, until)
    fault = find_fault(world, world.measure(), dt)
    assert fault is None, f"at {until:.4g} s: {fault.what}"
    return stats
