"""The two solves of divergence-free SPH (Bender & Koschier 2015, 2017), with pressures found by projected conjugate
gradients, and with corrected gradients: what `dfsph` is by default. The published iteration is
`sim.fluid.pressure.dfsph_jacobi`.

Two systems of equations are solved in a step. The first takes from velocities what would compress the fluid, by the
gradients of `sim.fluid.pressure.gradient_correction`: those are right however particles lie, but the density that
follows from positions is not what they say, since it depends on how they lie. So the second one, with the gradients of
the density, moves particles apart without giving them velocities (as particle shifting does, Lind et al. 2012); what it
leaves is part of the compression that the first one takes away in the next step.
"""

from typing import ClassVar

from sim.device.arrays import Declared, RealArray, Vec4Array, real
from sim.device.compiler import ti
from sim.fluid.boundary.samples import remember_displacement
from sim.fluid.forces.hyperviscosity import Hyperviscosity
from sim.fluid.layout import Q
from sim.fluid.pressure import gradient_correction, projection
from sim.fluid.pressure.conjugate_gradients import ConjugateGradients, Solution
from sim.fluid.pressure.gradient_correction import compression_rates
from sim.fluid.pressure.incompressible import Incompressible
from sim.fluid.pressure.projection import Projection
from sim.fluid.system import FluidSystem

UNEVEN, UNEVEN_BESIDE_BODIES = 10, 3
"""No particle is left more than this many times as much of the divergence as the mean may be: what begins at one place,
as where a body is let go, is little in the mean. The force on a body is that of a few particles: it would be uncertain
by some percent, and a light one that is let go would set off by a fifth too slowly."""
MEAN_BESIDE_BODIES = 0.1
"""Of the mean that may be left elsewhere: what changes slowly around a body is little in every particle, and yet it
is a part of the force on it for some steps."""
MOST_LOOKS = 5
"""At where particles are, to move them apart: what equations leave out falls by the square of the way."""
SHORT = 0.1
"""After a way that is shorter than this share of the support, they leave out less than a hundredth."""
AGAIN, LOCAL = 0.5, 10
"""Of the pressures that moved particles apart, so much is tried first in the next step (as Ihmsen et al. 2014 do), if
there were at most so many iterations, each of which takes pressures one layer further: those that reach far lift a deep
column as a whole, and it falls back."""
LESS = 0.5
"""A look that leaves more than this of the mean compression was the last: fluid that has no room cannot be moved
apart."""


class Dfsph(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (
        *projection.ARRAYS,
        *gradient_correction.ARRAYS,
        Incompressible.BEFORE,
        Declared("apart_pressure", "real", "a share of the q that moved apart in the last step", saved=False),
        Declared("apart_change", "real", "L q of it", saved=False),
    )
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("pressed", "vec4", "way by pressure, and apart, in the last step [m]", saved=False),
    )
    STATISTICS: ClassVar[tuple[str, ...]] = ("pressure_iterations", "divergence_iterations")
    ERRORS = ("density_error", "divergence_error")
    FINDS_FRICTION = True
    HOLDS_ALONG_ALL = True

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        self.projection = Projection(system, self.momentum.viscosity)
        self.apart = ConjugateGradients(system)
        self.divergence = ConjugateGradients(system, corrected=True)
        self.hyperviscosity = Hyperviscosity(system, self.settings.hyperviscosity)

    def examine(self, dt: float) -> None:
        self.projection.prepare(diagonal=False)

    def solve_pressures(self, dt: float) -> dict[str, float]:
        system, particles, settings = self.system, self.system.particles, self.settings
        tolerance = settings.divergence_error * system.spec.rest_density / self.deep
        if system.boundary.shapes.bodies:
            self.divergence.worst = UNEVEN_BESIDE_BODIES * tolerance
            tolerance *= MEAN_BESIDE_BODIES
        else:
            self.divergence.worst = UNEVEN * tolerance
        self.hyperviscosity.apply(dt)
        system.update_half_spaces(dt)
        compression_rates(system, dt, self.projection.smallest_diagonal)
        if system.bodies:
            system.bodies.subtract_predicted(dt)
        solution = self.divergence.solve(
            dt,
            tolerance,
            settings.min_iterations,
            self.most_iterations,
            warm=True,
            ahead=dt,
        )
        if system.bodies:
            system.bodies.apply(dt)
            system.bodies.hold_along_surfaces(dt)
        if system.remembers:
            remember_displacement(system.count, dt, particles.kept, particles.pressed)
        return {"divergence_iterations": solution.iterations, "capped": solution.capped}

    def separate(self, dt: float) -> dict[str, float]:
        tolerance = self.settings.density_error * self.system.spec.rest_density
        iterations, most, last = 0, self.most_iterations, float("inf")
        for _ in range(MOST_LOOKS):
            self.projection.predict(0.0)
            mean, worst = self.apart.compression()
            if mean <= tolerance and worst <= self.apart.worst:
                break
            if mean > LESS * last or iterations >= most:
                break
            solution = self._move_apart(dt, tolerance, most - iterations)
            iterations += solution.iterations
            if LESS * mean <= tolerance and solution.displacement < SHORT * self.system.h:
                break
            last = mean
        return {"pressure_iterations": iterations, "capped": iterations >= most}

    def _move_apart(self, dt: float, tolerance: float, most: int) -> Solution:
        """One look; what is led through nozzles stays where it is.

        Particles come together in much the same way from step to step, so that the pressures that parted them last are
        near those that will.
        """
        system, particles = self.system, self.system.particles
        system.lead()
        _keep(system.count, particles.velocity, particles.before)
        pressures = particles.position, particles.acceleration, particles.apart_pressure, particles.apart_change
        _exchange_pressures(system.count, 1.0, *pressures)
        solution = self.apart.solve(dt, tolerance, 1, most, warm=True, ahead=0.0, alone=True)
        _exchange_pressures(system.count, AGAIN if solution.iterations <= LOCAL else 0.0, *pressures)
        system.lead()
        if system.remembers:
            _remember(system.count, dt, particles.velocity, particles.before, particles.pressed)
        _shift(system.count, dt, particles.position, particles.velocity, particles.before)
        return solution


@ti.kernel
def _keep(count: ti.i32, velocity: Vec4Array, before: Vec4Array):
    for i in range(count):
        before[i].xyz = velocity[i].xyz


@ti.kernel
def _exchange_pressures(
    count: ti.i32, kept: real, position: Vec4Array, acceleration: Vec4Array, pressure: RealArray, change: RealArray
):
    """Take others, and what they change, in place of those in position.w and acceleration.w, of which a share is
    kept."""
    for i in range(count):
        q, changed = position[i][Q], acceleration[i].w
        position[i][Q], acceleration[i].w = pressure[i], change[i]
        pressure[i], change[i] = kept * q, kept * changed


@ti.kernel
def _remember(count: ti.i32, dt: real, velocity: Vec4Array, before: Vec4Array, pressed: Vec4Array):
    for i in range(count):
        pressed[i].xyz += dt * (velocity[i].xyz - before[i].xyz)


@ti.kernel
def _shift(count: ti.i32, dt: real, position: Vec4Array, velocity: Vec4Array, before: Vec4Array):
    """Go the way apart that is in the velocities, and take it from these."""
    for i in range(count):
        position[i].xyz += dt * (velocity[i].xyz - before[i].xyz)
        velocity[i].xyz = before[i].xyz
