"""What a half-space of fluid at rest would add to the density of a particle beside it.

It is a polynomial of the distance alone. Where half-spaces meet, what they have in common counts once; that share is
calibrated for right angles. All functions of several half-spaces take them as `sim.fluid.boundary.faces` lists them: of
particle i those from begin[i] on, size[i] of them, with unit normal and distance [m] in `face`.
"""

import numpy as np

from sim.device.arrays import mat3, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.calibration import calibrate_wall
from sim.fluid.kernel import halfspace_area, halfspace_volume
from sim.fluid.layout import DISTANCE


def half_space_fit(spacing: float, h: float) -> tuple[float, float, float, float]:
    """Weight, overlap and `along` of `sim.fluid.boundary.calibration.Wall`, and how far over h each half-space stands
    back, for a lattice half a spacing [m] off it to be at rest."""
    wall = calibrate_wall(spacing, h)
    return wall.weight, wall.overlap, wall.along, (wall.distance - spacing / 2) / h


@ti.func
def own_share(distance: real, fit: vec4, inverse_h: real) -> real:
    """Density over the rest density by one half-space at this distance [m]."""
    return fit.x * halfspace_volume(distance * inverse_h + fit.w)


@ti.func
def own_slope(distance: real, fit: vec4, inverse_h: real) -> real:
    """Its derivative by the distance [1/m]."""
    return -fit.x * halfspace_area(distance * inverse_h + fit.w) * inverse_h


@ti.func
def left_of(share: real, fit: vec4) -> real:
    """What one half-space leaves to others: two that add u1 and u2 have in common the product of 1 - left."""
    return fit.y / (fit.y + share)


@ti.func
def void_of(first: ti.i32, last: ti.i32, walls: ti.template(), inverse_h: real) -> real:
    """What half-spaces from `first` to before `last` leave together: the product of what each does."""
    void = ti.cast(1.0, real)
    for e in range(first, last):
        void *= left_of(walls.weight[e] * own_share(walls.face[e][DISTANCE], walls.fit, inverse_h), walls.fit)
    return void


@ti.func
def face_slope(distance: real, weight: real, void: real, fit: vec4, inverse_h: real) -> real:
    """By how much the share of all half-spaces grows with the distance of one [1/m], where they leave `void`."""
    left = left_of(weight * own_share(distance, fit, inverse_h), fit)
    counts = 1.0 - left * left / fit.y * (1.0 - void / left)
    return counts * weight * own_slope(distance, fit, inverse_h)


@ti.func
def along_faces(
    i: ti.i32,
    a: vec3,
    walls: ti.template(),
    inverse_h: real,
) -> vec3:
    """B a: the acceleration by pressure as it would be, were there fluid beyond the surfaces too.

    Across a surface that is what its own force is for. Along it a particle has fewer neighbours than elsewhere to be
    pushed by: of sum_j x (dW/dx) / r dV, integrated by parts, what lies beyond is missing, V. Taken half from the first
    surface to the last and half back again, B is symmetric however they meet. It is a force of the solid, which one
    that obeys forces has to feel (`sim.fluid.protocols.Bodies.hold_along_surfaces`). `held` has the weights of those
    that hold.
    """
    pushed = a
    count = walls.size[i]
    for k in range(2 * count):
        pushed = along_face(walls.begin[i] + ti.min(k, 2 * count - 1 - k), pushed, walls, inverse_h)
    return pushed


@ti.func
def lacking_along(i: ti.i32, walls: ti.template(), inverse_h: real) -> mat3:
    """1 - B^-1: the share that is missing of a lattice's sums beside the surfaces, which B makes good."""
    left = ti.Matrix.identity(real, 3)
    count = walls.size[i]
    for k in range(2 * count):
        e = walls.begin[i] + ti.min(k, 2 * count - 1 - k)
        n, share = walls.face[e].xyz, ti.sqrt(left_along(e, walls, inverse_h))
        left = share * left + (1.0 - share) * n.outer_product(n) @ left
    return ti.Matrix.identity(real, 3) - left


@ti.func
def left_along(e: ti.i32, walls: ti.template(), inverse_h: real) -> real:
    """The share of what a particle is pushed by along a surface that is on this side of it."""
    return 1.0 - walls.held[e] * walls.fit.z * halfspace_volume(ti.max(walls.face[e][DISTANCE] * inverse_h, 0.0))


@ti.func
def along_face(e: ti.i32, a: vec3, walls: ti.template(), inverse_h: real) -> vec3:
    """One factor of B: half of what one half-space is for, along it."""
    pushed = a
    if walls.face[e][DISTANCE] * inverse_h < 1.0:
        factor = 1.0 / ti.sqrt(left_along(e, walls, inverse_h))
        pushed = factor * a + (1.0 - factor) * walls.face[e].xyz.dot(a) * walls.face[e].xyz
    return pushed


@ti.func
def face_damping(distance: real, closing: real, fit: vec4, inverse_h: real, strength: real) -> real:
    """Deceleration along the normal [m/s^2] of what comes nearer at the speed `closing` < 0 [m/s]: artificial viscosity
    against the nearest point; strength = alpha c h / 2 [m^2/s]."""
    away = ti.max(distance * inverse_h + fit.w, 0.25)
    return -strength * fit.x * ti.min(closing, 0.0) / away * halfspace_area(away) * inverse_h * inverse_h


def own_share_host(distance: np.ndarray, fit: tuple[float, float, float, float], h: float) -> np.ndarray:
    """`own_share` on the host, in double precision."""
    from sim.fluid.kernel import halfspace_volume_host

    return fit[0] * halfspace_volume_host(np.asarray(distance) / h + fit[3])
