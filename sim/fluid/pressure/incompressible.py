"""The step that all solvers share which look for the pressures under which the fluid keeps its volume."""

from typing import Any, ClassVar

import numpy as np

from sim.device.arrays import Declared, Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.forces.momentum import Momentum
from sim.fluid.forces.velocity_smoothing import VelocitySmoothing
from sim.fluid.measure import Measure
from sim.fluid.pressure.solver import PressureSolver
from sim.fluid.system import FluidSystem
from sim.fluid.time_step_limits import displacement_limit, fall_limit, pressure_limit
from sim.free_fall import OTHERS

WORST = 0.1
"""No particle may be left compressed by more than this share, whatever the mean."""
LAYERS = 25
"""Fluid that is deeper than so many layers of particles asks for smaller errors and more iterations."""


class Incompressible(PressureSolver):
    """Advances a FluidSystem: forces, pressures, motion. A solver says what it measures, and finds the pressures."""

    BEFORE: ClassVar[Declared] = Declared("before", "vec4", "velocity before a step [m/s]", sorted=False, saved=False)
    ARRAYS: ClassVar[tuple[Declared, ...]]
    """BEFORE, and what else the solver needs of particles."""
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]]
    STATISTICS: ClassVar[tuple[str, ...]] = ("pressure_iterations",)
    SKIN: ClassVar[float] = 0.0
    """Particles move far in a step: lists would not serve for a second one."""
    ERRORS: ClassVar[tuple[str, ...]] = ("density_error",)
    CAP = "max_iterations"
    FINDS_FRICTION: ClassVar[bool] = False
    """Whether `examine` leaves the viscous forces between particles in pressure_acceleration."""

    def __init__(self, system: FluidSystem, fastest_signal: float):
        self.system = system
        self._gravity = vec3(*system.gravity)
        self._fall_limit = fall_limit(0.5 * system.h, float(np.linalg.norm(system.gravity)))
        self.momentum = Momentum(system, pressure=False, friction_known=self.FINDS_FRICTION)
        self.smoothing = VelocitySmoothing(system)

    @property
    def settings(self) -> Any:
        """The solver's own settings."""
        return self.system.spec.solver_settings

    def step_limits(self, measure: Measure, cfl: float) -> dict[str, float]:
        """Largest stable time steps [s]: the way of particles, pressure, gravity, and the other forces."""
        half = 0.5 * self.system.h
        return {
            "signal": displacement_limit(cfl * half, measure.pace + self.system.boundary.speed),
            "pressure": pressure_limit(half, cfl, measure.pressure_max, self.system.spec.rest_density),
            "force": self._fall_limit,
        } | self.momentum.step_limits()

    @property
    def deep(self) -> float:
        """Layers of particles one above the other over LAYERS, and at least 1.

        The mean compression that a step may leave is divided by this, since it adds up from the ground to the surface,
        which falls by all of it; the most iterations are multiplied, since each takes pressures one layer further.
        """
        return max(1.0, self.system.measured.height / (LAYERS * self.system.spec.spacing))

    @property
    def most_iterations(self) -> int:
        """Of one system of equations."""
        return int(self.settings.max_iterations * self.deep)

    def start(self) -> None:
        """Find densities and forces of the initial state, or of one that an event has changed."""
        self.restore()
        self.momentum.accelerate()
        self.system.lead()

    def restore(self) -> None:
        """Go on from a checkpoint."""
        self.system.find_neighbors()
        self.examine(0.0)

    def advance(self, dt: float) -> dict[str, float]:
        """One step of symplectic Euler; what was measured before it, at its positions, is measured anew after it. What
        falls freely goes exactly as far as it should.

        Solids are where they will be after the step when pressures are found, which keep the fluid out of there.
        """
        system, particles = self.system, self.system.particles
        self.momentum.accelerate()
        if system.bodies:
            system.bodies.gather_forces(self.momentum.terms)
        system.lead()
        _set_off(system.count, dt, particles.velocity, particles.acceleration, particles.before)
        if system.bodies:
            system.bodies.predict(dt)
        system.boundary.move()
        stats = self.smoothing.smooth(dt)
        system.lead()
        _tell(stats, self.solve_pressures(dt))
        system.lead()
        if system.bodies:
            stats |= system.bodies.commit(dt)
            system.boundary.move()
        _move(system.count, dt, self._gravity, particles.position, particles.velocity, particles.before)
        _tell(stats, self.separate(dt))
        if system.bodies:
            system.bodies.prevent_penetration(dt)
        system.boundary.prevent_penetration(particles.position, particles.velocity, system.count)
        system.exchange(dt)
        system.find_neighbors(dt=dt)
        self.examine(dt)
        return stats

    def examine(self, dt: float) -> None:
        """Find densities, and what else the solver needs, at the present positions."""
        raise NotImplementedError

    def solve_pressures(self, dt: float) -> dict[str, float]:
        """Find pressures and add what they do to velocities; returns the statistics."""
        raise NotImplementedError

    def separate(self, dt: float) -> dict[str, float]:
        """Move apart what is too dense where all are after the step dt [s], without a change of velocities; returns the
        statistics."""
        return {}


def _tell(stats: dict[str, float], more: dict[str, float]) -> None:
    """Add the statistics of one more part of a step."""
    for name, value in more.items():
        stats[name] = stats.get(name, 0) + value


@ti.kernel
def kick(count: ti.i32, dt: real, velocity: Vec4Array, acceleration: Vec4Array):
    """v += dt a."""
    for i in range(count):
        velocity[i].xyz += dt * acceleration[i].xyz


@ti.kernel
def _set_off(count: ti.i32, dt: real, velocity: Vec4Array, acceleration: Vec4Array, before: Vec4Array):
    """Kick, and remember the velocities before."""
    for i in range(count):
        before[i].xyz = velocity[i].xyz
        velocity[i].xyz += dt * acceleration[i].xyz


@ti.kernel
def _move(count: ti.i32, dt: real, gravity: vec3, position: Vec4Array, velocity: Vec4Array, before: Vec4Array):
    """Go on with the new velocity; what falls goes with the mean of both as far as gravity made the difference.

    With the mean, pressures would excite waves: symplectic Euler is stable since it takes the new velocity.
    """
    g2 = gravity.norm_sqr()
    for i in range(count):
        displacement = dt * velocity[i].xyz
        if g2 > 0.0:
            others = (velocity[i].xyz - before[i].xyz) / dt - gravity
            falls = 1.0 - ti.sqrt(others.norm_sqr() / g2) / OTHERS
            displacement -= 0.5 * dt * dt * ti.max(falls, 0.0) * gravity
        position[i].xyz += displacement
