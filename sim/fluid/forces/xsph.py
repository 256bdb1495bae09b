"""XSPH (Monaghan 1989), applied to the velocities themselves (Schechter & Bridson 2012).

v_i += eps sum_j m 2 / (rho_i + rho_j) (v_j - v_i) W_ij: what one of a pair gains the other loses. It is no viscosity in
m^2/s: it acts once a step, however long that is.
"""

from sim.device.arrays import Declared, Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.kernel import cubic, cubic_norm
from sim.fluid.layout import DENSITY
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, padded

ARRAYS = (Declared("mixed", "vec4", "velocity after it [m/s]", sorted=False, saved=False),)


class Xsph:
    """Mixes the velocities of a system, whose arrays are those declared in ARRAYS."""

    def __init__(self, system: FluidSystem):
        self.system = system

    def apply(self) -> None:
        """Mix velocities once; positions, densities and neighbours are given."""
        system = self.system
        _mix(
            system.count,
            system.h,
            system.spec.xsph * system.mass,
            system.particles.position,
            system.particles.velocity,
            system.particles.mixed,
            system.neighbors.lists,
        )


@ti.kernel
def _mix(
    count: ti.i32,
    h: real,
    weight: real,
    position: Vec4Array,
    velocity: Vec4Array,
    mixed: Vec4Array,
    near: Neighbors,
):
    inverse_h = 1.0 / h
    norm = cubic_norm(inverse_h)
    for i in range(count):
        x, v = position[i].xyz, velocity[i]
        change = vec3(0.0)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            vj = velocity[j]
            change += (
                2.0 * cubic((x - position[j].xyz).norm() * inverse_h) / (v[DENSITY] + vj[DENSITY]) * (vj.xyz - v.xyz)
            )
        mixed[i].xyz = v.xyz + weight * norm * change
    for i in range(count):
        velocity[i].xyz = mixed[i].xyz
