"""Divergence-free SPH (Bender & Koschier 2015, 2017).

One system of equations keeps densities at rest density after the step, as in IISPH; a second one takes from the
velocities at the new positions what would compress the fluid further, where that is more than is asked for.
"""

from typing import ClassVar

import taichi as ti

from sim.arrays import Vec4Array
from sim.fluid.iisph import Iisph


class Dfsph(Iisph):
    """Advances a FluidSystem."""

    STATISTICS: ClassVar[tuple[str, ...]] = ("pressure_iterations", "divergence_iterations")

    def advance(self, dt: float) -> dict[str, float]:
        """The step of IISPH, and the divergence solve after it."""
        told = super().advance(dt)
        if not self.system.count:
            return told
        particles, settings = self.system.particles, self.settings
        tolerance = settings.divergence_error * self.system.spec.rest_density
        solution = self.gradients.solve(dt, tolerance, 0, settings.max_iterations, warm=False, ahead=0.0)
        if solution.iterations:
            if self.system.bodies:
                self.system.bodies.nudge(dt)
                self.system.meet()
            self.system.lead()
            self.examine(dt)
            if self.system.remembers:
                _remember(self.system.count, particles.search, particles.pressed)
        told["divergence_iterations"] = solution.iterations
        told["capped"] += solution.capped
        return told


@ti.kernel
def _remember(count: ti.i32, search: Vec4Array, pressed: Vec4Array):
    for i in range(count):
        pressed[i].w = search[i].x
