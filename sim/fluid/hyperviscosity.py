"""Hyperviscosity: what takes from velocities the differences between neighbours that no smooth flow has.

Particles under pressure tremble at the scale of their spacing, and trembling disorders them, which pressure then has to
put right. With the elasticity of the network of pairs,
    (B v)_i = 3 sum_j V W_ij e_ij e_ij.(v_i - v_j),     e_ij = x_ij / |x_ij|,
velocities lose eps B B v in a step. B is symmetric and vanishes for rigid motions, so momentum and angular momentum
stay, and energy falls; in a smooth flow of wave number k it acts as (k d)^4, where viscosity acts as (k d)^2 (compare
the filters of large-eddy simulation, e.g. Pope 2000, sec. 13.5).
"""

import math

import numpy as np
import taichi as ti

from sim.arrays import IntArray, IntTable, Vec4Array, real, vec3
from sim.fluid.kernel import cubic
from sim.fluid.system import FluidSystem
from sim.neighbors import padded

MOST = 0.25
"""Of the differences at most this share is taken in a step: with twice as much they could grow."""


class Hyperviscosity:
    """Damps the velocities of a system at `rate` over sqrt(g / d); the array `kept` is free to be written."""

    def __init__(self, system: FluidSystem, rate: float):
        self.system = system
        self.rate = rate * math.sqrt(float(np.linalg.norm(system.gravity)) / system.spec.spacing)

    def apply(self, dt: float) -> None:
        if self.rate == 0.0:
            return
        system, particles = self.system, self.system.particles
        volume = system.mass / system.spec.rest_density
        near = (system.count, system.h, particles.position)
        lists = system.neighbors.size, system.neighbors.index
        _add_differences(*near, particles.velocity, particles.kept, True, volume, *lists)
        _add_differences(*near, particles.kept, particles.velocity, False, -min(self.rate * dt, MOST) * volume, *lists)


@ti.kernel
def _add_differences(
    count: ti.i32,
    h: real,
    position: Vec4Array,
    of: Vec4Array,
    to: Vec4Array,
    fresh: ti.template(),
    factor: real,
    size: IntArray,
    index: IntTable,
):
    """To += factor / V B of, or to = that, where it is `fresh`."""
    inverse_h = 1.0 / h
    norm = 24.0 / ti.math.pi * inverse_h**3 * factor
    for i in range(count):
        x, one = position[i].xyz, of[i].xyz
        total = vec3(0.0)
        for k in range(padded(size[i])):
            j = index[i, k]
            d = x - position[j].xyz
            r2 = ti.max(d.dot(d), 1e-12 * h * h)
            total += cubic(ti.sqrt(r2) * inverse_h) / r2 * d.dot(one - of[j].xyz) * d
        if ti.static(fresh):
            to[i].xyz = norm * total
        else:
            to[i].xyz += norm * total
