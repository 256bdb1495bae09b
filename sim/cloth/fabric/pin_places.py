"""Where held points are to be."""

from sim.device.compiler import ti
from sim.device.double import Integers, Vectors


@ti.kernel
def put(count: ti.i32, points: Integers, targets: Vectors, place: Vectors):
    """Write the `targets` [m] of so many points to their rows of `place`."""
    for k in range(count):
        place[points[k]] = targets[k]
