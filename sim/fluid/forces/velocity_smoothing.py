"""What evens out the velocities of neighbours in a step of its own, after the forces: implicit viscosity and XSPH.

Only what a scene asks for is imported.
"""

import math

import numpy as np

from sim.device.arrays import Declared
from sim.fluid.forces.friction import find_wall_friction
from sim.fluid.spec import Fluid
from sim.fluid.system import FluidSystem
from sim.fluid.time_step_limits import force_limit, viscosity_limit

SHARE = 0.4
"""A step is taken to last while the fastest signal goes this share of half the support radius."""


def viscosity_is_implicit(fluid: Fluid, gravity: np.ndarray, signal: float) -> bool:
    """Whether implicit viscosity is asked for, or for `auto` would be the better choice: where gravity and signals of
    this speed [m/s] would allow longer steps than explicit viscosity."""
    if fluid.viscosity == 0 or fluid.viscosity_solver == "explicit":
        return False
    half = 0.5 * fluid.support_radius
    explicit = viscosity_limit(half, fluid.viscosity, find_wall_friction(fluid).strongest)
    others = force_limit(half, float(np.linalg.norm(gravity))), SHARE * half / signal if signal > 0 else math.inf
    return fluid.viscosity_solver == "implicit" or bool(explicit < min(others))


def smoothing_arrays(fluid: Fluid, implicit: bool) -> tuple[Declared, ...]:
    """The arrays of particles that `VelocitySmoothing` needs."""
    arrays: tuple[Declared, ...] = ()
    if implicit:
        from sim.fluid.forces import implicit_viscosity

        arrays += implicit_viscosity.ARRAYS
    if fluid.xsph > 0:
        from sim.fluid.forces import xsph

        arrays += xsph.ARRAYS
    return arrays


class VelocitySmoothing:
    """The steps that a system's settings ask for."""

    def __init__(self, system: FluidSystem):
        self._viscosity = self._xsph = None
        if system.implicit_viscosity:
            from sim.fluid.forces.implicit_viscosity import Viscosity

            self._viscosity = Viscosity(system)
        if system.spec.xsph > 0:
            from sim.fluid.forces.xsph import Xsph

            self._xsph = Xsph(system)

    def smooth(self, dt: float) -> dict[str, float]:
        """Even out velocities over a step dt [s]; positions, densities and neighbours are given. Returns statistics."""
        stats = self._viscosity.apply(dt) if self._viscosity else {"capped": False}
        if self._xsph:
            self._xsph.apply()
        return stats | {"viscosity_capped": stats["capped"]}
