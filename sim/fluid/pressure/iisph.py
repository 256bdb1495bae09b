"""Implicit incompressible SPH (Ihmsen et al. 2014): pressures that keep densities at rest density after the step.

The equations are linear in the way that pressures push particles. In an impact, or where a small error is asked for,
that is too far: what they then meet where they would go is found, and pushed off, until it is no more than asked for.
"""

import math
from typing import ClassVar

from sim.device.arrays import Declared, Vec4Array, real, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.samples import remember_displacement
from sim.fluid.layout import Q
from sim.fluid.pressure import projection
from sim.fluid.pressure.conjugate_gradients import ConjugateGradients, Solution
from sim.fluid.pressure.incompressible import Incompressible, kick
from sim.fluid.pressure.projection import Projection
from sim.fluid.system import FluidSystem

FAR = 0.15
"""Of a spacing: pressures that push a particle further are followed by another look where it would go; less where a
smaller error than COARSE is asked for, since what the equations leave out grows by the square of the way."""
COARSE = 5e-4
MOST_LOOKS = 4
"""After the first; each leaves about the square of the way of the one before."""
LESS = 0.5
"""Where a look leaves more than this of the mean compression, it is not the way that is too far: fluid that has no room
cannot be pushed apart, and to try would heat it."""


class Iisph(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (*projection.ARRAYS, Incompressible.BEFORE)
    FINDS_FRICTION = True
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("pressed", "vec4", "way by pressure in the last step [m]", saved=False),
        Declared("corrected", "vec4", "share of later looks of that way [m]; w: their share of q", saved=False),
    )

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        self.projection = Projection(system, self.momentum.viscosity)
        self.gradients = ConjugateGradients(system)

    def examine(self, dt: float) -> None:
        self.projection.prepare()

    def solve_pressures(self, dt: float) -> dict[str, float]:
        system, particles, settings = self.system, self.system.particles, self.settings
        tolerance = settings.density_error * system.spec.rest_density / self.deep
        self.projection.predict(dt)
        if system.bodies:
            system.bodies.subtract_predicted(dt)
        solution = self.gradients.solve(
            dt, tolerance, settings.min_iterations, self.most_iterations, warm=True, ahead=dt
        )
        if system.bodies:
            system.bodies.apply(dt)
        if system.remembers:
            remember_displacement(system.count, dt, particles.kept, particles.pressed)
            particles.corrected.fill(0.0)
        return self._look_again(dt, tolerance, solution)

    def _look_again(self, dt: float, tolerance: float, solution: Solution) -> dict[str, float]:
        """Push off what is still compressed where particles will be, as long as that helps."""
        most, iterations, capped = self.most_iterations, solution.iterations, solution.capped
        far = FAR * min(1.0, math.sqrt(self.settings.density_error / COARSE)) * self.system.spec.spacing
        last = math.inf
        for _ in range(MOST_LOOKS):
            if solution.displacement <= far or iterations >= most:
                break
            self.projection.predict(dt)
            mean, worst = self.gradients.compression()
            if mean > max(tolerance, LESS * last):
                kick(self.system.count, -dt, self.system.particles.velocity, self.system.particles.kept)
                if self.system.bodies:
                    self.system.bodies.revert(dt)
                self._take(dt, -1.0)
                break
            if mean <= tolerance and worst <= self.gradients.worst:
                break
            last = mean
            solution = self.gradients.solve(dt, tolerance, 1, most - iterations, warm=False, ahead=dt)
            self._take(dt, 1.0)
            if self.system.bodies:
                self.system.bodies.apply(dt)
            iterations, capped = iterations + solution.iterations, solution.capped
        return {"pressure_iterations": iterations, "capped": capped}

    def _take(self, dt: float, sign: float) -> None:
        """Count what was found to the pressures that act, or take it off with the sign -1."""
        system, particles = self.system, self.system.particles
        _take(system.count, sign, particles.position, particles.acceleration, particles.kept, particles.search)
        if system.remembers:
            _remember_correction(
                system.count, sign, dt, particles.kept, particles.search, particles.pressed, particles.corrected
            )


@ti.kernel
def _take(count: ti.i32, sign: real, position: Vec4Array, acceleration: Vec4Array, kept: Vec4Array, search: Vec4Array):
    for i in range(count):
        position[i][Q] += sign * search[i].x
        acceleration[i].w += sign * kept[i].w


@ti.kernel
def _remember_correction(
    count: ti.i32,
    sign: real,
    dt: real,
    pressure_acceleration: Vec4Array,
    search: Vec4Array,
    pressed: Vec4Array,
    corrected: Vec4Array,
):
    for i in range(count):
        displacement = sign * dt * dt * pressure_acceleration[i].xyz
        pressed[i].xyz += displacement
        corrected[i] += vec4(displacement, sign * search[i].x)
