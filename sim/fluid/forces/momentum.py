"""Accelerations of particles by all forces that are given by positions and velocities.

a_i = -B_i sum_j m (p_i/rho_i^2 + p_j/rho_j^2) grad W_ij      Monaghan 1992, eq. 3.3; B is `half_space.along_faces`
    + 2 (dim + 2) nu sum_j m 2/(rho_i + rho_j) (v_ij.x_ij)/(x_ij^2 + 0.01 h^2) grad W_ij      Monaghan 2005, eq. 4.27
    - kappa sum_j x_ij W(max(x_ij, d)) + g                                     Becker & Teschner 2007, eq. 15
Solids add the derivative of what they add to the density (Akinci et al. 2012, eq. 9), and friction
(`sim.fluid.forces.friction`).
"""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import Vec4Array, real, vec3
from sim.device.compiler import ti
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.boundary.half_spaces.pose import surface_velocity
from sim.fluid.forces.force import ForceBySolids
from sim.fluid.forces.friction import FREE_SLIP, find_wall_friction
from sim.fluid.forces.pairwise import SOFTENING, artificial, cohesion_coefficient, viscous
from sim.fluid.forces.registry import load_forces
from sim.fluid.forces.terms import (
    ADHESION,
    ARTIFICIAL,
    COHESION,
    DAMPING,
    FRICTION,
    PRESSURE,
    SAMPLES,
    SOLIDS,
    VISCOSITY,
    WALL_FRICTION,
    Coefficients,
    Terms,
    slowed_by_face,
    slowed_by_sample,
)
from sim.fluid.kernel import cubic, cubic_norm, cubic_slope
from sim.fluid.layout import DENSITY, VOLUME, Q, Resolution, Samples, Walls
from sim.fluid.system import FluidSystem
from sim.fluid.time_step_limits import tension_limit, viscosity_limit
from sim.neighbors.spatial_hash import Neighbors, padded

Accelerated: Any = argpack(
    position=Vec4Array, velocity=Vec4Array, acceleration=Vec4Array, pressure_acceleration=Vec4Array
)


class Momentum:
    """The forces that a specification asks for; what is zero is not compiled.

    pressure: whether pressures are known from the positions. artificial, damping: artificial viscosity between
    particles and against solids, alpha c h / 2 [m^2/s]. friction_known: the viscous forces between particles are in
    pressure_acceleration, where the solver has found them beside densities.
    """

    def __init__(
        self,
        system: FluidSystem,
        *,
        pressure: bool,
        artificial: float = 0.0,
        damping: float = 0.0,
        friction_known: bool = False,
    ):
        spec = system.spec
        self.system = system
        self.artificial = artificial
        self.viscosity = 0.0 if system.implicit_viscosity else spec.viscosity
        self.friction_known = friction_known and self.viscosity > 0
        solids = system.boundary.shapes.count > 0 or system.boundary.sampled > 0
        self.wall_friction = find_wall_friction(spec) if self.viscosity > 0 and solids else FREE_SLIP
        self.cohesion, self._added = 0.0, load_forces(system)
        adhesion = next((force for force in self._added if isinstance(force, ForceBySolids)), None)
        if spec.surface_tension_model == "becker2007":
            self.cohesion = cohesion_coefficient(
                spec.surface_tension, spec.spacing, system.h, system.mass, spec.rest_density
            )
        asked = {
            PRESSURE: pressure,
            FRICTION: self.friction_known,
            VISCOSITY: self.viscosity > 0 and not self.friction_known,
            WALL_FRICTION: self.wall_friction.walls > 0,
            ARTIFICIAL: artificial > 0,
            DAMPING: damping > 0,
            COHESION: self.cohesion > 0,
            ADHESION: adhesion is not None,
        }
        coefficients = Coefficients(
            vec3(*system.gravity),
            self.viscosity,
            self.wall_friction.samples,
            self.wall_friction.nearest,
            artificial,
            damping,
            self.cohesion,
        )
        bits = sum(bit for bit, wanted in asked.items() if wanted)
        strengths = (adhesion.samples, adhesion.solids) if adhesion else ()
        system.terms = self.terms = Terms(bits, coefficients, self.viscosity, *strengths)

    def step_limits(self) -> dict[str, float]:
        """Largest stable time steps [s] that do not depend on the particles' motion."""
        explicit = self.viscosity + 0.1 * self.artificial
        half, spec, bodies = 0.5 * self.system.h, self.system.spec, self.system.bodies
        # What slows a particle against a body speeds up the body, the more the lighter it is.
        strongest = self.wall_friction.strongest * (1.0 + bodies.layer_mass_ratio if bodies else 1.0)
        return {
            "viscosity": viscosity_limit(half, explicit, strongest),
            "surface tension": tension_limit(half, spec),
        }

    def limiting_term(self, term: str) -> tuple[str, str]:
        """What one of `step_limits` comes from, and what would help."""
        spec = self.system.spec
        match term:
            case "viscosity":
                remedy = "use fluid.viscosity_solver: implicit, a lower fluid.viscosity, or larger particles"
                return f"the viscosity ({spec.viscosity:.3g} m^2/s)", remedy
            case "surface tension":
                tension = max(spec.surface_tension, spec.adhesion)
                return f"the surface tension ({tension:.3g} N/m)", "use a lower one, or larger particles"
        raise ValueError(f"nothing limits steps by the name '{term}'")

    def accelerate(self) -> None:
        """Write the accelerations of all particles; positions, velocities, densities and neighbours are given."""
        system, boundary = self.system, self.system.boundary
        present = (SAMPLES if boundary.sampled > 0 else 0) | (SOLIDS if boundary.shapes.count > 0 else 0)
        _accelerate(
            self.terms.bits | present,
            system.count,
            system.resolution,
            self.terms.coefficients,
            system.particles.bundle(Accelerated)
            if self.friction_known
            else system.particles.bundle(Accelerated, pressure_acceleration="acceleration"),
            system.neighbors.lists,
            boundary.near_samples,
            boundary.faces.lists,
        )
        for force in self._added:
            force.accelerate()


@ti.kernel
def _accelerate(
    terms: ti.template(),
    count: ti.i32,
    fluid: Resolution,
    coefficients: Coefficients,
    p: Accelerated,
    near: Neighbors,
    samples: Samples,
    walls: Walls,
):
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    slope_norm = norm * inverse_h * inverse_h
    softening = SOFTENING * fluid.h * fluid.h
    closest = fluid.spacing * inverse_h
    for i in range(count):
        x, v = p.position[i], p.velocity[i]
        push, rub, pull = vec3(0.0), vec3(0.0), vec3(0.0)
        if ti.static(terms & (PRESSURE | VISCOSITY | ARTIFICIAL | COHESION)):
            for k in range(padded(near.size[i])):
                j = near.index[near.begin[i] + k]
                xj = p.position[j]
                d = x.xyz - xj.xyz
                r2 = d.dot(d)
                q = ti.sqrt(r2) * inverse_h
                slope = cubic_slope(q)
                if ti.static(terms & PRESSURE):
                    push -= (x[Q] + xj[Q]) * slope * d  # Monaghan 1992, eq. 3.3
                if ti.static(terms & (VISCOSITY | ARTIFICIAL)):
                    vj = p.velocity[j]
                    approach = (v.xyz - vj.xyz).dot(d)
                    strength = ti.cast(0.0, real)
                    if ti.static(terms & VISCOSITY):
                        strength += viscous(approach, coefficients.viscosity)
                    if ti.static(terms & ARTIFICIAL):
                        strength += artificial(approach, coefficients.artificial)
                    rub += 2.0 * strength / ((v[DENSITY] + vj[DENSITY]) * (r2 + softening)) * slope * d
                if ti.static(terms & COHESION):
                    pull -= cubic(ti.max(q, closest)) * d
        push *= fluid.mass * slope_norm
        a = fluid.mass * slope_norm * rub + coefficients.cohesion * norm * pull
        if ti.static(terms & FRICTION):
            a += p.pressure_acceleration[i].xyz
        if ti.static(terms & SAMPLES and terms & (PRESSURE | WALL_FRICTION | DAMPING)):
            for k in range(samples.size[i]):
                b = samples.sample[samples.index[samples.begin[i] + k]]
                d = x.xyz - b.xyz
                relative = v.xyz - samples.velocity[samples.index[samples.begin[i] + k]].xyz
                strength = fluid.rest_density * slope_norm * b[VOLUME]
                if ti.static(terms & PRESSURE):
                    push -= x[Q] * (strength * cubic_slope(d.norm() * inverse_h) * d)  # Akinci et al. 2012, eq. 9
                a = slowed_by_sample(a, d, relative, v[DENSITY], strength, terms, coefficients, fluid, inverse_h)
        if ti.static(terms & PRESSURE):
            if ti.static(terms & SOLIDS):
                push -= x[Q] * fluid.rest_density * walls.share[i].xyz
                push = along_faces(i, push, walls, inverse_h)
            a += push
        if ti.static(terms & SOLIDS and terms & (DAMPING | WALL_FRICTION)):
            for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                relative = v.xyz - surface_velocity(walls.solid[e], x.xyz, walls.pose)
                a = slowed_by_face(
                    a, e, relative, v[DENSITY], terms, coefficients.viscosity, coefficients, fluid, walls, inverse_h
                )
        p.acceleration[i].xyz = a + coefficients.gravity
