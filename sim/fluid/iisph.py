"""Implicit incompressible SPH (Ihmsen et al. 2014): pressures that keep densities at rest density after the step.

The equations are linear in the way that pressures push particles. In an impact, or where a small error is asked for,
that is too far: what they then meet where they would go is found, and pushed off, until it is no more than asked for.
"""

import math
from typing import ClassVar

import taichi as ti

from sim.arrays import Declared, Vec4Array, real, vec4
from sim.fluid import projection
from sim.fluid.conjugate_gradients import ConjugateGradients, Pressures, Solution
from sim.fluid.incompressible import Incompressible, kick
from sim.fluid.projection import Projection
from sim.fluid.solids import remember_way
from sim.fluid.system import FluidSystem

FAR = 0.15
"""Of a spacing: pressures that push a particle further are followed by another look where it would go; less where a
smaller error than COARSE is asked for, since what the equations leave out grows by the square of the way."""
COARSE = 5e-4
MOST_LOOKS = 4
"""After the first; each leaves about the square of the way of the one before."""


class Iisph(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS = projection.ARRAYS
    FINDS_FRICTION = True
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("pressed", "vec4", "way by pressure in the last step [m]; w: q that acted after it", saved=False),
        Declared("corrected", "vec4", "share of later looks of that way [m]; w: their share of q", saved=False),
    )

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        self.projection = Projection(system, self.momentum.viscosity)
        self.gradients = ConjugateGradients(system)

    def examine(self, dt: float) -> None:
        self.projection.prepare(dt)

    def press(self, dt: float) -> dict[str, float]:
        settings = self.settings
        solution = self._push(dt, settings.min_iterations, settings.max_iterations, Pressures.FOLLOWED)
        iterations, capped = solution.iterations, solution.capped
        particles, with_samples = self.system.particles, self.system.boundary.count > 0
        if with_samples:
            remember_way(self.system.count, dt, particles.kept, particles.pressed)
            particles.corrected.fill(0.0)
        far = FAR * min(1.0, math.sqrt(settings.density_error / COARSE)) * self.system.spec.spacing
        for _ in range(MOST_LOOKS):
            if solution.way <= far or iterations >= settings.max_iterations:
                break
            solution = self._push(dt, 0, settings.max_iterations - iterations, Pressures.RAISED)
            iterations, capped = iterations + solution.iterations, solution.capped
            if with_samples and solution.iterations:
                _remember_correction(
                    self.system.count, dt, particles.kept, particles.search, particles.pressed, particles.corrected
                )
        return {"pressure_iterations": iterations, "capped": capped}

    def _push(self, dt: float, fewest: int, most: int, pressures: Pressures) -> Solution:
        """Add to velocities what keeps densities at rest density after the step, as far as they do not yet."""
        system = self.system
        self.projection.predict(dt)
        tolerance = self.settings.density_error * system.spec.rest_density
        solution = self.gradients.solve(dt, tolerance, fewest, most, pressures)
        if solution.iterations:
            kick(system.count, dt, system.particles.velocity, system.particles.kept)
        return solution


@ti.kernel
def _remember_correction(
    count: ti.i32, dt: real, push: Vec4Array, search: Vec4Array, pressed: Vec4Array, corrected: Vec4Array
):
    for i in range(count):
        way = dt * dt * push[i].xyz
        pressed[i].xyz += way
        corrected[i] += vec4(way, search[i].x)
