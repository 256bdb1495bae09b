"""Plane walls without particles.

What a half-space of fluid at rest would add to the density of a particle depends on its distance
alone. Where walls meet, the void between them is the product of what each leaves, which is exact for one
wall and for walls that do not reach the same particle.
"""

import numpy as np
import taichi as ti

from sim.arrays import Vec4Array, numpy_real, real, vec3, vec4
from sim.fluid.calibration import calibrate_wall
from sim.fluid.kernel import halfspace_area, halfspace_volume


class Walls:
    """Planes n.x = offset with the solid below, as the solver sees them.

    planes: unit normals out of the solid and offsets [m], shape [n, 4]. Each is moved into the solid, and weighs
    more than its volume, so that a lattice half a spacing off the wall is at rest (`sim.fluid.calibration`).
    """

    def __init__(self, planes: np.ndarray, spacing: float, h: float):
        calibrated = calibrate_wall(spacing, h)
        self.weight = calibrated.weight
        self.setback = calibrated.distance - spacing / 2
        self.count = len(planes)
        self.planes = ti.ndarray(vec4, max(self.count, 1))
        if self.count:
            shifted = planes - [0.0, 0.0, 0.0, self.setback]
            self.planes.from_numpy(shifted.astype(numpy_real))


@ti.func
def wall_share(x: vec3, count: ti.i32, planes: Vec4Array, inverse_h: real) -> vec4:
    """Share of the kernel around x that lies in the walls, 0 to 1, in w, and its gradient with respect to x [1/m]."""
    void = ti.cast(1.0, real)
    gradient = vec3(0.0)
    for k in range(count):
        q = (planes[k].xyz.dot(x) - planes[k].w) * inverse_h
        if q < 1.0:
            rest = 1.0 - halfspace_volume(q)
            # What the walls before leave, this one cuts down; and its own gradient is cut down by theirs.
            gradient = rest * gradient - void * halfspace_area(q) * inverse_h * planes[k].xyz
            void *= rest
    return vec4(gradient, 1.0 - void)


@ti.func
def wall_damping(x: vec3, v: vec3, count: ti.i32, planes: Vec4Array, inverse_h: real, strength: real) -> vec3:
    """Deceleration of what runs into walls: artificial viscosity against each plane's nearest point, `strength` =
    alpha c h / 2 [m^2/s]."""
    a = vec3(0.0)
    for k in range(count):
        distance = ti.max(planes[k].xyz.dot(x) - planes[k].w, 0.25 / inverse_h)
        speed = ti.min(planes[k].xyz.dot(v), 0.0)
        a -= strength * speed / distance * halfspace_area(distance * inverse_h) * inverse_h * planes[k].xyz
    return a


@ti.func
def wall_depth(x: vec3, count: ti.i32, planes: Vec4Array) -> real:
    """How deep x lies in the deepest wall [m]; negative outside all of them."""
    depth = -1e30
    for k in range(count):
        depth = ti.max(depth, planes[k].w - planes[k].xyz.dot(x))
    return depth
