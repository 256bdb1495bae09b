"""Divergence-free SPH by the iteration that was published for it: `fluid.dfsph.iteration: jacobi`.

The equations are those of the user's paper, eq. 14 to 19, which has them from Bender & Koschier 2015, 2017. Forces act
on velocities; these are corrected until no density is above the rest density rho0 [kg/m^3] after the step dt [s], and
particles go there; then velocities are made free of divergence:

    alpha_i   = rho_i / (|sum_j m grad W_ij + G_i|^2 + sum_j |m grad W_ij|^2)                  eq. 14
    kappa_v,i = (D rho_i / D t) alpha_i / dt,   D rho_i / D t = sum_j m (v_i - v_j).grad W_ij  eq. 15
    v_i      -= dt sum_j m (kappa_v,i / rho_i + kappa_v,j / rho_j) grad W_ij                   eq. 16
    rho*_i    = rho_i + dt (D rho_i / D t)                                                     eq. 17
    kappa_i   = (rho*_i - rho0) alpha_i / dt^2                                                 eq. 18
    v_i      -= dt sum_j m (kappa_i / rho_i + kappa_j / rho_j) grad W_ij                       eq. 19

Eq. 15 is printed there with a factor rho too many. G_i is the gradient of what solids add to the density: they have a
part in the sum of vectors alone, give -(kappa_i / rho_i) G_i to the acceleration, and (v_i - v_solid).G_i to the rate.

What is kept is q_i = kappa_i / rho_i = p_i / rho_i^2 [m^5/(kg s^2)], in which rho_i cancels: its sum over iterations is
the pressure that acts, and is never negative. As an iteration changes all particles at once, one that took all of
eq. 15 or 18 would take `growth` times the compression of a short wave of particles from it, 2.8 times in a lattice by
default, so that it grows. It takes STEP / growth of that, a half by default, as the authors' code, SPlisHSPlasH, does.

rho* is the density where particles would go, of which eq. 17 is the first order; what pressures change of it follows
from eq. 17 as it stands. The density solve begins with the pressures of the last step, of both solves (warm start), but
not where a particle would come apart from others: what has hit something would be thrown back, since only compression
counts as an error. The divergence solve begins with none: with those of the last step pools gain energy.
"""

from functools import cache
from typing import ClassVar

import numpy as np

from sim.device.arrays import Declared, DoubleTable, RealArray, Vec4Array, real, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import velocity_in_gap
from sim.fluid.boundary.half_space import along_faces, face_slope, void_of
from sim.fluid.boundary.samples import remember_displacement
from sim.fluid.forces.pairwise import pressure_sum
from sim.fluid.kernel import cubic_slope, cubic_slope_host, lattice, slope_norm
from sim.fluid.layout import DISTANCE, Q, Resolution, Walls
from sim.fluid.pressure import projection
from sim.fluid.pressure.incompressible import WORST, Incompressible, kick
from sim.fluid.pressure.projection import Projection, Unknowns
from sim.fluid.sums import BLOCKS, mean_and_worst, span
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, padded

STEP = 1.4
"""Of an iteration, over 1 / growth: under 2 it converges in a lattice. Along walls and edges pressure acts up to 1.4
times as much (`along_faces`)."""
LOOSE = 0.01
"""Less dense than at rest by this share or more without pressure, a particle begins with none, and with a part of the
last one up to there: at rest, one half of them is a little less dense."""
FEW = 0.6
"""A particle with less than this share of its support filled, by solids or by particles of d^3 each, does not have its
divergence corrected: 20 neighbours of the 33.5 for which there is room with h = 2 d (Bender & Koschier 2017)."""
EXEMPT = -1e9
"""As source of such a particle [kg/m^3]: it never gets pressure."""


class DfsphJacobi(Incompressible):
    """Advances a FluidSystem."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (*projection.ARRAYS, Incompressible.BEFORE)
    SAMPLE_ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("pressed", "vec4", "displacement by the density solve of the last step [m]", saved=False),
        Declared("corrected", "vec4", "w: q of the divergence solve, which displaces nothing", saved=False),
    )
    STATISTICS: ClassVar[tuple[str, ...]] = ("pressure_iterations", "divergence_iterations")
    ERRORS = ("density_error", "divergence_error")

    def __init__(self, system: FluidSystem, fastest_signal: float):
        super().__init__(system, fastest_signal)
        # The friction that `prepare` finds would be that of velocities which are not yet free of divergence.
        self.projection = Projection(system, viscosity=0.0)
        self.step = STEP / growth(system.spec.spacing, system.h)
        self._sums = ti.ndarray(ti.f64, (BLOCKS, 2))

    def examine(self, dt: float) -> None:
        self.projection.prepare()  # the paper, eq. 14

    def advance(self, dt: float) -> dict[str, float]:
        """One step, from velocities that are free of divergence to others that are."""
        stats = super().advance(dt)
        if self.system.count:
            iterations, capped = self._free_of_divergence(dt)
            stats["divergence_iterations"] = iterations
            stats["capped"] = stats["capped"] or capped
        return stats

    def solve_pressures(self, dt: float) -> dict[str, float]:
        system, particles = self.system, self.system.particles
        self.projection.predict(dt)  # the paper, eq. 17
        _begin(system.count, LOOSE * system.spec.rest_density, particles.position, particles.source)
        iterations, capped = self._iterate(dt, self.settings.density_error, warm=True)
        kick(system.count, dt, particles.velocity, particles.pressure_acceleration)  # the paper, eq. 19
        if system.remembers:
            remember_displacement(system.count, dt, particles.pressure_acceleration, particles.pressed)
        return {"pressure_iterations": iterations, "capped": capped}

    def _free_of_divergence(self, dt: float) -> tuple[int, bool]:
        """Take from velocities what compresses, where all are after the step; returns as `_iterate` does."""
        system, particles = self.system, self.system.particles
        _begin_divergence(
            system.count,
            dt,
            system.resolution,
            particles.bundle(Unknowns),
            system.neighbors.lists,
            system.boundary.faces.lists,
        )
        told = self._iterate(dt, system.spec.dfsph.divergence_error, warm=False)
        kick(system.count, dt, particles.velocity, particles.pressure_acceleration)  # the paper, eq. 16
        if system.remembers:
            _remember(system.count, particles.position, particles.corrected)
        _add_up(system.count, particles.position, particles.search)
        system.lead()
        return told

    def _iterate(self, dt: float, error: float, *, warm: bool) -> tuple[int, bool]:
        """Find q, in position.w, and its accelerations that leave no more than the share `error` of the rest density
        of the source in the mean; returns the iterations, and whether more is left. warm: the first iteration takes q
        as it is."""
        system, particles, rest_density = self.system, self.system.particles, self.system.spec.rest_density
        for iteration in range(1, self.most_iterations + 1):
            mean, worst = _iterate(
                system.count,
                dt,
                0.0 if warm and iteration == 1 else self.step,
                system.resolution,
                particles.bundle(Unknowns),
                system.neighbors.lists,
                system.boundary.faces.lists,
                self._sums,
            )
            good = mean <= error * rest_density / self.deep and worst <= WORST * rest_density
            if good and iteration >= self.settings.min_iterations:
                break
        return iteration, not good


@cache
def growth(spacing: float, h: float) -> float:
    """By how much an iteration of full length changes a wave of compressions in a lattice of this spacing [m], at most:
    |sum_j grad W_ij sin(k x_ij)|^2 / sum_j |grad W_ij|^2 for the wave number k."""
    points = lattice(spacing, h)
    gradient = cubic_slope_host(np.linalg.norm(points, axis=1), h)[:, None] * points
    axis = np.linspace(0, np.pi / spacing, 31)
    waves = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    return float((np.square(np.sin(waves @ points.T) @ gradient).sum(axis=1) / np.square(gradient).sum()).max())


@ti.kernel
def _begin(count: ti.i32, loose: real, position: Vec4Array, source: RealArray):
    """Take over the pressures of the last step; loose: `LOOSE` as a density [kg/m^3]."""
    for i in range(count):
        position[i][Q] *= ti.math.clamp(1.0 + source[i] / loose, 0.0, 1.0)


@ti.kernel
def _begin_divergence(
    count: ti.i32,
    dt: real,
    fluid: Resolution,
    p: Unknowns,
    near: Neighbors,
    walls: Walls,
):
    """As source, and as what is left of it, what velocities compress in dt; no pressure in position.w, and that of the
    density solve in search.x."""
    inverse_h = 1.0 / fluid.h
    strength = fluid.mass * slope_norm(inverse_h)
    volume = fluid.spacing**3 / (4.0 / 3.0 * ti.math.pi * fluid.h**3)
    for i in range(count):
        x, v = p.position[i].xyz, p.velocity[i].xyz
        pairs, solids, filled = ti.cast(0.0, real), ti.cast(0.0, real), volume * near.size[i]
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            d = x - p.position[j].xyz
            pairs += cubic_slope(d.norm() * inverse_h) * d.dot(v - p.velocity[j].xyz)
        last = walls.begin[i] + walls.size[i]
        void = void_of(walls.begin[i], last, walls, inverse_h)
        for e in range(walls.begin[i], last):
            solid_velocity = velocity_in_gap(e, x, walls.begin[i], last, walls)
            slope = face_slope(walls.face[e][DISTANCE], walls.weight[e], void, walls.fit, inverse_h)
            solids += slope * walls.face[e].xyz.dot(v - solid_velocity)
            filled += walls.weight[e] * cap(walls.face[e][DISTANCE] * inverse_h)
        rate = strength * pairs + fluid.rest_density * solids  # the paper, eq. 15
        p.source[i] = ti.select(filled >= FEW, dt * rate, EXEMPT)
        p.pressure_acceleration[i] = vec4(0.0, 0.0, 0.0, p.source[i])
        p.search[i].x = p.position[i][Q]
        p.position[i][Q] = 0.0


@ti.func
def cap(q: real) -> real:
    """Share of the support beyond a plane at the distance q h."""
    s = ti.math.clamp(q, 0.0, 1.0)
    return 0.25 * (1.0 - s) ** 2 * (2.0 + s)


@ti.kernel
def _remember(count: ti.i32, position: Vec4Array, corrected: Vec4Array):
    for i in range(count):
        corrected[i] = vec4(0.0, 0.0, 0.0, position[i][Q])


@ti.kernel
def _add_up(count: ti.i32, position: Vec4Array, search: Vec4Array):
    """The pressure of a step is that of both solves."""
    for i in range(count):
        position[i][Q] += search[i].x


@ti.kernel
def _iterate(
    count: ti.i32,
    dt: real,
    step: real,
    fluid: Resolution,
    p: Unknowns,
    near: Neighbors,
    walls: Walls,
    sums: DoubleTable,
) -> ti.types.vector(2, ti.f64):
    """One iteration; returns the mean and the maximum of the compression that is left [kg/m^3], which is written to
    pressure_acceleration.w of each particle."""
    inverse_h = 1.0 / fluid.h
    dt2 = dt * dt
    strength = fluid.mass * slope_norm(inverse_h)
    for i in range(count):
        if step > 0.0:
            q = p.pressure_acceleration[i].w * p.diagonal[i] / dt2  # the paper, eq. 15 and 18, over rho
            p.position[i][Q] = ti.max(p.position[i][Q] + step * q, 0.0)
    for i in range(count):
        # The paper, eq. 16 and 19.
        a = strength * pressure_sum(i, p.position, near, inverse_h) - p.position[i][Q] * p.solid[i].xyz
        if walls.size[i] > 0:
            a = along_faces(i, a, walls, inverse_h)
        p.pressure_acceleration[i].xyz = a
    for block in range(BLOCKS):
        total, worst = ti.cast(0.0, ti.f64), ti.cast(0.0, real)
        within = span(block, BLOCKS, count)
        for i in range(within[0], within[1]):
            x, a = p.position[i].xyz, p.pressure_acceleration[i].xyz
            change = ti.cast(0.0, real)
            for k in range(padded(near.size[i])):
                j = near.index[near.begin[i] + k]
                d = x - p.position[j].xyz
                change += cubic_slope(d.norm() * inverse_h) * d.dot(a - p.pressure_acceleration[j].xyz)
            left = p.source[i] + dt2 * (strength * change + a.dot(p.solid[i].xyz))  # the paper, eq. 17
            p.pressure_acceleration[i].w = left
            total += ti.max(left, 0.0)
            if walls.excess[i] == 0.0:
                worst = ti.max(worst, left)
        sums[block, 0] = total
        sums[block, 1] = worst
    return mean_and_worst(count, BLOCKS, sums)
