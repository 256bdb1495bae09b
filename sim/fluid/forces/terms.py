"""Terms of the momentum equation that positions and velocities give, as kernels of fluid and couplings take them.

What solids do to particles is written once, here: couplings apply the opposite to the solids.
"""

from dataclasses import dataclass
from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import real, vec3
from sim.device.compiler import ti
from sim.fluid.boundary.half_space import face_damping
from sim.fluid.forces.friction import face_friction, sample_friction
from sim.fluid.forces.pairwise import SOFTENING, artificial
from sim.fluid.kernel import cubic_slope
from sim.fluid.layout import DISTANCE

PRESSURE, FRICTION, VISCOSITY, WALL_FRICTION, ARTIFICIAL, DAMPING, COHESION, ADHESION, SAMPLES, SOLIDS = (
    1 << bit for bit in range(10)
)
"""Bits of the terms to compile: FRICTION is viscosity that a solver has found already, WALL_FRICTION and DAMPING are
viscosity and artificial viscosity between particles and solids."""
BY_SOLIDS = PRESSURE | WALL_FRICTION | DAMPING | ADHESION
"""Those whose opposite couplings apply to solids."""

Coefficients: Any = argpack(
    gravity=vec3,
    viscosity=real,
    sample_viscosity=real,
    nearest_sample=real,
    artificial=real,
    damping=real,
    cohesion=real,
)
"""Of the terms: acceleration by gravity [m/s^2]; kinematic viscosity in the fluid and against samples of sheets
[m^2/s], and the distance over h nearer than which these slow it no more; artificial viscosity between particles and
against solids, alpha c h / 2 [m^2/s]; kappa of the cohesion [m^3/s^2]."""


@dataclass(frozen=True)
class Terms:
    """Of one system: `bits` of those to compile, their coefficients, kinematic viscosity where it acts as a force
    [m^2/s], and strength of the adhesion [m/s^2 over m^3] to samples and to solids."""

    bits: int
    coefficients: Coefficients
    viscosity: float
    adhesion_samples: float = 0.0
    adhesion_solids: float = 0.0


@ti.func
def slowed_by_face(
    a: vec3,
    e: ti.i32,
    relative: vec3,
    density: real,
    terms: ti.template(),
    viscosity: real,
    coefficients: ti.template(),
    fluid: ti.template(),
    walls: ti.template(),
    inverse_h: real,
) -> vec3:
    """Acceleration `a` [m/s^2] of a particle of this density [kg/m^3], with DAMPING and WALL_FRICTION of half-space e,
    which it passes at the `relative` velocity [m/s]."""
    changed, one = a, walls.face[e]
    share = walls.weight[e] * fluid.rest_density / density
    if ti.static(terms & DAMPING):
        closing = one.xyz.dot(relative)
        changed += share * face_damping(one[DISTANCE], closing, walls.fit, inverse_h, coefficients.damping) * one.xyz
    if ti.static(terms & WALL_FRICTION):
        changed += share * viscosity * face_friction(one, relative, walls.spacing, inverse_h)
    return changed


@ti.func
def slowed_by_sample(
    a: vec3,
    d: vec3,
    relative: vec3,
    density: real,
    strength: real,
    terms: ti.template(),
    coefficients: ti.template(),
    fluid: ti.template(),
    inverse_h: real,
) -> vec3:
    """The same for a sample of a sheet, to a particle of this density [kg/m^3] at `d` [m] from it; strength: rest
    density times the sample's volume and the norm of the kernel's slope [kg/m^5]."""
    changed = a
    if ti.static(terms & DAMPING):
        r2 = d.dot(d)
        slope = strength * cubic_slope(ti.sqrt(r2) * inverse_h) * d
        softening = SOFTENING * fluid.h * fluid.h
        changed += artificial(relative.dot(d), coefficients.damping) / (density * (r2 + softening)) * slope
    if ti.static(terms & WALL_FRICTION):
        friction = sample_friction(d, relative, coefficients.nearest_sample, inverse_h)
        changed += strength / density * (coefficients.sample_viscosity * friction)
    return changed
