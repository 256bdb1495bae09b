"""The pressures that keep a fluid from being compressed, for every solver that looks for them.

With q = p / rho^2, pressures accelerate particles by
    a_i(q) = B_i [-sum_j m (q_i + q_j) grad W_ij - q_i G_i],
where G_i is the gradient of what the solids add to the density of particle i, and B_i makes good along their surfaces
what it lacks (`sim.fluid.boundary.half_space.along_faces`). Over a step dt that changes densities by
    dt^2 (L q)_i = dt^2 [sum_j m (a_i - a_j).grad W_ij + a_i.G_i].
L is symmetric and negative semidefinite; away from walls its diagonal is -D_i, with
    D_i = |sum_j m grad W_ij + G_i|^2 + sum_j m^2 |grad W_ij|^2.
Wanted is q >= 0 with r = s + dt^2 L q <= 0, and r = 0 where q > 0, for a predicted compression s [kg/m^3]: the
minimum over q >= 0 of the energy dt^2 q.(-L q) / 2 - s.q. This module gives s, D and G;
`sim.fluid.pressure.conjugate_gradients` finds q.

Sources: Ihmsen et al. 2014 (the system of equations), Bender & Koschier 2017 (D, there 1/alpha; eq. 9 to 12).
"""

from typing import Any

import numpy as np

from sim.device.argument_packs import argpack
from sim.device.arrays import Declared, RealArray, Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import pressing_density
from sim.fluid.boundary.samples import sheet_share
from sim.fluid.forces.pairwise import SOFTENING, viscous
from sim.fluid.kernel import cubic, cubic_norm, cubic_slope, cubic_slope_host, lattice
from sim.fluid.layout import DENSITY, Resolution, Samples, Walls
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, itself, padded

ARRAYS = (
    Declared(
        "pressure_acceleration",
        "vec4",
        "acceleration by pressure [m/s^2], or between steps by friction; w: s + dt^2 L q [kg/m^3]",
        sorted=False,
        saved=False,
    ),
    Declared("kept", "vec4", "as push, of the best pressures found", sorted=False, saved=False),
    Declared(
        "search",
        "vec4",
        "the best pressures found as q, their last change, and position.w before",
        sorted=False,
        saved=False,
    ),
    Declared("solid", "vec4", "gradient G of the solids' density [kg/m^4]; w: that density [kg/m^3]", False, False),
    Declared("diagonal", "real", "D [kg^2/m^8]", sorted=False, saved=False),
    Declared("source", "real", "predicted compression s [kg/m^3]", sorted=False, saved=False),
)

Unknowns: Any = argpack(
    position=Vec4Array,
    velocity=Vec4Array,
    acceleration=Vec4Array,
    pressure_acceleration=Vec4Array,
    kept=Vec4Array,
    search=Vec4Array,
    solid=Vec4Array,
    diagonal=RealArray,
    source=RealArray,
)
"""Particles, and the arrays declared in ARRAYS."""

SMALLEST_DIAGONAL = 1e-3
"""Under this share of a lattice's diagonal a particle has too few neighbours to be pushed."""


class Projection:
    """The equations for the particles of a system; its arrays are those declared in ARRAYS.

    viscosity: of the friction between particles that is found beside them [m^2/s].
    """

    def __init__(self, system: FluidSystem, viscosity: float):
        self.system = system
        self.viscosity = viscosity
        h, mass = system.h, system.mass
        points = lattice(system.spec.spacing, h)
        r = np.linalg.norm(points, axis=1)
        slope = cubic_slope_host(r, h)
        self.smallest_diagonal = SMALLEST_DIAGONAL * mass**2 * float((slope**2 * r**2).sum())

    def prepare(self, *, diagonal: bool = True) -> None:
        """Densities, G, in pressure_acceleration the friction of the present velocities, and D unless a solver has
        another `diagonal`.

        Friction is that of `sim.fluid.forces.momentum`, for pairs at rest density.
        """
        system = self.system
        particles, boundary = system.particles, system.boundary
        _prepare(
            system.count,
            system.resolution,
            particles.bundle(Unknowns),
            diagonal,
            self.smallest_diagonal,
            self.viscosity > 0,
            self.viscosity,
            system.neighbors.lists,
            boundary.sampled > 0,
            boundary.near_samples,
            boundary.faces.lists,
        )

    def predict(self, dt: float) -> None:
        """As source the compression after `dt` with the present velocities.

        The share of the solids is steep, so it is taken, with its gradient G, where the particle would go.
        """
        system = self.system
        particles, boundary = system.particles, system.boundary
        system.update_half_spaces(dt)
        _predict(
            system.count,
            dt,
            dt != 0.0,
            system.resolution,
            particles.bundle(Unknowns),
            system.neighbors.lists,
            boundary.sampled > 0,
            boundary.near_samples,
            boundary.faces.lists,
        )


@ti.kernel
def _prepare(
    count: ti.i32,
    fluid: Resolution,
    p: Unknowns,
    has_diagonal: ti.template(),
    smallest_diagonal: real,
    has_viscosity: ti.template(),
    viscosity: real,
    near: Neighbors,
    has_samples: ti.template(),
    samples: Samples,
    walls: Walls,
):
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    slope_norm = norm * inverse_h * inverse_h
    softening = SOFTENING * fluid.h * fluid.h
    for i in range(count):
        x, v = p.position[i].xyz, p.velocity[i].xyz
        total, squares = ti.cast(0.0, real), ti.cast(0.0, real)
        along, rub = vec3(0.0), vec3(0.0)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            d = x - p.position[j].xyz
            r2 = d.dot(d)
            q = ti.sqrt(r2) * inverse_h
            slope = cubic_slope(q)
            total += cubic(q)
            if ti.static(has_diagonal):
                squares += slope * slope * r2
                along += slope * d
            if ti.static(has_viscosity):
                rub += viscous(d.dot(v - p.velocity[j].xyz), viscosity) / (r2 + softening) * slope * d
        if ti.static(has_viscosity):
            p.pressure_acceleration[i].xyz = fluid.mass * slope_norm / fluid.rest_density * rub
        density = fluid.mass * norm * (total + itself(near.size[i]))
        share = walls.share[i]
        if ti.static(has_samples):
            share += sheet_share(x, i, samples, inverse_h)
        density += fluid.rest_density * share.w
        gradient = fluid.rest_density * share.xyz
        p.velocity[i][DENSITY] = density
        p.solid[i] = vec4(gradient, fluid.rest_density * share.w)
        if ti.static(has_diagonal):
            whole = fluid.mass * slope_norm * along + gradient
            d_ii = whole.dot(whole) + fluid.mass * fluid.mass * slope_norm * slope_norm * squares
            p.diagonal[i] = ti.select(d_ii > smallest_diagonal, 1.0 / d_ii, 0.0)


@ti.kernel
def _predict(
    count: ti.i32,
    dt: real,
    moves: ti.template(),
    fluid: Resolution,
    p: Unknowns,
    near: Neighbors,
    has_samples: ti.template(),
    samples: Samples,
    walls: Walls,
):
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    for i in range(count):
        x, v = p.position[i].xyz, p.velocity[i]
        total = ti.cast(0.0, real)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            d = x - p.position[j].xyz
            if ti.static(moves):
                d += dt * (v.xyz - p.velocity[j].xyz)
            total += cubic(d.norm() * inverse_h)
        share = walls.share[i]
        if ti.static(has_samples):
            share += sheet_share(x + dt * v.xyz, i, samples, inverse_h)
        density = fluid.mass * norm * (total + itself(near.size[i])) + fluid.rest_density * share.w
        p.source[i] = pressing_density(density, fluid.rest_density, walls.excess[i]) - fluid.rest_density
        p.solid[i].xyz = fluid.rest_density * share.xyz
