"""Predictive-corrective incompressible SPH (Solenthaler & Pajarola 2009).

Positions after the step are predicted, densities found there, and pressures raised by what these exceed the rest
density, until that is little. With q = p / rho^2 and the gradient G of what solids add to the density,
    q += 0.5 (rho* - rho0) / (dt^2 (sum_j |m grad W_ij|^2 + |G|^2)),
where the sum is that of a lattice (Solenthaler & Pajarola 2009, eq. 8): a particle with few neighbours would be raised
too much.

The density of solids is steep, and bends both ways. With G at the place that was predicted last, a particle that is
pushed out of a solid loses the force that did it and falls back, further each time; and one that is deep inside, where
G vanishes, is raised without bound. So G only grows while a step is solved: it begins where the particle would go
without pressure, and takes over what it lacks of any steeper one that is met.
"""

from typing import Any, ClassVar

import numpy as np

from sim.device.argument_packs import argpack
from sim.device.arrays import Declared, DoubleTable, Vec4Array, real, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import pressing_density
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.boundary.samples import remember_displacement, sheet_share
from sim.fluid.forces.pairwise import pressure_sum
from sim.fluid.kernel import cubic, cubic_norm, cubic_slope_host, lattice, slope_norm
from sim.fluid.layout import DENSITY, Q, Resolution, Samples, Walls
from sim.fluid.pressure.incompressible import WORST, Incompressible, kick
from sim.fluid.sums import BLOCKS, mean_and_worst, span
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, itself, padded

Predicted: Any = argpack(position=Vec4Array, predicted=Vec4Array, pressure_acceleration=Vec4Array, solid=Vec4Array)

RELAXATION = 0.5
"""Share of what would bring one particle alone to its rest density: its neighbours are raised with it."""


class Pcisph(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Incompressible.BEFORE,
        Declared("pressure_acceleration", "vec4", "acceleration by pressure [m/s^2]", sorted=False, saved=False),
        Declared(
            "predicted", "vec4", "position after the step [m]; w: compression [kg/m^3]", sorted=False, saved=False
        ),
        Declared("solid", "vec4", "gradient G of the solids' density [kg/m^4]", sorted=False, saved=False),
    )
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("pressed", "vec4", "way by pressure in the last step [m]", saved=False),
    )

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        points = lattice(system.spec.spacing, system.h)
        slope = cubic_slope_host(np.linalg.norm(points, axis=1), system.h)
        self.lattice_sum = system.mass**2 * float((slope[:, None] ** 2 * points**2).sum())
        self._sums = ti.ndarray(ti.f64, (BLOCKS, 2))

    def examine(self, dt: float) -> None:
        particles = self.system.particles
        _predict(
            self.system.count,
            0.0,
            particles.position,
            particles.velocity,
            particles.pressure_acceleration,
            particles.predicted,
        )
        self._compress(0.0, fresh=True)
        _keep_density(self.system.count, self.system.spec.rest_density, particles.velocity, particles.predicted)

    def solve_pressures(self, dt: float) -> dict[str, float]:
        system, particles, settings = self.system, self.system.particles, self.settings
        tolerance, worst_allowed = settings.density_error * system.spec.rest_density, WORST * system.spec.rest_density
        _begin(system.count, particles.position, particles.pressure_acceleration, particles.solid)
        bodies = system.bodies
        for iteration in range(1, self.most_iterations + 1):
            _predict(
                system.count,
                dt,
                particles.position,
                particles.velocity,
                particles.pressure_acceleration,
                particles.predicted,
            )
            if bodies:
                bodies.respond(dt, beside_expected=True)
            mean, worst = self._compress(dt, fresh=iteration == 1)
            good = mean <= tolerance and worst <= worst_allowed
            if good and iteration >= settings.min_iterations:
                break
            self._raise(dt)
        if bodies:
            bodies.apply(dt)
        kick(system.count, dt, particles.velocity, particles.pressure_acceleration)
        if system.remembers:
            remember_displacement(system.count, dt, particles.pressure_acceleration, particles.pressed)
        return {"pressure_iterations": iteration, "capped": not good}

    def _compress(self, dt: float, *, fresh: bool) -> tuple[float, float]:
        """Compression at the predicted positions [kg/m^3], which is written, as G is: its mean and maximum.

        Bodies that the fluid moves are pushed by the G that particles are: with these it is that of a `fresh` look.
        """
        system = self.system
        system.update_half_spaces(position="predicted", pulls=fresh)
        mean, worst = _compress(
            system.count,
            dt,
            fresh,
            system.bodies is not None,
            system.resolution,
            system.particles.bundle(Predicted),
            system.neighbors.lists,
            system.boundary.sampled > 0,
            system.boundary.near_samples,
            system.boundary.faces.lists,
            self._sums,
        )
        return mean, worst

    def _raise(self, dt: float) -> None:
        """Raise pressures by what is compressed, and find the accelerations."""
        system = self.system
        _raise(
            system.count,
            RELAXATION / (dt * dt),
            self.lattice_sum,
            1.0 + (system.bodies.layer_mass_ratio if system.bodies else 0.0),
            system.resolution,
            system.particles.bundle(Predicted),
            system.neighbors.lists,
            system.boundary.faces.lists,
        )


@ti.kernel
def _begin(count: ti.i32, position: Vec4Array, pressure_acceleration: Vec4Array, solid: Vec4Array):
    for i in range(count):
        position[i][Q] = 0.0
        pressure_acceleration[i] = vec4(0.0)
        solid[i] = vec4(0.0)


@ti.kernel
def _predict(
    count: ti.i32,
    dt: real,
    position: Vec4Array,
    velocity: Vec4Array,
    pressure_acceleration: Vec4Array,
    predicted: Vec4Array,
):
    for i in range(count):
        predicted[i].xyz = position[i].xyz + dt * (velocity[i].xyz + dt * pressure_acceleration[i].xyz)


@ti.kernel
def _keep_density(count: ti.i32, rest_density: real, velocity: Vec4Array, predicted: Vec4Array):
    for i in range(count):
        velocity[i][DENSITY] = rest_density + predicted[i].w


@ti.kernel
def _compress(
    count: ti.i32,
    dt: real,
    fresh: ti.i32,
    has_bodies: ti.template(),
    fluid: Resolution,
    p: Predicted,
    near: Neighbors,
    has_samples: ti.template(),
    samples: Samples,
    walls: Walls,
    sums: DoubleTable,
) -> ti.types.vector(2, ti.f64):
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    for i in range(count):
        x = p.predicted[i].xyz
        total = ti.cast(0.0, real)
        for k in range(padded(near.size[i])):
            total += cubic((x - p.predicted[near.index[near.begin[i] + k]].xyz).norm() * inverse_h)
        share = walls.share[i]
        if ti.static(has_samples):
            share += sheet_share(x, i, samples, inverse_h)
        steep = fluid.rest_density * share.xyz.norm()
        if ti.static(has_bodies):
            if fresh == 1:
                p.solid[i].xyz = fluid.rest_density * share.xyz
        elif steep > 0:
            normal = share.xyz.normalized()
            p.solid[i].xyz += ti.max(steep - p.solid[i].xyz.dot(normal), 0.0) * normal
        density = fluid.mass * norm * (total + itself(near.size[i])) + fluid.rest_density * share.w
        p.predicted[i].w = pressing_density(density, fluid.rest_density, walls.excess[i]) - fluid.rest_density
        if ti.static(has_bodies):
            p.predicted[i].w -= dt * dt * p.pressure_acceleration[i].w
    for block in range(BLOCKS):
        total, worst = ti.cast(0.0, ti.f64), ti.cast(0.0, real)
        within = span(block, BLOCKS, count)
        for i in range(within[0], within[1]):
            total += ti.max(p.predicted[i].w, 0.0)
            worst = ti.max(worst, p.predicted[i].w)
        sums[block, 0] = total
        sums[block, 1] = worst
    return mean_and_worst(count, BLOCKS, sums)


@ti.kernel
def _raise(
    count: ti.i32,
    factor: real,
    lattice_sum: real,
    giving_way: real,
    fluid: Resolution,
    p: Predicted,
    near: Neighbors,
    walls: Walls,
):
    inverse_h = 1.0 / fluid.h
    strength = fluid.mass * slope_norm(inverse_h)
    for i in range(count):
        diagonal = lattice_sum + giving_way * p.solid[i].xyz.dot(p.solid[i].xyz)
        p.position[i][Q] = ti.max(p.position[i][Q] + factor / diagonal * p.predicted[i].w, 0.0)
    for i in range(count):
        a = pressure_sum(i, p.position, near, inverse_h)
        a = strength * a - p.position[i][Q] * p.solid[i].xyz
        if p.solid[i].xyz.any():
            a = along_faces(i, a, walls, inverse_h)
        p.pressure_acceleration[i].xyz = a
