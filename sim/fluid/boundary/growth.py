"""How fast what solids add to the density of a particle may grow: no faster than it can come nearer to them.

Which faces of a mesh a particle is before is decided anew all the time. One that is seen where it was not before, as at
the rim of a full boat, would push off at once what is next to it, the faster, the shorter the step. So pressure is told
of it only as fast as if the particle came nearer at its speed, or at the pace of a slow fall.
"""

import taichi as ti

from sim.arrays import DoubleTable, IntArray, real, vec3
from sim.fluid.boundary.gaps import PACE
from sim.fluid.boundary.look import surface_velocity

UNTOLD = 1e9
"""What a particle that is new counts as told of: all."""


@ti.func
def fastest_approach(
    v: vec3, x: vec3, fall: real, first: ti.i32, last: ti.i32, solid: IntArray, pose: DoubleTable
) -> real:
    """Speed [m/s] at which a particle at x may come nearer to any of the solids that are listed for it; fall: g d
    [m^2/s^2]."""
    speed = ti.cast(0.0, real)
    for e in range(first, last):
        speed = ti.max(speed, (v - surface_velocity(solid[e], x, pose)).norm())
    return speed + PACE * ti.sqrt(fall)


@ti.func
def told_of(total: real, before: real, steep: real, way: real) -> real:
    """The share that pressure is told of, of a `total`, where it was told of that `before`, and the particle may since
    have come nearer by this way [m]; steep: the sum of the slopes of the solids' shares [1/m], which grow on the
    way."""
    return ti.min(total, before + steep * way)
