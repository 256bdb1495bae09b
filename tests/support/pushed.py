"""What pressures do to particles beside walls, for tests."""

import taichi as ti

from sim.device.arrays import IntArray, IntTable, RealArray, Vec4Array, real, vec4
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.forces.pairwise import pair_pressures


@ti.kernel
def push_along(
    position: Vec4Array,
    correction: Vec4Array,
    skew: Vec4Array,
    size: IntArray,
    index: IntTable,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    held: RealArray,
    fit: vec4,
    inverse_h: real,
    push: Vec4Array,
):
    """Accelerations by the pressures of pairs, over the kernel's norm, and what surfaces make good along them."""
    for i in range(push.shape[0]):
        a = pair_pressures(i, position, True, correction, skew, size, index, inverse_h)
        push[i].xyz = along_faces(i, a, begin, solids_near, face, held, fit, inverse_h)
