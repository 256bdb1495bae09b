"""Accelerations of particles by all forces that are given by positions and velocities.

a_i = -B_i sum_j m (p_i/rho_i^2 + p_j/rho_j^2) grad W_ij      Monaghan 1992, eq. 3.3; B is `half_space.along_faces`
    + 2 (dim + 2) nu sum_j m 2/(rho_i + rho_j) (v_ij.x_ij)/(x_ij^2 + 0.01 h^2) grad W_ij      Monaghan 2005, eq. 4.27
    - kappa sum_j x_ij W(max(x_ij, d)) + g                                     Becker & Teschner 2007, eq. 15
Solids add the derivative of what they add to the density (Akinci et al. 2012, eq. 9), and friction
(`sim.fluid.forces.friction`).
"""

import taichi as ti

from sim.device.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4
from sim.fluid.boundary.half_space import along_faces, face_damping
from sim.fluid.boundary.look import surface_velocity
from sim.fluid.forces.force import ForceBySolids
from sim.fluid.forces.friction import NO_GRIP, face_friction, find_grip, sample_friction
from sim.fluid.forces.pairwise import SOFTENING, artificial, cohesion_coefficient, viscous
from sim.fluid.forces.registry import load_forces
from sim.fluid.kernel import cubic, cubic_norm, cubic_slope
from sim.fluid.packed import DENSITY, DISTANCE, VOLUME, Q
from sim.fluid.system import FluidSystem
from sim.fluid.time_step_limits import tension_limit, viscosity_limit
from sim.neighbors.spatial_hash import padded


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
        system.momentum = self
        self.pressure = pressure
        self.artificial = artificial
        self.damping = damping
        self.viscosity = 0.0 if system.implicit_viscosity else spec.viscosity
        self.friction_known = friction_known and self.viscosity > 0
        solids = system.boundary.shapes.count > 0 or system.boundary.sampled > 0
        self.grip = find_grip(spec) if self.viscosity > 0 and solids else NO_GRIP
        self.cohesion, self._added = 0.0, load_forces(system)
        self.adhesion = next((force for force in self._added if isinstance(force, ForceBySolids)), None)
        """`sim.fluid.forces.adhesion`, where there is any."""
        if spec.surface_tension_model == "becker2007":
            self.cohesion = cohesion_coefficient(
                spec.surface_tension, spec.spacing, system.h, system.mass, spec.rest_density
            )

    def step_limits(self) -> dict[str, float]:
        """Largest stable time steps [s] that do not depend on the particles' motion."""
        explicit = self.viscosity + 0.1 * self.artificial
        half, spec, bodies = 0.5 * self.system.h, self.system.spec, self.system.bodies
        # What slows a particle against a body speeds up the body, the more the lighter it is.
        strongest = self.grip.strongest * (1.0 + bodies.layer_mass_ratio if bodies else 1.0)
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
        system = self.system
        spec, particles, boundary = system.spec, system.particles, system.boundary
        _accelerate(
            system.count,
            system.h,
            spec.spacing,
            system.mass,
            spec.rest_density,
            vec3(*system.gravity),
            particles.position,
            particles.velocity,
            particles.acceleration,
            *system.lists,
            boundary.velocity,
            boundary.shapes.count > 0,
            boundary.faces.share,
            *boundary.faces.lists,
            boundary.faces.solid,
            boundary.shapes.pose,
            self.pressure,
            self.friction_known,
            particles.pressure_acceleration if self.friction_known else particles.acceleration,
            self.viscosity > 0 and not self.friction_known,
            self.viscosity,
            self.grip.walls > 0,
            self.grip.samples,
            self.grip.nearest,
            self.artificial > 0,
            self.artificial,
            self.damping > 0,
            self.damping,
            self.cohesion > 0,
            self.cohesion,
        )
        for force in self._added:
            force.accelerate()


@ti.kernel
def _accelerate(
    count: ti.i32,
    h: real,
    spacing: real,
    mass: real,
    rest_density: real,
    gravity: vec3,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    size: IntArray,
    index: IntTable,
    has_samples: ti.template(),
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    sample_velocity: Vec4Array,
    has_solids: ti.template(),
    solids: Vec4Array,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    solid: IntArray,
    pose: DoubleTable,
    has_pressure: ti.template(),
    has_friction: ti.template(),
    friction: Vec4Array,
    has_viscosity: ti.template(),
    viscosity: real,
    has_grip: ti.template(),
    sample_viscosity: real,
    nearest_sample: real,
    has_artificial: ti.template(),
    artificial_strength: real,
    has_damping: ti.template(),
    damping_strength: real,
    has_cohesion: ti.template(),
    cohesion: real,
):
    inverse_h = 1.0 / h
    norm = cubic_norm(inverse_h)
    slope_norm = norm * inverse_h * inverse_h
    softening = SOFTENING * h * h
    closest = spacing * inverse_h
    for i in range(count):
        x, v = position[i], velocity[i]
        push, rub, pull = vec3(0.0), vec3(0.0), vec3(0.0)
        if ti.static(has_pressure or has_viscosity or has_artificial or has_cohesion):
            for k in range(padded(size[i])):
                j = index[i, k]
                xj = position[j]
                d = x.xyz - xj.xyz
                r2 = d.dot(d)
                q = ti.sqrt(r2) * inverse_h
                slope = cubic_slope(q)
                if ti.static(has_pressure):
                    push -= (x[Q] + xj[Q]) * slope * d  # Monaghan 1992, eq. 3.3
                if ti.static(has_viscosity or has_artificial):
                    vj = velocity[j]
                    approach = (v.xyz - vj.xyz).dot(d)
                    strength = ti.cast(0.0, real)
                    if ti.static(has_viscosity):
                        strength += viscous(approach, viscosity)
                    if ti.static(has_artificial):
                        strength += artificial(approach, artificial_strength)
                    rub += 2.0 * strength / ((v[DENSITY] + vj[DENSITY]) * (r2 + softening)) * slope * d
                if ti.static(has_cohesion):
                    pull -= cubic(ti.max(q, closest)) * d
        push *= mass * slope_norm
        a = mass * slope_norm * rub + cohesion * norm * pull
        if ti.static(has_friction):
            a += friction[i].xyz
        if ti.static(has_samples and (has_pressure or has_grip or has_damping)):
            for k in range(sample_size[i]):
                b = samples[sample_index[i, k]]
                d = x.xyz - b.xyz
                r2 = d.dot(d)
                relative = v.xyz - sample_velocity[sample_index[i, k]].xyz
                strength = rest_density * slope_norm * b[VOLUME]
                gradient = strength * cubic_slope(ti.sqrt(r2) * inverse_h) * d
                if ti.static(has_pressure):
                    push -= x[Q] * gradient  # Akinci et al. 2012, eq. 9
                if ti.static(has_damping):
                    a += artificial(relative.dot(d), damping_strength) / (v[DENSITY] * (r2 + softening)) * gradient
                if ti.static(has_grip):
                    grip = sample_viscosity * sample_friction(d, relative, nearest_sample, inverse_h)
                    a += strength / v[DENSITY] * grip
        if ti.static(has_pressure):
            if ti.static(has_solids):
                push -= x[Q] * rest_density * solids[i].xyz
                push = along_faces(i, push, begin, solids_near, face, held, fit, inverse_h)
            a += push
        if ti.static(has_solids and (has_damping or has_grip)):
            for e in range(begin[i], begin[i] + solids_near[i]):
                one, heavy = face[e], face_weight[e] * rest_density / v[DENSITY]
                relative = v.xyz - surface_velocity(solid[e], x.xyz, pose)
                if ti.static(has_damping):
                    a += (
                        heavy
                        * face_damping(one[DISTANCE], one.xyz.dot(relative), fit, inverse_h, damping_strength)
                        * one.xyz
                    )
                if ti.static(has_grip):
                    a += heavy * viscosity * face_friction(one, relative, spacing, inverse_h)
        acceleration[i].xyz = a + gravity
