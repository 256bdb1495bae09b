"""Where held points are led."""

import taichi as ti

from sim.device.double import Integers, Vectors


@ti.kernel
def put(count: ti.i32, points: Integers, aims: Vectors, place: Vectors):
    """Write the `aims` [m] of so many points to their rows of `place`."""
    for k in range(count):
        place[points[k]] = aims[k]
