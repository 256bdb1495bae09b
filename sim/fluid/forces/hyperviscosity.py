"""Hyperviscosity: what takes from velocities the differences between neighbours that no smooth flow has.

Particles under pressure tremble at the scale of their spacing, and trembling disorders them, which pressure then has to
put right. With the linear field C_i x that fits the velocities around a particle best, velocities lose in a step
    eps sum_j V W_ij (u_i - u_j),     u_i = sum_j V W_ij [v_i - v_j - C_i (x_i - x_j)].
What one of a pair loses the other gains, and linear flows, rotations among them, stay as they are. On a smooth flow of
wave number k it acts as (k d)^4, where viscosity acts as (k d)^2 (compare the filters of large-eddy simulation, Pope
2000, ch. 13, and for particles the viscosity between them of Monaghan 1989, which is the first sum alone).
"""

import math

import numpy as np

from sim.device.arrays import Vec4Array, mat3, real, vec3
from sim.device.compiler import ti
from sim.fluid.kernel import cubic, cubic_norm
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, padded

MOST = 0.35
"""Of the differences at most this share is taken in a step: with thrice as much they could grow."""
SINGULAR = 1e-4
"""Share of the trace that is added to second moments: neighbours in a plane tell no gradient across it."""


class Hyperviscosity:
    """Damps the velocities of a system at `rate` over sqrt(g / d); the array `kept` is free to be written."""

    def __init__(self, system: FluidSystem, rate: float):
        self.system = system
        self.rate = rate * math.sqrt(float(np.linalg.norm(system.gravity)) / system.spec.spacing)

    def apply(self, dt: float) -> None:
        """Damp velocities over a step dt [s]; positions and neighbours are given."""
        if self.rate == 0.0:
            return
        system, particles = self.system, self.system.particles
        _damp(
            system.count,
            system.h,
            system.mass / system.spec.rest_density,
            min(self.rate * dt, MOST),
            particles.position,
            particles.velocity,
            particles.kept,
            system.neighbors.lists,
        )


@ti.kernel
def _damp(
    count: ti.i32,
    h: real,
    volume: real,
    share: real,
    position: Vec4Array,
    velocity: Vec4Array,
    rough: Vec4Array,
    near: Neighbors,
):
    inverse_h = 1.0 / h
    norm = volume * cubic_norm(inverse_h)
    for i in range(count):
        x, v = position[i].xyz, velocity[i].xyz
        first, second, slope, difference = vec3(0.0), mat3(0.0), mat3(0.0), vec3(0.0)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            d, dv = inverse_h * (x - position[j].xyz), v - velocity[j].xyz
            weight = cubic(d.norm())
            first += weight * d
            second += weight * d.outer_product(d)
            slope += weight * dv.outer_product(d)
            difference += weight * dv
        scale = 1.0 / ti.max(second.trace(), 1e-12)
        second = scale * second + SINGULAR * ti.Matrix.identity(real, 3)
        rough[i].xyz = norm * (difference - slope @ (second.inverse() @ (scale * first)))
    for i in range(count):
        x = position[i].xyz
        lost = vec3(0.0)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            lost += cubic((x - position[j].xyz).norm() * inverse_h) * (rough[i].xyz - rough[j].xyz)
        velocity[i].xyz -= share * norm * lost
