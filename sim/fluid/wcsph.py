"""Weakly compressible SPH (Becker & Teschner 2007), advanced by velocity Verlet.

Density      rho_i = sum_j m W_ij + rho0 (sum_b V_b W_ib + walls)                     Akinci 2012, eq. 6
Pressure     p_i = B ((rho_i / rho0)^7 - 1), B = rho0 c^2 / 7, never negative          Becker & Teschner 2007, eq. 7
Momentum     a_i = -sum_j m (p_i/rho_i^2 + p_j/rho_j^2) grad W_ij + ...                Monaghan 1992, eq. 3.3
Solids       add -p_i/rho_i^2 times the gradient of what they add to rho_i          Akinci 2012, eq. 9
"""

import math

import taichi as ti

from sim.arrays import IntArray, IntTable, Vec4Array, vec3
from sim.fluid.forces import artificial, cohesion_coefficient, viscous
from sim.fluid.kernel import cubic, cubic_slope
from sim.fluid.system import FluidSystem
from sim.fluid.walls import wall_damping, wall_gradient, wall_volume

GAMMA = 7.0
"""Exponent of the equation of state of water (Cole 1948)."""


class Wcsph:
    """Advances a FluidSystem; `speed_of_sound` in m/s."""

    def __init__(self, system: FluidSystem, speed_of_sound: float):
        spec = system.spec
        self.system = system
        self.speed_of_sound = speed_of_sound
        system.wall_damping = spec.wcsph.wall_damping * speed_of_sound
        self.stiffness = spec.rest_density * speed_of_sound**2 / GAMMA
        self.cohesion = cohesion_coefficient(
            spec.surface_tension, spec.spacing, system.h, system.mass, spec.rest_density
        )

    def step_limit(self, v_max: float, a_max: float, cfl: float) -> float:
        """Largest stable time step [s]: sound, force and viscosity (Monaghan 1992, sec. 10)."""
        half = 0.5 * self.system.h
        alpha = self.system.spec.wcsph.artificial_viscosity
        nu = self.system.spec.viscosity + 0.1 * alpha * half * self.speed_of_sound
        limits = [cfl * half / (self.speed_of_sound + v_max)]
        if a_max > 0:
            limits.append(0.25 * math.sqrt(half / a_max))
        if nu > 0:
            limits.append(0.125 * half * half / nu)
        return min(limits)

    def start(self) -> None:
        """Find the accelerations of the initial state, or of one that an event has changed."""
        self._accelerate()

    def advance(self, dt: float) -> None:
        """One step of velocity Verlet; forces that depend on velocity take it at half the step."""
        particles = self.system.particles
        _drift(self.system.count, dt, particles.position, particles.velocity, particles.acceleration)
        self._accelerate()
        _kick(self.system.count, dt, particles.velocity, particles.acceleration)

    def _accelerate(self) -> None:
        system = self.system
        system.find_neighbors()
        if not system.count:
            return
        spec, particles, boundary = system.spec, system.particles, system.boundary
        _density(
            system.count,
            system.h,
            system.mass,
            spec.rest_density,
            self.stiffness,
            particles.position,
            particles.velocity,
            system.neighbors.size,
            system.neighbors.index,
            boundary.count > 0,
            boundary.samples,
            boundary.neighbors.size,
            boundary.neighbors.index,
            system.walls.count,
            system.walls.weight,
            system.walls.planes,
        )
        _force(
            system.count,
            system.h,
            spec.spacing,
            system.mass,
            spec.rest_density,
            self.speed_of_sound,
            vec3(*system.gravity),
            particles.position,
            particles.velocity,
            particles.acceleration,
            system.neighbors.size,
            system.neighbors.index,
            boundary.count > 0,
            boundary.samples,
            boundary.neighbors.size,
            boundary.neighbors.index,
            system.walls.count,
            system.walls.weight,
            system.walls.planes,
            spec.viscosity > 0,
            spec.viscosity,
            spec.wcsph.artificial_viscosity > 0,
            spec.wcsph.artificial_viscosity,
            spec.wcsph.wall_damping > 0,
            spec.wcsph.wall_damping,
            spec.surface_tension > 0,
            self.cohesion,
        )


@ti.kernel
def _drift(count: ti.i32, dt: ti.f32, position: Vec4Array, velocity: Vec4Array, acceleration: Vec4Array):
    for i in range(count):
        v = velocity[i].xyz + 0.5 * dt * acceleration[i].xyz
        velocity[i].xyz = v
        position[i].xyz += dt * v


@ti.kernel
def _kick(count: ti.i32, dt: ti.f32, velocity: Vec4Array, acceleration: Vec4Array):
    for i in range(count):
        velocity[i].xyz += 0.5 * dt * acceleration[i].xyz


@ti.kernel
def _density(
    count: ti.i32,
    h: ti.f32,
    mass: ti.f32,
    rest_density: ti.f32,
    stiffness: ti.f32,
    position: Vec4Array,
    velocity: Vec4Array,
    size: IntArray,
    index: IntTable,
    has_boundary: ti.template(),
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    wall_count: ti.i32,
    wall_weight: ti.f32,
    planes: Vec4Array,
):
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h * inverse_h * inverse_h
    for i in range(count):
        x = position[i].xyz
        near = 0.0
        for k in range(size[i]):
            near += cubic((x - position[index[i, k]].xyz).norm() * inverse_h)
        density = mass * norm * near
        if ti.static(has_boundary):
            solid = 0.0
            for k in range(sample_size[i]):
                b = samples[sample_index[i, k]]
                solid += b.w * cubic((x - b.xyz).norm() * inverse_h)
            density += rest_density * norm * solid
        density += rest_density * wall_weight * wall_volume(x, wall_count, planes, inverse_h)
        ratio = density / rest_density
        ratio2 = ratio * ratio
        pressure = ti.max(stiffness * (ratio2 * ratio2 * ratio2 * ratio - 1.0), 0.0)
        velocity[i].w = density
        position[i].w = pressure / (density * density)


@ti.kernel
def _force(
    count: ti.i32,
    h: ti.f32,
    spacing: ti.f32,
    mass: ti.f32,
    rest_density: ti.f32,
    speed_of_sound: ti.f32,
    gravity: vec3,
    position: Vec4Array,
    velocity: Vec4Array,
    acceleration: Vec4Array,
    size: IntArray,
    index: IntTable,
    has_boundary: ti.template(),
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    wall_count: ti.i32,
    wall_weight: ti.f32,
    planes: Vec4Array,
    has_viscosity: ti.template(),
    viscosity: ti.f32,
    has_artificial: ti.template(),
    alpha: ti.f32,
    has_damping: ti.template(),
    wall_alpha: ti.f32,
    has_cohesion: ti.template(),
    cohesion: ti.f32,
):
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h * inverse_h * inverse_h
    slope_norm = norm * inverse_h * inverse_h
    half_hc = 0.5 * h * speed_of_sound
    softening = 0.01 * h * h
    nearest2 = 1e-8 * h * h
    for i in range(count):
        x, v = position[i], velocity[i]
        a, pull = vec3(0.0), vec3(0.0)
        for k in range(size[i]):
            j = index[i, k]
            xj, vj = position[j], velocity[j]
            d = x.xyz - xj.xyz
            r2 = d.dot(d)
            inverse_r = ti.rsqrt(ti.max(r2, nearest2))
            q = r2 * inverse_r * inverse_h
            along = -(x.w + xj.w)
            if ti.static(has_viscosity or has_artificial):
                approach = (v.xyz - vj.xyz).dot(d)
                friction = 0.0
                if ti.static(has_viscosity):
                    friction += viscous(approach, viscosity)
                if ti.static(has_artificial):
                    friction += artificial(approach, alpha * half_hc)
                along += 2.0 * friction / ((v.w + vj.w) * (r2 + softening))
            a += along * cubic_slope(q, inverse_r * h) * d
            if ti.static(has_cohesion):
                pull -= cubic(ti.max(q, spacing * inverse_h)) * d
        a = mass * slope_norm * a + cohesion * norm * pull
        if ti.static(has_boundary):
            for k in range(sample_size[i]):
                b = samples[sample_index[i, k]]
                d = x.xyz - b.xyz
                r2 = d.dot(d)
                inverse_r = ti.rsqrt(ti.max(r2, nearest2))
                friction = 0.0
                if ti.static(has_viscosity):
                    friction += viscous(v.xyz.dot(d), viscosity)
                if ti.static(has_damping):
                    friction += artificial(v.xyz.dot(d), wall_alpha * half_hc)
                along = -x.w + friction / (v.w * (r2 + softening))
                slope = cubic_slope(r2 * inverse_r * inverse_h, inverse_r * h)
                a += rest_density * slope_norm * b.w * along * slope * d
        a -= x.w * rest_density * wall_weight * wall_gradient(x.xyz, wall_count, planes, inverse_h)
        if ti.static(has_damping):
            strength = wall_alpha * half_hc * rest_density * wall_weight / v.w
            a += wall_damping(x.xyz, v.xyz, wall_count, planes, inverse_h, strength)
        acceleration[i].xyz = a + gravity
