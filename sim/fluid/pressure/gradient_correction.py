"""Gradients that are right for linear fields, however particles lie: what DFSPH takes the compression of velocities by.

The kernel's own gradient is not: in a lattice that has been strained, sum_j V x_ji grad W_ij is no unit matrix, so that
pressure has a shear stress there, and what flows loses energy to it. With the inverse of that sum, L_i, the rate
    (D rho / D t)_i = sum_j m (v_i - v_j).L_i grad W_ij + v_i.G_i + what the motion of the solids adds
is exact for linear velocities (Bonet & Lok 1999), and the accelerations by pressures q = p / rho^2
    a_i = -sum_j m (q_i L_i + q_j L_j) grad W_ij - q_i G_i
are its adjoint, so that they keep momentum and angular momentum, and take no energy from what is not compressed.

A solid counts as a half-space of fluid that moves with it as its mirror image: with A(s), the area of the kernel at the
distance s, it has the gradient G_i = -2 rho0 A(s) L_i n and a part 2 s A(s) n n in the sum. L_i n is not n where
particles lie unevenly along the surface: a solid that pressed along n alone would leave what L_i makes of the pairs'
forces there, which was tried, and slows bodies in water.

Along a surface a particle has fewer neighbours than elsewhere. Where L_i makes that good, differences of velocity are
right, but differences of pressure are not: neighbours further off have another L_j, and water at rest would be pushed
down next to walls and up a layer further in. So along surfaces it is left to `half_space.along_faces`, and what is
missing counts in the sum as if it were there. At a free surface, where more than half of them can be missing,
the kernel's gradient stays: pressure is next to nothing there. It stays beside convex edges, too. A half-space does not
end where the solid does, so that fluid around the corner counts twice; with L_i to make good for that, a constant
pressure would push outward along the edge and inward on the faces, and water at rest would circulate.
"""

from functools import cache

import numpy as np

from sim.device.arrays import Declared, Vec4Array, mat3, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.faces import Faces
from sim.fluid.boundary.gaps import facing, pressing_density, velocity_in_gap
from sim.fluid.boundary.half_space import along_faces, lacking_along
from sim.fluid.boundary.samples import approach, sheet_share
from sim.fluid.forces.pairwise import Lens, matrix
from sim.fluid.kernel import cubic_slope, cubic_slope_host, halfspace_area, halfspace_volume, lattice, slope_norm
from sim.fluid.layout import DENSITY, DISTANCE, VOLUME, Resolution, Samples, Walls
from sim.fluid.pressure.projection import Unknowns
from sim.fluid.system import FluidSystem
from sim.fluid.time_step_limits import fall_limit
from sim.neighbors.spatial_hash import Neighbors, padded

ARRAYS = (
    Declared("correction", "vec4", "L: xx, yy, zz", saved=False),
    Declared("skew", "vec4", "L: xy, xz, yz", saved=False),
)
BARE, FULL = 0.75, 0.9
"""Third of the trace of the sum over particles, over what it is where they fill all that solids leave, up to which
gradients are not corrected, and from which they are."""
FLAT, ROUND = 0.25, 0.5
"""The same of the determinant of the sum: neighbours that lie in a plane tell no gradient across it."""

OVERLAP = 0.1
"""Third of the trace of the sum over what half-spaces reach over, from which on gradients are not corrected."""
BEHIND = 0.25
"""Spacings behind the surface of a half-space from which on a particle counts whole as one that it reaches over."""

BACK = 0.2
"""Of what the density is off already, velocities bring back so much in the longest step that falling allows (Baumgarte
1972), and less in shorter ones. All of it at once would make pressures as uncertain as one step leaves densities; and
as much in a short step would shoot off drops that are pressed onto an edge, the faster, the shorter it is."""


@cache
def lattice_sum(spacing: float, h: float, volume: float) -> float:
    """A third of the trace of the sum over particles in a lattice of this spacing [m], each with this volume [m^3]."""
    points = lattice(spacing, h)
    r = np.linalg.norm(points, axis=1)
    return -volume / 3.0 * float((cubic_slope_host(r, h) * r**2).sum())


def compression_rates(system: FluidSystem, dt: float, smallest_diagonal: float) -> None:
    """Write L, G, D, pulls of faces, and as source what the present velocities would compress in `dt` [s], with a share
    of the compression there is, for the solids where `update_half_spaces` has found them."""
    boundary = system.boundary
    _compression_rates(
        system.count,
        dt,
        _share_back(system, dt),
        smallest_diagonal,
        lattice_sum(system.spec.spacing, system.h, system.mass / system.spec.rest_density),
        system.resolution,
        system.particles.bundle(Unknowns),
        system.particles.bundle(Lens),
        system.neighbors.lists,
        boundary.sampled > 0,
        boundary.near_samples,
        boundary.faces.lists,
    )


def _share_back(system: FluidSystem, dt: float) -> float:
    """Of what the density is off, in a step of dt [s]; where nothing falls, nothing presses drops onto edges."""
    longest = fall_limit(system.h / 2, float(np.linalg.norm(system.gravity)))
    return BACK * min(1.0, dt / longest) if longest < np.inf else BACK


@ti.func
def overlap(i: ti.i32, position: Vec4Array, near: ti.template(), walls: ti.template(), inverse_h: real) -> real:
    """A third of the trace of the sum over particles behind half-spaces near particle i, over the kernel's norm and the
    volume of a particle [m^5]; none in a gap, which fluid is squeezed out of by the velocities that are corrected."""
    behind, gap = ti.cast(0.0, real), False
    first, last = walls.begin[i], walls.begin[i] + walls.size[i]
    for e in range(first, last):
        for other in range(first, e):
            gap = gap or facing(walls.face[e].xyz, walls.face[other].xyz)
    if not gap:
        for k in range(near.size[i]):
            d = position[i].xyz - position[near.index[near.begin[i] + k]].xyz
            depth = ti.cast(0.0, real)
            for e in range(first, last):
                depth = ti.max(depth, walls.face[e].xyz.dot(d) - walls.face[e][DISTANCE])
            if depth > 0.0:
                counts = ti.min(depth / (BEHIND * walls.spacing), 1.0)
                behind -= counts * cubic_slope(d.norm() * inverse_h) * d.dot(d) / 3.0
    return behind


@ti.func
def face_pull(face: vec4, weight: real, lens: mat3, inverse_h: real) -> vec3:
    """What a half-space adds to G, over the rest density [1/m]."""
    area = halfspace_area(ti.max(face[DISTANCE], 0.0) * inverse_h) * inverse_h
    return -2.0 * weight * area * (lens @ face.xyz)


def correct_pulls(system: FluidSystem, faces: Faces) -> None:
    """Write what half-spaces add to G of particles elsewhere, in their order, with L as it is."""
    _correct_pulls(system.count, system.h, system.particles.bundle(Lens), faces.lists)


@ti.kernel
def _correct_pulls(count: ti.i32, h: real, lens: Lens, walls: Walls):
    inverse_h = 1.0 / h
    for i in range(count):
        mine = matrix(lens.correction[i], lens.skew[i])
        for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
            one = face_pull(walls.face[e], walls.weight[e], mine, inverse_h)
            walls.pull[e].xyz = walls.pull[e].w * along_faces(i, one, walls, inverse_h)


@ti.kernel
def _compression_rates(
    count: ti.i32,
    dt: real,
    back: real,
    smallest_diagonal: real,
    lattice_sum: real,
    fluid: Resolution,
    p: Unknowns,
    lens: Lens,
    near: Neighbors,
    has_samples: ti.template(),
    samples: Samples,
    walls: Walls,
):
    inverse_h = 1.0 / fluid.h
    slope_strength = slope_norm(inverse_h)
    for i in range(count):
        x, v = p.position[i].xyz, p.velocity[i]
        last = walls.begin[i] + walls.size[i]
        sums = mat3(0.0)
        for k in range(padded(near.size[i])):
            d = x - p.position[near.index[near.begin[i] + k]].xyz
            sums -= cubic_slope(d.norm() * inverse_h) * d.outer_product(d)
        sums *= fluid.mass / fluid.rest_density * slope_strength
        if ti.static(has_samples):
            for k in range(samples.size[i]):
                b = samples.sample[samples.index[samples.begin[i] + k]]
                d = x - b.xyz
                sums -= slope_strength * b[VOLUME] * cubic_slope(d.norm() * inverse_h) * d.outer_product(d)
        filled, room = sums.trace() / 3.0, ti.cast(1.0, real)
        for e in range(walls.begin[i], last):
            n, q = walls.face[e].xyz, ti.max(walls.face[e][DISTANCE], 0.0) * inverse_h
            across = q * halfspace_area(q)
            sums += 2.0 * walls.weight[e] * across * n.outer_product(n)
            room *= 1.0 - walls.weight[e] * (halfspace_volume(q) + across / 3.0)
        if last > walls.begin[i]:
            sums += lattice_sum * lacking_along(i, walls, inverse_h)
        full = ti.math.clamp((filled / room - BARE) / (FULL - BARE), 0.0, 1.0)
        full *= full * (3.0 - 2.0 * full)
        full *= ti.math.clamp((sums.determinant() - FLAT) / (ROUND - FLAT), 0.0, 1.0)
        if last > walls.begin[i]:
            behind = slope_strength * fluid.mass / fluid.rest_density * overlap(i, p.position, near, walls, inverse_h)
            full *= ti.math.clamp(1.0 - behind / OVERLAP, 0.0, 1.0)
        mine = (full * sums + (1.0 - full) * ti.Matrix.identity(real, 3)).inverse()
        lens.correction[i] = vec4(mine[0, 0], mine[1, 1], mine[2, 2], 0.0)
        lens.skew[i] = vec4(mine[0, 1], mine[0, 2], mine[1, 2], 0.0)
        along, squares, pairs = vec3(0.0), ti.cast(0.0, real), ti.cast(0.0, real)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            d = x - p.position[j].xyz
            gradient = cubic_slope(d.norm() * inverse_h) * (mine @ d)
            along += gradient
            squares += gradient.dot(gradient)
            pairs += gradient.dot(v.xyz - p.velocity[j].xyz)
        gradient, rate = vec3(0.0), ti.cast(0.0, real)
        for e in range(walls.begin[i], last):
            one = face_pull(walls.face[e], walls.weight[e], mine, inverse_h)
            gradient += one
            there = x + dt * v.xyz
            rate += one.dot(v.xyz - velocity_in_gap(e, there, walls.begin[i], last, walls))
            walls.pull[e].xyz = walls.pull[e].w * along_faces(i, one, walls, inverse_h)
        if ti.static(has_samples):
            there = x + dt * v.xyz
            one = sheet_share(there, i, samples, inverse_h).xyz
            gradient += one
            rate += one.dot(v.xyz)
            rate += approach(there, i, samples, inverse_h)
        p.solid[i].xyz = fluid.rest_density * gradient
        strength = fluid.mass * slope_strength
        whole = strength * along + fluid.rest_density * gradient
        d_ii = whole.dot(whole) + strength * strength * squares
        p.diagonal[i] = ti.select(d_ii > smallest_diagonal, 1.0 / d_ii, 0.0)
        density = pressing_density(v[DENSITY], fluid.rest_density, walls.excess[i])
        p.source[i] = back * (density - fluid.rest_density) + dt * (strength * pairs + fluid.rest_density * rate)
