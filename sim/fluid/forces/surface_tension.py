"""Surface tension by cohesion and a pull towards a smaller surface (Akinci et al. 2013a).

a_i = -gamma sum_j 2 rho0 / (rho_i + rho_j) [c m C(r) x_ij / r + n_i - n_j],    n_i = h sum_j m / rho_j grad W_ij
C(r) = 32 / (pi h^9) { (h - r)^3 r^3 beyond h/2,  2 (h - r)^3 r^3 - h^6 / 64 up to there }            eq. 1 to 5
C attracts beyond some distance and repels below; the pull presses the layers of the surface apart, and so lets the
pressure along it fall. The proportion c of the two depends on the unit of mass in the paper, here it is the same
for all fluids and resolutions. Pair forces are equal and opposite.
"""

from typing import ClassVar

import numpy as np

from sim.device.arrays import Declared, Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.forces.force import Force
from sim.fluid.kernel import cubic_slope, slope_norm
from sim.fluid.layout import DENSITY, Resolution
from sim.fluid.system import FluidSystem
from sim.neighbors.spatial_hash import Neighbors, padded

BALANCE = 25.0
"""c m / h^3. With 125, the paper's for water at h = 2 d in SI units, cohesion presses the particles together with many
times the pressure that the tension causes, and a drop creeps like a paste: its oscillation is damped some five times
as fast. Without cohesion the second term scatters the particles."""
AREA = 0.331
"""What the second term adds to the tension of a flat surface, times m / (gamma rho0^2 h^5), by the mechanical
definition: half the integral over all pairs of n_i - n_j along their distance, along z. Its forces run across the
surface and press the layers apart, so that the pressure between them, which acts along the surface too, is less."""


def strength(surface_tension: float, spacing: float, h: float, rest_density: float) -> float:
    """gamma [m/s^2] that gives a surface tension in N/m: the first term's share is that of any pair force,
    pi/8 n^2 times the integral of r^4 f(r) (Tartakovsky & Panchenko 2016, eq. 29), the second one's is AREA."""
    q = (np.arange(2000) + 0.5) / 2000
    bell = (1.0 - q) ** 3 * q**3
    c = 32.0 / np.pi * np.where(q < 0.5, 2.0 * bell - 1.0 / 64.0, bell)
    share = (np.pi / 8.0 * BALANCE * float((q**4 * c).mean()) + AREA) * (h / spacing) ** 3
    return surface_tension / (rest_density * h * h * share)


class SurfaceTension(Force):
    """The force on the particles of a system, whose arrays are those declared in ARRAYS."""

    ARRAYS: ClassVar[tuple[Declared, ...]] = (
        Declared("normal", "vec4", "normal n into the fluid, without unit", sorted=False, saved=False),
    )

    def __init__(self, system: FluidSystem):
        super().__init__(system)
        spec = system.spec
        self.strength = strength(spec.surface_tension, spec.spacing, system.h, spec.rest_density)

    def accelerate(self) -> None:
        system = self.system
        particles = system.particles
        _accelerate(
            system.count,
            system.resolution,
            self.strength,
            particles.position,
            particles.velocity,
            particles.acceleration,
            particles.normal,
            system.neighbors.lists,
        )


@ti.func
def cohesion(q: real) -> real:
    """C h^3 at q = r / h (Akinci et al. 2013a, eq. 2)."""
    rest = ti.max(1.0 - q, 0.0)
    bell = rest * rest * rest * q * q * q
    return 32.0 / ti.math.pi * ti.select(q < 0.5, 2.0 * bell - 1.0 / 64.0, bell)


@ti.kernel
def _accelerate(
    count: ti.i32,
    fluid: Resolution,
    strength: real,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    normal: Vec4Array,
    near: Neighbors,
):
    h = fluid.h
    inverse_h = 1.0 / h
    slope_strength = slope_norm(inverse_h)
    for i in range(count):
        x = position[i].xyz
        n = vec3(0.0)
        for k in range(padded(near.size[i])):
            j = near.index[near.begin[i] + k]
            d = x - position[j].xyz
            n += cubic_slope(d.norm() * inverse_h) / velocity[j][DENSITY] * d
        normal[i] = vec4(h * fluid.mass * slope_strength * n, velocity[i][DENSITY])  # Akinci et al. 2013a, eq. 3
    for i in range(count):
        x, n = position[i].xyz, normal[i]
        a = vec3(0.0)
        for k in range(padded(near.size[i])):
            nj = normal[near.index[near.begin[i] + k]]
            d = x - position[near.index[near.begin[i] + k]].xyz
            r = ti.max(d.norm(), 1e-6 * h)
            pull = BALANCE * cohesion(r * inverse_h) / r * d + n.xyz - nj.xyz
            # Lists may hold pairs that are further apart.
            a -= ti.select(r < h, 2.0 * fluid.rest_density / (n[DENSITY] + nj[DENSITY]), 0.0) * pull
        acceleration[i].xyz += strength * a
