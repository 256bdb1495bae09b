"""Particles for which solids that close in on each other leave no room.

A gap narrower than a layer of particles holds less than one of them on each square of the spacing. As it closes on,
those that are left would have to get out at any speed, and the last would hold the solids apart like balls of steel.
What is left in so thin a film is taken out of the fluid, and counted.
"""

import numpy as np
import taichi as ti

from sim.arrays import IntArray, IntTable, Particles, Vec4Array, real, vec4
from sim.fluid.boundary import Boundary
from sim.fluid.calibration import lack
from sim.fluid.kernel import cubic, cubic_slope
from sim.fluid.walls import Walls, wall_share

CROWD = 1.7
"""In what a solid adds to the density of the layer next to it: where the mean of two is more, there is room for half a
layer between them."""
FACING = -0.5
"""Cosine of the angle between their gradients under which solids face each other."""
NOBODY = 1e9


class Squeezed:
    """Takes particles out between solids, some of which move; spacing of the fluid and support radius h [m]."""

    def __init__(self, boundary: Boundary, walls: Walls, spacing: float, h: float):
        self.boundary, self.walls = boundary, walls
        self.h = h
        self.crowd = CROWD * lack(spacing, h).density
        self._keep = ti.ndarray(ti.i32, 1)

    def remove(self, particles: Particles) -> int:
        """Take out what has no room where particles and samples are now, whose neighbours are known; how many."""
        boundary, walls, count = self.boundary, self.walls, particles.count
        if count > self._keep.shape[0]:
            self._keep = ti.ndarray(ti.i32, particles.capacity)
        found = _find(
            count,
            len(boundary.points),
            self.h,
            self.crowd,
            particles.position,
            boundary.samples,
            boundary.velocity,
            boundary.neighbors.size,
            boundary.neighbors.index,
            walls.count,
            walls.fit,
            walls.planes,
            self._keep,
        )
        if found:
            left = np.flatnonzero(self._keep.to_numpy()[:count]).astype(np.int32)
            particles.reorder(np.resize(left, count), len(left))
        return found


@ti.kernel
def _find(
    count: ti.i32,
    last: ti.i32,
    h: real,
    crowd: real,
    position: Vec4Array,
    samples: Vec4Array,
    sample_velocity: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
    keep: IntArray,
) -> ti.i32:
    """Write to `keep` which particles have room; returns how many have not. Samples from `last` on are of sheets, which
    give way."""
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h**3
    found = 0
    for i in range(count):
        x = position[i].xyz
        keep[i] = 1
        # Of the solid with the lowest number, and of all others; those that stand have none.
        first, others = vec4(0.0), vec4(0.0)
        lowest = ti.cast(NOBODY, real)
        for k in range(sample_size[i]):
            s = sample_index[i, k]
            if s >= last:
                continue
            d = x - samples[s].xyz
            q = d.norm() * inverse_h
            one = norm * samples[s].w * vec4(inverse_h * inverse_h * cubic_slope(q) * d, cubic(q))
            whose = sample_velocity[s].w
            if whose < lowest:
                others += first
                first = vec4(0.0)
                lowest = whose
            if whose == lowest:
                first += one
            else:
                others += one
        if lowest < ti.cast(NOBODY, real):
            walls = wall_share(x, wall_count, wall_fit, planes, inverse_h)
            if lowest == 0.0:
                first += walls
            else:
                others += walls
            facing = first.xyz.dot(others.xyz) < FACING * first.xyz.norm() * others.xyz.norm()
            if facing and ti.sqrt(first.w * others.w) > crowd:
                keep[i] = 0
                found += 1
    return found
