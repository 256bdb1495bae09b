"""What pressures do to particles beside walls, for tests."""

from sim.device.arrays import Vec4Array, real
from sim.device.compiler import ti
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.forces.pairwise import Lens, pair_pressures
from sim.fluid.layout import Walls
from sim.neighbors.spatial_hash import Neighbors


@ti.kernel
def push_along(
    position: Vec4Array,
    lens: Lens,
    near: Neighbors,
    walls: Walls,
    inverse_h: real,
    push: Vec4Array,
):
    """Accelerations by the pressures of pairs, over the kernel's norm, and what surfaces make good along them."""
    for i in range(push.shape[0]):
        a = pair_pressures(i, position, True, lens, near, inverse_h)
        push[i].xyz = along_faces(i, a, walls, inverse_h)
