"""The sums of `sim.coupling.fluid_cloth.sheet_samples` on the device."""

import taichi as ti

from sim.device.arrays import IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4
from sim.device.double import Integers, Numbers, Vectors
from sim.device.double import vec3 as vec3d
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.boundary.one_sided_samples import beyond
from sim.fluid.forces.adhesion import adhesion
from sim.fluid.forces.friction import sample_friction
from sim.fluid.forces.pairwise import SOFTENING, artificial
from sim.fluid.kernel import cubic_slope, slope_norm
from sim.fluid.packed import DENSITY, VOLUME, Q


@ti.kernel
def move(
    count: ti.i32,
    points: ti.i32,
    depth: ti.f64,
    weight: ti.f64,
    origin: vec3d,
    corners: Integers,
    weights: Vectors,
    share: Numbers,
    place: Vectors,
    speed: Vectors,
    here: Vec4Array,
    facing: Vec4Array,
    samples: Vec4Array,
    velocity: Vec4Array,
) -> ti.f64:
    """Bring samples to where the corners are; `weight`: volume over area [m]. Returns the greatest speed [m/s]."""
    for s in range(count):
        i, j, k = corners[3 * s], corners[3 * s + 1], corners[3 * s + 2]
        w = weights[s]
        on_sheet = w[0] * place[i] + w[1] * place[j] + w[2] * place[k] - origin
        across = (place[j] - place[i]).cross(place[k] - place[i])
        double_area = across.norm()
        normal = across / ti.max(double_area, 1e-30)
        if share[s] < 0.0:
            normal = -normal
        volume = 0.5 * weight * ti.abs(share[s]) * double_area
        moves = w[0] * speed[i] + w[1] * speed[j] + w[2] * speed[k]
        here[s] = vec4(ti.cast(on_sheet - depth * normal, real), ti.cast(volume, real))
        facing[s] = vec4(ti.cast(normal, real), ti.cast(normal.dot(on_sheet), real))
        samples[s] = here[s]
        velocity[s] = vec4(ti.cast(moves, real), 0.0)
    fastest = ti.cast(0.0, ti.f64)
    for i in range(points):
        ti.atomic_max(fastest, speed[i].norm())
    return fastest


@ti.kernel
def face(count: ti.i32, facing: Vec4Array, position: Vec4Array, size: IntArray, index: IntTable):
    """Take from lists the particles that samples are not for."""
    for s in range(count):
        left = 0
        for k in range(size[s]):
            i = index[s, k]
            if beyond(facing[s], position[i]):
                index[s, left] = i
                left += 1
        size[s] = left


@ti.kernel
def push_back(
    count: ti.i32,
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    near_size: IntArray,
    near_index: IntTable,
    samples: Vec4Array,
    sample_velocity: Vec4Array,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    has_pressure: ti.template(),
    has_grip: ti.template(),
    sample_viscosity: real,
    nearest_sample: real,
    has_damping: ti.template(),
    damping_strength: real,
    has_adhesion: ti.template(),
    adhesion_strength: real,
    force: Vectors,
):
    """Forces on samples that positions and velocities give [N]: the opposite of what they do to the particles near
    them, by `sim.fluid.forces.momentum` and `sim.fluid.forces.adhesion`."""
    for s in range(count):
        inverse_h = 1.0 / h
        slope_strength = slope_norm(inverse_h)
        softening = SOFTENING * h * h
        total = vec3d(0.0, 0.0, 0.0)
        b, moves = samples[s], sample_velocity[s].xyz
        for k in range(near_size[s]):
            i = near_index[s, k]
            x, v = position[i], velocity[i]
            d = x.xyz - b.xyz
            r2 = d.dot(d)
            strength = rest_density * slope_strength * b[VOLUME]
            gradient = strength * cubic_slope(ti.sqrt(r2) * inverse_h) * d
            a = vec3(0.0)
            if ti.static(has_pressure):
                a -= along_faces(i, x[Q] * gradient, begin, solids_near, face, held, fit, inverse_h)
            if ti.static(has_damping):
                a += artificial((v.xyz - moves).dot(d), damping_strength) / (v[DENSITY] * (r2 + softening)) * gradient
            if ti.static(has_grip):
                grip = sample_viscosity * sample_friction(d, v.xyz - moves, nearest_sample, inverse_h)
                a += strength / v[DENSITY] * grip
            if ti.static(has_adhesion):
                r = ti.max(ti.sqrt(r2), 1e-6 * h)
                a -= adhesion_strength * b[VOLUME] * adhesion(r * inverse_h) / r * d
            total -= ti.cast(mass * a, ti.f64)
        force[s] = total


@ti.kernel
def press(
    count: ti.i32,
    ahead: real,
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    pressure: Vec4Array,
    found: ti.template(),
    near_size: IntArray,
    near_index: IntTable,
    samples: Vec4Array,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    force: Vectors,
):
    """Forces of pressures on samples [N], which are in w, or where they are `found` already in x."""
    for s in range(count):
        inverse_h = 1.0 / h
        strength = rest_density * slope_norm(inverse_h)
        total = vec3d(0.0, 0.0, 0.0)
        b = samples[s]
        for k in range(near_size[s]):
            i = near_index[s, k]
            x = position[i].xyz + ahead * velocity[i].xyz
            d = x - b.xyz
            gradient = strength * b[VOLUME] * cubic_slope(d.norm() * inverse_h) * d
            gradient = along_faces(i, gradient, begin, solids_near, face, held, fit, inverse_h)
            q = pressure[i].x if ti.static(found) else pressure[i][Q]
            total += ti.cast(mass * q * gradient, ti.f64)
        force[s] = total


@ti.kernel
def spread(
    points: ti.i32, first_sample: Integers, of_sample: Integers, weights: Vectors, force: Vectors, load: Vectors
):
    """Forces on corners from those on samples [N]."""
    for i in range(points):
        total = vec3d(0.0, 0.0, 0.0)
        for entry in range(first_sample[i], first_sample[i + 1]):
            s, corner = of_sample[entry] // 3, of_sample[entry] % 3
            total += weights[s][corner] * force[s]
        load[i] = total


@ti.kernel
def sway(
    count: ti.i32, per_displacement: ti.f64, corners: Integers, weights: Vectors, displacement: Vectors, out: Vectors
):
    """Accelerations of samples [m/s^2] from the displacements of corners [m]."""
    for s in range(count):
        w = weights[s]
        total = (
            w[0] * displacement[corners[3 * s]]
            + w[1] * displacement[corners[3 * s + 1]]
            + w[2] * displacement[corners[3 * s + 2]]
        )
        out[s] = per_displacement * total


@ti.kernel
def add_response(
    count: ti.i32,
    fresh: ti.i32,
    ahead: real,
    h: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    sway: Vectors,
    pressure_acceleration: Vec4Array,
):
    """In pressure_acceleration.w, by how much accelerations of samples lower the second derivative of densities
    [kg/(m^3 s^2)]."""
    inverse_h = 1.0 / h
    strength = rest_density * slope_norm(inverse_h)
    for i in range(count):
        x = position[i].xyz + ahead * velocity[i].xyz
        given = ti.cast(0.0, real)
        for k in range(sample_size[i]):
            s = sample_index[i, k]
            d = x - samples[s].xyz
            gradient = strength * samples[s][VOLUME] * cubic_slope(d.norm() * inverse_h) * d
            gradient = along_faces(i, gradient, begin, solids_near, face, held, fit, inverse_h)
            given += gradient.dot(ti.cast(sway[s], real))
        pressure_acceleration[i].w = given if fresh != 0 else pressure_acceleration[i].w + given
