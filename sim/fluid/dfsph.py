"""Divergence-free SPH (Bender & Koschier 2015, 2017), with corrected gradients.

Two systems of equations are solved in a step. The first takes from velocities what would compress the fluid, by the
gradients of `sim.fluid.gradient_correction`: those are right however particles lie, but the density that follows from
positions is not what they say, since it depends on how they lie. So the second one, with the gradients of the density,
moves particles apart without giving them velocities (as particle shifting does, Lind et al. 2012); what it leaves is
part of the compression that the first one takes away in the next step.
"""

from typing import ClassVar

import taichi as ti

from sim.arrays import Declared, Vec4Array, real
from sim.fluid import gradient_correction, projection
from sim.fluid.conjugate_gradients import ConjugateGradients
from sim.fluid.gradient_correction import compression_rates
from sim.fluid.hyperviscosity import Hyperviscosity
from sim.fluid.incompressible import Incompressible
from sim.fluid.projection import Projection
from sim.fluid.solids import remember_way
from sim.fluid.system import FluidSystem

MOST_LOOKS = 5
"""At where particles would go, to move them apart: what equations leave out falls by the square of the way."""
LESS = 0.5
"""A look that leaves more than this of the mean compression was the last: fluid that has no room can not be moved
apart."""


class Dfsph(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (
        *projection.ARRAYS,
        *gradient_correction.ARRAYS,
        Declared("pace", "vec4", "velocity without the way apart [m/s]", sorted=False, saved=False),
    )
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("pressed", "vec4", "way by pressure, and apart, in the last step [m]", saved=False),
    )
    STATISTICS: ClassVar[tuple[str, ...]] = ("pressure_iterations", "divergence_iterations")
    FINDS_FRICTION = True

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        self.projection = Projection(system, self.momentum.viscosity)
        self.apart = ConjugateGradients(system)
        self.divergence = ConjugateGradients(system, corrected=True)
        self.hyperviscosity = Hyperviscosity(system, self.settings.hyperviscosity)

    def examine(self, dt: float) -> None:
        self.projection.prepare()

    def press(self, dt: float) -> dict[str, float]:
        system, particles, settings = self.system, self.system.particles, self.settings
        self.hyperviscosity.apply(dt)
        system.meet(dt)
        compression_rates(system, dt, self.projection.smallest_diagonal)
        if system.bodies:
            system.bodies.expect(dt)
        solution = self.divergence.solve(
            dt,
            settings.divergence_error * system.spec.rest_density,
            settings.min_iterations,
            settings.max_iterations,
            warm=True,
            ahead=dt,
        )
        if system.bodies:
            system.bodies.take(dt)
        if system.remembers:
            remember_way(system.count, dt, particles.kept, particles.pressed)
        _keep(system.count, particles.velocity, particles.pace)
        iterations, capped = self._part(dt)
        told = {"pressure_iterations": iterations, "divergence_iterations": solution.iterations}
        return told | {"capped": solution.capped or capped}

    def _part(self, dt: float) -> tuple[int, bool]:
        """Add to velocities the way apart, until no more is compressed where particles go than was asked for; returns
        the iterations, and whether more is."""
        settings, tolerance = self.settings, self.settings.density_error * self.system.spec.rest_density
        iterations, last = 0, float("inf")
        for _ in range(MOST_LOOKS):
            self.projection.predict(dt)
            mean, worst = self.apart.compression()
            if mean <= tolerance and worst <= self.apart.worst:
                return iterations, iterations >= settings.max_iterations
            if mean > LESS * last or iterations >= settings.max_iterations:
                break
            last = mean
            iterations += self.apart.solve(
                dt, tolerance, 1, settings.max_iterations - iterations, warm=False, ahead=dt, alone=True
            ).iterations
        return iterations, iterations >= settings.max_iterations

    def halt(self, dt: float) -> None:
        """Take the way apart, which particles have gone in this step, from their velocities."""
        system, particles = self.system, self.system.particles
        if system.remembers:
            _remember(system.count, dt, particles.velocity, particles.pace, particles.pressed)
        _keep(system.count, particles.pace, particles.velocity)
        system.lead()


@ti.kernel
def _keep(count: ti.i32, velocity: Vec4Array, pace: Vec4Array):
    for i in range(count):
        pace[i].xyz = velocity[i].xyz


@ti.kernel
def _remember(count: ti.i32, dt: real, velocity: Vec4Array, pace: Vec4Array, pressed: Vec4Array):
    for i in range(count):
        pressed[i].xyz += dt * (velocity[i].xyz - pace[i].xyz)
