"""The pressures that keep a fluid from being compressed, for every solver that looks for them.

With q = p / rho^2, pressures accelerate particles by
    a_i(q) = -sum_j m (q_i + q_j) grad W_ij - q_i G_i,
where G_i is the gradient of what the solids add to the density of particle i. Over a step dt that changes densities by
    dt^2 (L q)_i = dt^2 [sum_j m (a_i - a_j).grad W_ij + a_i.G_i].
L is symmetric and negative semidefinite; its diagonal is -D_i, with
    D_i = |sum_j m grad W_ij + G_i|^2 + sum_j m^2 |grad W_ij|^2.
Wanted is q >= 0 with r = s + dt^2 L q <= 0, and r = 0 where q > 0, for a predicted compression s [kg/m^3]: the
minimum over q >= 0 of the energy dt^2 q.(-L q) / 2 - s.q. It is found by projected conjugate gradients with the
preconditioner D, starting from the pressures of the step before. Every trial is projected to q >= 0, evaluated, and
taken by the share of it that minimises the energy, so that the energy falls in each iteration: too large a pressure
left over from an impact is scaled down at once, where Jacobi iterations would let it blow the fluid apart.

Sources: Ihmsen et al. 2014 (the system of equations), Bender & Koschier 2017 (D, there 1/alpha; eq. 9 to 12),
Polyak 1969 (conjugate gradients with bounds).
"""

from dataclasses import dataclass

import numpy as np
import taichi as ti

from sim.arrays import Declared, DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4
from sim.fluid.incompressible import BLOCKS, WORST
from sim.fluid.kernel import cubic, cubic_slope, cubic_slope_host, lattice
from sim.fluid.solids import approach, solid_share
from sim.fluid.system import FluidSystem
from sim.neighbors import padded

ARRAYS = (
    Declared("push", "vec4", "acceleration by pressure [m/s^2]; w: s + dt^2 L q [kg/m^3]", sorted=False, saved=False),
    Declared("kept", "vec4", "as push, of the best pressures found", sorted=False, saved=False),
    Declared("search", "vec4", "the best pressures found as q, and the last change of them", sorted=False, saved=False),
    Declared("solid", "vec4", "gradient G of the solids' density [kg/m^4]; w: that density [kg/m^3]", False, False),
    Declared("diagonal", "real", "D [kg^2/m^8]", sorted=False, saved=False),
    Declared("source", "real", "predicted compression s [kg/m^3]", sorted=False, saved=False),
)

TRIAL = 2.0
"""Length of a trial step over a Jacobi step: the line search shortens what is too long."""
SMALLEST_DIAGONAL = 1e-3
"""Under this share of a lattice's diagonal a particle has too few neighbours to be pushed."""
FEWEST_NEIGHBORS = 20
"""With fewer, a particle's divergence tells nothing (Bender & Koschier 2017, sec. 3.3)."""


@dataclass(frozen=True)
class Solution:
    """Iterations that were made, and the mean compression [kg/m^3] that is left; `capped` if more than was asked."""

    iterations: int
    error: float
    capped: bool


class Projection:
    """Operators on the particles of a system; its arrays are those declared in ARRAYS."""

    def __init__(self, system: FluidSystem):
        self.system = system
        h, mass = system.h, system.mass
        points = lattice(system.spec.spacing, h)
        r = np.linalg.norm(points, axis=1)
        slope = cubic_slope_host(r, h)
        self.smallest_diagonal = SMALLEST_DIAGONAL * mass**2 * float((slope**2 * r**2).sum())
        self.worst = WORST * system.spec.rest_density
        self._sums = ti.ndarray(ti.f64, (BLOCKS + 1, 4))

    def prepare(self, dt: float) -> None:
        """Densities, D, G, and as source the compression in `dt` by the present velocities.

        The velocities of particles with few neighbours are not compressed by any pressure of their own.
        """
        system = self.system
        particles, boundary, walls = system.particles, system.boundary, system.walls
        _prepare(
            system.count,
            dt,
            system.h,
            system.mass,
            system.spec.rest_density,
            self.smallest_diagonal,
            FEWEST_NEIGHBORS,
            particles.position,
            particles.velocity,
            particles.solid,
            particles.diagonal,
            particles.source,
            system.neighbors.size,
            system.neighbors.index,
            boundary.count > 0,
            boundary.samples,
            boundary.neighbors.size,
            boundary.neighbors.index,
            boundary.moves,
            boundary.velocity,
            walls.count,
            walls.weight,
            walls.planes,
        )

    def predict(self, dt: float) -> None:
        """As source the compression after `dt` with the present velocities.

        The share of the solids is steep, so it is taken, with its gradient G, where the particle would go.
        """
        system = self.system
        particles, boundary, walls = system.particles, system.boundary, system.walls
        _predict(
            system.count,
            dt,
            system.h,
            system.mass,
            system.spec.rest_density,
            particles.position,
            particles.velocity,
            particles.solid,
            particles.source,
            system.neighbors.size,
            system.neighbors.index,
            boundary.count > 0,
            boundary.samples,
            boundary.neighbors.size,
            boundary.neighbors.index,
            walls.count,
            walls.weight,
            walls.planes,
        )

    def solve(self, dt: float, tolerance: float, fewest: int, most: int) -> Solution:
        """Pressures in position.w, from those that are there, and their accelerations in kept.

        tolerance: mean compression [kg/m^3] that may be left. The accelerations are those of the pressures whose error
        is returned.
        """
        system, particles = self.system, self.system.particles
        for iteration in range(1, most + 1):
            mean, worst = _iterate(
                system.count,
                dt,
                system.h,
                system.mass,
                iteration == 1,
                particles.position,
                particles.push,
                particles.kept,
                particles.search,
                particles.solid,
                particles.diagonal,
                particles.source,
                system.neighbors.size,
                system.neighbors.index,
                self._sums,
            )
            if iteration >= fewest and mean <= tolerance and worst <= self.worst:
                break
        _finish(system.count, particles.position, particles.search)
        return Solution(iteration, mean, mean > tolerance or worst > self.worst)


@ti.kernel
def _prepare(
    count: ti.i32,
    dt: real,
    h: real,
    mass: real,
    rest_density: real,
    smallest_diagonal: real,
    fewest_neighbors: ti.i32,
    position: Vec4Array,
    velocity: Vec4Array,
    solid: Vec4Array,
    diagonal: RealArray,
    source: RealArray,
    size: IntArray,
    index: IntTable,
    has_boundary: ti.template(),
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    has_motion: ti.template(),
    sample_velocity: Vec4Array,
    wall_count: ti.i32,
    wall_weight: real,
    planes: Vec4Array,
):
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h * inverse_h * inverse_h
    slope_norm = norm * inverse_h * inverse_h
    for i in range(count):
        x, v = position[i].xyz, velocity[i].xyz
        near, squares, rate = ti.cast(0.0, real), ti.cast(0.0, real), ti.cast(0.0, real)
        along = vec3(0.0)
        for k in range(padded(size[i])):
            j = index[i, k]
            d = x - position[j].xyz
            r2 = d.dot(d)
            q = ti.sqrt(r2) * inverse_h
            slope = cubic_slope(q)
            near += cubic(q)
            squares += slope * slope * r2
            along += slope * d
            rate += slope * d.dot(v - velocity[j].xyz)
        density = mass * norm * (near + 1 - (padded(size[i]) - size[i]))
        near_solid = 0
        if ti.static(has_boundary):
            near_solid = sample_size[i]
        share = solid_share(
            x, i, near_solid, sample_index, samples, wall_count, wall_weight, planes, inverse_h, has_boundary
        )
        density += rest_density * share.w
        gradient = rest_density * share.xyz
        velocity[i].w = density
        solid[i] = vec4(gradient, rest_density * share.w)
        whole = mass * slope_norm * along + gradient
        d_ii = whole.dot(whole) + mass * mass * slope_norm * slope_norm * squares
        diagonal[i] = ti.select(d_ii > smallest_diagonal, 1.0 / d_ii, 0.0)
        compression = dt * (mass * slope_norm * rate + v.dot(gradient))
        if ti.static(has_motion):
            compression += (
                dt * rest_density * approach(x, i, near_solid, sample_index, samples, sample_velocity, inverse_h)
            )
        source[i] = ti.select(size[i] < fewest_neighbors, -rest_density, compression)


@ti.kernel
def _predict(
    count: ti.i32,
    dt: real,
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    solid: Vec4Array,
    source: RealArray,
    size: IntArray,
    index: IntTable,
    has_boundary: ti.template(),
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    wall_count: ti.i32,
    wall_weight: real,
    planes: Vec4Array,
):
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h * inverse_h * inverse_h
    for i in range(count):
        x, v = position[i].xyz, velocity[i]
        near = ti.cast(0.0, real)
        for k in range(padded(size[i])):
            j = index[i, k]
            near += cubic((x - position[j].xyz + dt * (v.xyz - velocity[j].xyz)).norm() * inverse_h)
        near_solid = 0
        if ti.static(has_boundary):
            near_solid = sample_size[i]
        share = solid_share(
            x + dt * v.xyz,
            i,
            near_solid,
            sample_index,
            samples,
            wall_count,
            wall_weight,
            planes,
            inverse_h,
            has_boundary,
        )
        source[i] = mass * norm * (near + 1 - (padded(size[i]) - size[i])) + rest_density * (share.w - 1.0)
        solid[i].xyz = rest_density * share.xyz


@ti.kernel
def _iterate(
    count: ti.i32,
    dt: real,
    h: real,
    mass: real,
    first: ti.i32,
    position: Vec4Array,
    push: Vec4Array,
    kept: Vec4Array,
    search: Vec4Array,
    solid: Vec4Array,
    diagonal: RealArray,
    source: RealArray,
    size: IntArray,
    index: IntTable,
    sums: DoubleTable,
) -> ti.types.vector(2, ti.f64):
    """One step of projected conjugate gradients; returns the mean error [kg/m^3] of the pressures it arrives at."""
    inverse_h = 1.0 / h
    dt2 = dt * dt
    strength = mass * 8.0 / ti.math.pi * inverse_h**5
    for i in range(count):
        if first != 0:
            kept[i] = vec4(0.0, 0.0, 0.0, source[i])
            search[i] = vec4(0.0)
        else:
            q, left = search[i].x, kept[i].w
            downhill = ti.select(q > 0.0 or left > 0.0, left * diagonal[i] / dt2, 0.0)
            position[i].w = ti.max(q + TRIAL * (downhill + ti.cast(sums[BLOCKS, 0], real) * search[i].y), 0.0)
    for i in range(count):
        x = position[i]
        a = vec3(0.0)
        for k in range(padded(size[i])):
            xj = position[index[i, k]]
            d = x.xyz - xj.xyz
            a -= (x.w + xj.w) * cubic_slope(d.norm() * inverse_h) * d
        push[i].xyz = strength * a - x.w * solid[i].xyz
    for i in range(count):
        x, a = position[i].xyz, push[i].xyz
        change = ti.cast(0.0, real)
        for k in range(padded(size[i])):
            j = index[i, k]
            d = x - position[j].xyz
            change += cubic_slope(d.norm() * inverse_h) * d.dot(a - push[j].xyz)
        push[i].w = source[i] + dt2 * (strength * change + a.dot(solid[i].xyz))
    for block in range(BLOCKS):
        gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for i in range(count * block // BLOCKS, count * (block + 1) // BLOCKS):
            step = position[i].w - search[i].x
            gain += step * kept[i].w
            bend += step * (kept[i].w - push[i].w)
        sums[block, 0] = gain
        sums[block, 1] = bend
    ti.loop_config(serialize=True)
    for _ in range(1):
        gain, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for block in range(BLOCKS):
            gain += sums[block, 0]
            bend += sums[block, 1]
        sums[BLOCKS, 1] = ti.select(bend > 0.0, ti.math.clamp(gain / bend, 0.0, 1.0), 0.0)
    for block in range(BLOCKS):
        error, across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        worst = ti.cast(0.0, real)
        share = ti.cast(sums[BLOCKS, 1], real)
        for i in range(count * block // BLOCKS, count * (block + 1) // BLOCKS):
            step = share * (position[i].w - search[i].x)
            change = share * (push[i] - kept[i])
            kept[i] += change
            search[i].x += step
            search[i].y = step
            q, left = search[i].x, kept[i].w
            downhill = ti.select(q > 0.0 or left > 0.0, left * diagonal[i] / dt2, 0.0)
            across += downhill * change.w
            along += step * change.w
            error += ti.max(left, 0.0)
            worst = ti.max(worst, left)
        sums[block, 0] = across
        sums[block, 1] = along
        sums[block, 2] = error
        sums[block, 3] = worst
    total, peak = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for _ in range(1):
        across, along = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for block in range(BLOCKS):
            across += sums[block, 0]
            along += sums[block, 1]
            total += sums[block, 2]
            peak = ti.max(peak, sums[block, 3])
        sums[BLOCKS, 0] = ti.select(along < 0.0, ti.max(-across / along, 0.0), 0.0)
    return ti.Vector([total / count, peak])


@ti.kernel
def _finish(count: ti.i32, position: Vec4Array, search: Vec4Array):
    for i in range(count):
        position[i].w = search[i].x
