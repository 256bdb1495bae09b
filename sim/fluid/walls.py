"""Plane walls without particles.

What a half-space of fluid at rest would add to the density of a particle depends on its distance
alone. Where walls meet, what they have in common counts once; that share is calibrated for walls at right angles.
"""

import numpy as np
import taichi as ti

from sim.arrays import Vec4Array, numpy_real, real, vec3, vec4
from sim.fluid.calibration import calibrate_wall
from sim.fluid.kernel import halfspace_area, halfspace_volume, halfspace_volume_host


class Walls:
    """Planes n.x = offset with the solid below, as the solver sees them.

    planes: unit normals out of the solid and offsets [m], shape [n, 4]. Each is moved into the solid, and weighs
    more than its volume, so that a lattice half a spacing off the wall is at rest (`sim.fluid.calibration`).
    """

    def __init__(self, planes: np.ndarray, spacing: float, h: float):
        calibrated = calibrate_wall(spacing, h)
        self.setback = calibrated.distance - spacing / 2
        self.fit = vec4(calibrated.weight, calibrated.overlap, calibrated.along, self.setback / h)
        """Of the walls: weight, overlap and `along`, as `sim.fluid.calibration.Wall` has them, and setback over h."""
        self.count = len(planes)
        self.planes = ti.ndarray(vec4, max(self.count, 1))
        if self.count:
            shifted = planes - [0.0, 0.0, 0.0, self.setback]
            self.planes.from_numpy(shifted.astype(numpy_real))


@ti.func
def wall_share(x: vec3, count: ti.i32, fit: vec4, planes: Vec4Array, inverse_h: real) -> vec4:
    """What the walls add to the density at x, over rest density, in w, and its gradient with respect to x [1/m]."""
    weight, overlap = fit.x, fit.y
    share, void = ti.cast(0.0, real), ti.cast(1.0, real)
    gradient, void_gradient = vec3(0.0), vec3(0.0)
    for k in range(count):
        q = (planes[k].xyz.dot(x) - planes[k].w) * inverse_h
        if q < 1.0:
            own = weight * halfspace_volume(q)
            slope = -weight * halfspace_area(q) * inverse_h * planes[k].xyz
            left = overlap / (overlap + own)
            # The shares in common are sum p - (1 - prod (1 - p)), with p = own / (overlap + own).
            share += own - (1.0 - left)
            gradient += (1.0 - left * left / overlap) * slope
            void_gradient = left * void_gradient - void * left * left / overlap * slope
            void *= left
    return vec4(gradient - void_gradient, share + 1.0 - void)


@ti.func
def along_walls(x: vec3, a: vec3, count: ti.i32, fit: vec4, planes: Vec4Array, inverse_h: real) -> vec3:
    """B a: the acceleration by pressure as it would be, were there fluid beyond the walls too.

    Across a wall that is what its own force is for. Along it a particle has fewer neighbours than elsewhere to be
    pushed by: of sum_j x (dW/dx) / r dV, integrated by parts, what lies beyond the wall is missing, V. Taken half
    from the first wall to the last and half back again, B is symmetric however walls meet.
    """
    pushed = a
    for k in range(2 * count):
        plane = planes[ti.min(k, 2 * count - 1 - k)]
        q = ti.max((plane.xyz.dot(x) - plane.w) * inverse_h - fit.w, 0.0)
        if q < 1.0:
            factor = 1.0 / ti.sqrt(1.0 - fit.z * halfspace_volume(q))
            pushed = factor * pushed + (1.0 - factor) * plane.xyz.dot(pushed) * plane.xyz
    return pushed


def along_walls_host(points: np.ndarray, forces: np.ndarray, walls: Walls, h: float) -> np.ndarray:
    """`along_walls` on the host, for forces at points [m], both of shape [n, 3]."""
    planes = walls.planes.to_numpy().astype(float)[: walls.count]
    pushed = forces
    for plane in (*planes, *planes[::-1]):
        q = np.maximum((points @ plane[:3] - plane[3]) / h - walls.fit[3], 0.0)
        factor = 1.0 / np.sqrt(1.0 - walls.fit[2] * halfspace_volume_host(q))[:, None]
        pushed = factor * pushed + (1.0 - factor) * (pushed @ plane[:3])[:, None] * plane[:3]
    return pushed


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
