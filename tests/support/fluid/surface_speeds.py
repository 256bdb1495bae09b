"""Velocities of the surfaces of solids, as kernels find them."""

from sim.device.arrays import DoubleTable, IntArray, Vec4Array
from sim.device.compiler import ti
from sim.fluid.boundary.half_spaces.pose import surface_velocity


@ti.kernel
def surface_speeds(count: ti.i32, x: Vec4Array, solid: IntArray, begin: IntArray, pose: DoubleTable, out: Vec4Array):
    """Of the first solid listed for each of the points [m]; written [m/s]."""
    for i in range(count):
        out[i].xyz = surface_velocity(solid[begin[i]], x[i].xyz, pose)
