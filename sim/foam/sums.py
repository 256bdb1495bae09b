"""Sums over the fluid's particles that foam needs; the equations are numbered as in Ihmsen et al. 2012."""

import math

from sim.device.arrays import RealArray, Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.kernel import cubic, cubic_slope
from sim.neighbors.spatial_hash import Neighbors

SURFACE = 0.7
"""Gradient of the colour field, over 1 / h, from which a particle is at the surface: half of 1.4 at a plane one."""
CREST = 0.6
"""Cosine between velocity and normal from which a particle runs ahead of its wave (eq. 7)."""
TINY = 1e-12
SPLINE = 8.0 / math.pi


@ti.kernel
def surface_normals(
    count: ti.i32,
    h: real,
    volume: real,
    position: Vec4Array,
    near: Neighbors,
    normal: Vec4Array,
):
    """Unit normals out of the fluid in xyz, and in w the gradient of the colour field times h; 0 for a lone particle.

    The colour field is the sum of V W(r, h), 1 within the fluid.
    """
    for i in range(count):
        gradient = vec3(0.0)
        for k in range(near.size[i]):
            d = position[i].xyz - position[near.index[near.begin[i] + k]].xyz
            gradient += d * cubic_slope(ti.max(d.norm() / h, 1e-6))
        gradient *= volume * SPLINE / h**5
        length = gradient.norm()
        outward = -gradient / ti.max(length, TINY)
        normal[i] = ti.Vector([outward.x, outward.y, outward.z, length * h])


@ti.kernel
def potentials(
    count: ti.i32,
    h: real,
    position: Vec4Array,
    velocity: Vec4Array,
    normal: Vec4Array,
    near: Neighbors,
    trapped: RealArray,
    crest: RealArray,
):
    """How much each particle draws in air [m/s] (eq. 2), and how much it is a crest [1] (eq. 4 to 7)."""
    for i in range(count):
        approach, bend = ti.cast(0.0, real), ti.cast(0.0, real)
        n = normal[i].xyz
        for k in range(near.size[i]):
            j = near.index[near.begin[i] + k]
            d = position[i].xyz - position[j].xyz
            r = ti.max(d.norm(), TINY)
            closeness = ti.max(1.0 - r / h, 0.0)
            relative = velocity[i].xyz - velocity[j].xyz
            approach += (relative.norm() - relative.dot(d) / r) * closeness
            convex = ti.cast(-d.dot(n) < 0.0, real) * ti.cast(normal[j].w > SURFACE, real)
            bend += (1.0 - n.dot(normal[j].xyz)) * closeness * convex
        speed = velocity[i].xyz.norm()
        ahead = velocity[i].xyz.dot(n) >= CREST * speed and speed > TINY
        trapped[i] = approach
        crest[i] = bend * ti.cast(ahead and normal[i].w > SURFACE, real)


@ti.kernel
def surroundings(
    count: ti.i32,
    h: real,
    points: Vec4Array,
    position: Vec4Array,
    velocity: Vec4Array,
    near: Neighbors,
    found: Vec4Array,
):
    """Mean velocity of the fluid around points [m/s] in xyz (eq. 13), and in w how many of its particles are near;
    both 0 where there are none."""
    for i in range(count):
        total, weights = vec3(0.0), ti.cast(0.0, real)
        for k in range(near.size[i]):
            j = near.index[near.begin[i] + k]
            w = cubic((points[i].xyz - position[j].xyz).norm() / h)
            total += w * velocity[j].xyz
            weights += w
        mean = total / ti.max(weights, TINY)
        found[i] = ti.Vector([mean.x, mean.y, mean.z, ti.cast(near.size[i], real)])
