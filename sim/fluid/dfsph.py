"""Divergence-free SPH (Bender & Koschier 2015, 2017).

One system of equations keeps densities at rest density after the step, as in IISPH; a second one takes from the
velocities at the new positions what would compress the fluid further. Both start from their own last pressures.
"""

from typing import ClassVar

import taichi as ti

from sim.arrays import Vec4Array
from sim.fluid.iisph import Iisph
from sim.fluid.incompressible import kick


class Dfsph(Iisph):
    """Advances a FluidSystem."""

    STATISTICS: ClassVar[tuple[str, ...]] = ("pressure_iterations", "divergence_iterations")

    def advance(self, dt: float) -> dict[str, float]:
        """The step of IISPH, and the divergence solve after it; acceleration.w keeps the pressures of the latter."""
        told = super().advance(dt)
        count, particles, settings = self.system.count, self.system.particles, self.settings
        _swap(count, particles.position, particles.acceleration)
        tolerance = settings.divergence_error * self.system.spec.rest_density
        solution = self.projection.solve(dt, tolerance, 1, settings.max_iterations)
        kick(count, dt, particles.velocity, particles.kept)
        _remember(count, particles.position, particles.pressed)
        _swap(count, particles.position, particles.acceleration)
        told["divergence_iterations"] = solution.iterations
        told["capped"] += solution.capped
        return told


@ti.kernel
def _swap(count: ti.i32, position: Vec4Array, acceleration: Vec4Array):
    """Exchange the pressures of the two systems of equations."""
    for i in range(count):
        q = position[i].w
        position[i].w = acceleration[i].w
        acceleration[i].w = q


@ti.kernel
def _remember(count: ti.i32, position: Vec4Array, pressed: Vec4Array):
    for i in range(count):
        pressed[i].w = position[i].w
