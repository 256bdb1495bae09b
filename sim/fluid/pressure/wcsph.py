"""Weakly compressible SPH (Becker & Teschner 2007), advanced by velocity Verlet.

Density      rho_i = sum_j m W_ij + rho0 (half-spaces of solids + samples of sheets)
Pressure     p_i = B ((rho_i / rho0)^7 - 1), B = rho0 c^2 / 7, never negative          Becker & Teschner 2007, eq. 7
"""

from typing import ClassVar

from sim.device.arrays import Vec4Array, real
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import pressing_density
from sim.fluid.forces.momentum import Momentum
from sim.fluid.forces.velocity_smoothing import VelocitySmoothing
from sim.fluid.kernel import cubic, cubic_norm
from sim.fluid.layout import DENSITY, VOLUME, Q, Resolution, Samples, Walls
from sim.fluid.measure import Measure
from sim.fluid.pressure.solver import PressureSolver
from sim.fluid.system import FluidSystem
from sim.fluid.time_step_limits import force_limit, light_limit
from sim.neighbors.spatial_hash import Neighbors, itself, padded

GAMMA = 7.0
"""Exponent of the equation of state of water (Cole 1948)."""


class Wcsph(PressureSolver):
    """Advances a FluidSystem; `fastest_signal` is the speed of sound [m/s]."""

    WEAKLY_COMPRESSIBLE = True
    SPEED_OF_SOUND = "speed_of_sound"
    SKIN: ClassVar[float] = 0.1
    """Sound forbids steps in which particles move far, so that a list can serve for several of them."""

    def __init__(self, system: FluidSystem, fastest_signal: float):
        spec = system.spec
        self.system = system
        self.speed_of_sound = fastest_signal
        self.stiffness = spec.rest_density * self.speed_of_sound**2 / GAMMA
        self.artificial = 0.5 * spec.wcsph.artificial_viscosity * self.speed_of_sound * system.h
        damping = 0.5 * spec.wcsph.wall_damping * self.speed_of_sound * system.h
        self.momentum = Momentum(system, pressure=True, artificial=self.artificial, damping=damping)
        self.smoothing = VelocitySmoothing(system)

    def step_limits(self, measure: Measure, cfl: float) -> dict[str, float]:
        """Largest stable time steps [s]: sound, and the forces (Monaghan 1992, sec. 10)."""
        half, bodies = 0.5 * self.system.h, self.system.bodies
        signal = cfl * half / (self.speed_of_sound + measure.v_max + self.system.boundary.speed)
        limits = {"signal": signal, "force": force_limit(half, measure.a_max)} | self.momentum.step_limits()
        return limits | ({"light body": light_limit(signal, bodies.layer_mass_ratio)} if bodies else {})

    def limiting_term(self, term: str, measure: Measure, emitted: float) -> tuple[str, str]:
        if term == "light body":
            return "a body much lighter than the fluid", "use fluid.solver: dfsph or iisph, or a heavier body"
        return super().limiting_term(term, measure, emitted)

    def signals(self, measure: Measure, emitted: float) -> list[str]:
        return [f"sound {self.speed_of_sound:.3g} m/s", *super().signals(measure, emitted)]

    def start(self) -> None:
        """Find the accelerations of the initial state, or of one that an event has changed."""
        self._accelerate()
        if self.system.bodies:
            self.system.bodies.kick(0.0, self.momentum.terms)
        self.system.lead()

    def restore(self) -> None:
        """Go on from a checkpoint: it holds all that a step begins with but where solids are to particles."""
        self.system.find_solids()
        self.system.neighbors.forget(self.system.count)

    def advance(self, dt: float) -> dict[str, float]:
        """One step of velocity Verlet; forces that depend on velocity take it at half the step."""
        particles, last, boundary = self.system.particles, self.system.measured, self.system.boundary
        _drift(self.system.count, dt, particles.position, particles.velocity, particles.acceleration)
        stats = {}
        if self.system.bodies:
            stats = self.system.bodies.drift(dt)
            self.system.bodies.prevent_penetration(dt)
        boundary.move()
        boundary.prevent_penetration(particles.position, particles.velocity, self.system.count)
        distance = dt * max(last.v_max + dt * last.a_max, boundary.speed)
        self.system.exchange(dt, distance)
        self._accelerate(distance, dt)
        if self.system.bodies:
            self.system.bodies.kick(dt, self.momentum.terms)
        _kick(self.system.count, dt, particles.velocity, particles.acceleration)
        stats |= self.smoothing.smooth(dt)
        self.system.lead()
        return stats

    def _accelerate(self, distance: float = float("inf"), dt: float = 0.0) -> None:
        system = self.system
        system.find_neighbors(distance, dt)
        particles = system.particles
        _density(
            system.count,
            system.resolution,
            self.stiffness,
            particles.position,
            particles.velocity,
            system.neighbors.lists,
            system.boundary.sampled > 0,
            system.boundary.near_samples,
            system.boundary.faces.lists,
        )
        self.momentum.accelerate()


@ti.kernel
def _drift(count: ti.i32, dt: real, position: Vec4Array, velocity: Vec4Array, acceleration: Vec4Array):
    for i in range(count):
        v = velocity[i].xyz + 0.5 * dt * acceleration[i].xyz
        velocity[i].xyz = v
        position[i].xyz += dt * v


@ti.kernel
def _kick(count: ti.i32, dt: real, velocity: Vec4Array, acceleration: Vec4Array):
    for i in range(count):
        velocity[i].xyz += 0.5 * dt * acceleration[i].xyz


@ti.kernel
def _density(
    count: ti.i32,
    fluid: Resolution,
    stiffness: real,
    position: Vec4Array,
    velocity: Vec4Array,
    near: Neighbors,
    has_samples: ti.template(),
    samples: Samples,
    walls: Walls,
):
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    for i in range(count):
        x = position[i].xyz
        total = ti.cast(0.0, real)
        for k in range(padded(near.size[i])):
            total += cubic((x - position[near.index[near.begin[i] + k]].xyz).norm() * inverse_h)
        # The padding repeats the particle itself, whose W h^3 pi / 8 is 1.
        density = fluid.mass * norm * (total + itself(near.size[i]))
        if ti.static(has_samples):
            solid = ti.cast(0.0, real)
            for k in range(samples.size[i]):
                b = samples.sample[samples.index[samples.begin[i] + k]]
                solid += b[VOLUME] * cubic((x - b.xyz).norm() * inverse_h)
            density += fluid.rest_density * norm * solid
        density += fluid.rest_density * walls.share[i].w
        ratio = pressing_density(density, fluid.rest_density, walls.excess[i]) / fluid.rest_density
        ratio2 = ratio * ratio
        # Becker & Teschner 2007, eq. 7
        pressure = ti.max(stiffness * (ratio2 * ratio2 * ratio2 * ratio - 1.0), 0.0)
        velocity[i][DENSITY] = density
        position[i][Q] = pressure / (density * density)
