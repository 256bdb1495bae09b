"""Particles for tests of a fluid system without a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sim.fluid.system import FluidSystem


def load(
    system: FluidSystem,
    position: np.ndarray,
    velocity: np.ndarray | float = 0.0,
    density: np.ndarray | float = 0.0,
    acceleration: np.ndarray | float = 0.0,
) -> None:
    """Hold particles at these positions [m], shape [n, 3], with these velocities [m/s], densities [kg/m^3] and
    accelerations [m/s^2], numbered as they come; what else is saved of them is zero."""
    from sim.fluid.system import PARTICLES

    count = len(position)
    width = {"vec4": (4,), "vec2i": (2,), "real": ()}
    state = {
        field.name: np.zeros((count, *width[field.element]), np.int32 if field.element == "vec2i" else np.float32)
        for field in PARTICLES
        if field.saved
    }
    for name, values in (("position", position), ("velocity", velocity), ("acceleration", acceleration)):
        state[name][:, :3] = values
    state["velocity"][:, 3] = density
    state["tag"][:, 0] = np.arange(count)
    system.load(state)
