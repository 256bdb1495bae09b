"""The sums of `sim.fluid.reaction` on the device."""

import taichi as ti

from sim.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4
from sim.fluid.adhesion import adhesion
from sim.fluid.forces import SOFTENING, artificial
from sim.fluid.friction import sample_friction
from sim.fluid.kernel import cubic_slope
from sim.fluid.walls import along_walls

vec6d = ti.types.vector(6, ti.f64)


@ti.func
def vector(table: DoubleTable, row: ti.i32, first: ti.template()) -> vec3:
    return vec3([ti.cast(table[row, first + axis], real) for axis in ti.static(range(3))])


@ti.func
def wrench_of(arm: vec3, force: vec3) -> vec6d:
    torque = arm.cross(force)
    return vec6d([force.x, force.y, force.z, torque.x, torque.y, torque.z])


@ti.func
def keep(table: DoubleTable, row: ti.i32, first: ti.template(), total: vec6d):
    for column in ti.static(range(6)):
        table[row, first + column] = total[column]


@ti.func
def gather(table: DoubleTable, begin: ti.i32, end: ti.i32) -> vec6d:
    total = vec6d(0.0)
    for row in range(begin, end):
        for column in ti.static(range(6)):
            total[column] += table[row, column]
    return total


@ti.func
def force_on_sample(
    s: ti.i32,
    row: ti.i32,
    centre: vec3,
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    near_size: IntArray,
    near_index: IntTable,
    samples: Vec4Array,
    sample_velocity: Vec4Array,
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
    has_pressure: ti.template(),
    has_grip: ti.template(),
    sample_viscosity: real,
    nearest_sample: real,
    has_damping: ti.template(),
    damping_strength: real,
    has_adhesion: ti.template(),
    adhesion_strength: real,
) -> vec6d:
    """The opposite of what a sample does to the particles listed in `row`, as force [N] and torque about `centre`:
    `sim.fluid.momentum` and `sim.fluid.adhesion`."""
    inverse_h = 1.0 / h
    slope_norm = 8.0 / ti.math.pi * inverse_h**5
    softening = SOFTENING * h * h
    total = vec6d(0.0)
    b, moves = samples[s], sample_velocity[s].xyz
    for k in range(near_size[row]):
        i = near_index[row, k]
        x, v = position[i], velocity[i]
        d = x.xyz - b.xyz
        r2 = d.dot(d)
        strength = rest_density * slope_norm * b.w
        gradient = strength * cubic_slope(ti.sqrt(r2) * inverse_h) * d
        a = vec3(0.0)
        if ti.static(has_pressure):
            a -= along_walls(x.xyz, x.w * gradient, wall_count, wall_fit, planes, inverse_h)
        if ti.static(has_damping):
            a += artificial((v.xyz - moves).dot(d), damping_strength) / (v.w * (r2 + softening)) * gradient
        if ti.static(has_grip):
            grip = sample_viscosity * sample_friction(d, v.xyz - moves, nearest_sample, inverse_h)
            a += strength / v.w * grip
        if ti.static(has_adhesion):
            r = ti.max(ti.sqrt(r2), 1e-6 * h)
            a -= adhesion_strength * b.w * adhesion(r * inverse_h) / r * d
        total += wrench_of(x.xyz - centre, -mass * a)
    return total


@ti.func
def pressure_on_sample(
    s: ti.i32,
    row: ti.i32,
    centre: vec3,
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
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
) -> vec6d:
    """Likewise of the pressures, which are in w, or where they are `found` already in x."""
    inverse_h = 1.0 / h
    strength = rest_density * 8.0 / ti.math.pi * inverse_h**5
    total = vec6d(0.0)
    b = samples[s]
    for k in range(near_size[row]):
        i = near_index[row, k]
        x = position[i].xyz + ahead * velocity[i].xyz
        d = x - b.xyz
        gradient = strength * b.w * cubic_slope(d.norm() * inverse_h) * d
        gradient = along_walls(position[i].xyz, gradient, wall_count, wall_fit, planes, inverse_h)
        q = pressure[i].x if ti.static(found) else pressure[i].w
        total += wrench_of(x - centre, mass * q * gradient)
    return total


@ti.kernel
def push_back(
    ends: IntArray,
    chunks: IntTable,
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    near_size: IntArray,
    near_index: IntTable,
    first: ti.i32,
    samples: Vec4Array,
    sample_velocity: Vec4Array,
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
    inertia: DoubleTable,
    has_pressure: ti.template(),
    has_grip: ti.template(),
    sample_viscosity: real,
    nearest_sample: real,
    has_damping: ti.template(),
    damping_strength: real,
    has_adhesion: ti.template(),
    adhesion_strength: real,
    partial: DoubleTable,
    wrench: DoubleTable,
):
    """Forces that positions and velocities give."""
    for c in range(chunks.shape[0]):
        total = vec6d(0.0)
        centre = vector(inertia, chunks[c, 2], 0)
        for s in range(chunks[c, 0], chunks[c, 1]):
            total += force_on_sample(
                s,
                s - first,
                centre,
                h,
                mass,
                rest_density,
                position,
                velocity,
                near_size,
                near_index,
                samples,
                sample_velocity,
                wall_count,
                wall_fit,
                planes,
                has_pressure,
                has_grip,
                sample_viscosity,
                nearest_sample,
                has_damping,
                damping_strength,
                has_adhesion,
                adhesion_strength,
            )
        keep(partial, c, 0, total)
    for body in range(wrench.shape[0]):
        keep(wrench, body, 0, gather(partial, ends[body], ends[body + 1]))


@ti.kernel
def answer_pressure(
    ends: IntArray,
    chunks: IntTable,
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
    first: ti.i32,
    samples: Vec4Array,
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
    inertia: DoubleTable,
    partial: DoubleTable,
    wrench: DoubleTable,
    answer: DoubleTable,
):
    """Wrenches of pressures, which are in w, or where they are `found` already in x, and the bodies' answers."""
    for c in range(chunks.shape[0]):
        total = vec6d(0.0)
        centre = vector(inertia, chunks[c, 2], 0)
        for s in range(chunks[c, 0], chunks[c, 1]):
            total += pressure_on_sample(
                s,
                s - first,
                centre,
                ahead,
                h,
                mass,
                rest_density,
                position,
                velocity,
                pressure,
                found,
                near_size,
                near_index,
                samples,
                wall_count,
                wall_fit,
                planes,
            )
        keep(partial, c, 0, total)
    for body in range(wrench.shape[0]):
        total = gather(partial, ends[body], ends[body + 1])
        keep(wrench, body, 0, total)
        for row in ti.static(range(3)):
            answer[body, row] = inertia[body, 3] * total[row]
            turning = ti.cast(0.0, ti.f64)
            for column in ti.static(range(3)):
                turning += inertia[body, 4 + 3 * row + column] * total[3 + column]
            answer[body, 3 + row] = turning


@ti.kernel
def give_way(
    count: ti.i32,
    ahead: real,
    h: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    samples: Vec4Array,
    sample_size: IntArray,
    sample_index: IntTable,
    body_of: IntArray,
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
    inertia: DoubleTable,
    answer: DoubleTable,
    push: Vec4Array,
):
    """In push.w, by how much accelerations of bodies lower the second derivative of densities [kg/(m^3 s^2)]."""
    inverse_h = 1.0 / h
    strength = rest_density * 8.0 / ti.math.pi * inverse_h**5
    for i in range(count):
        x = position[i].xyz + ahead * velocity[i].xyz
        given = ti.cast(0.0, real)
        for k in range(sample_size[i]):
            s = sample_index[i, k]
            # Samples of sheets lie behind those of bodies.
            body = -1
            if s < body_of.shape[0]:
                body = body_of[s]
            if body >= 0:
                d = x - samples[s].xyz
                gradient = strength * samples[s].w * cubic_slope(d.norm() * inverse_h) * d
                gradient = along_walls(position[i].xyz, gradient, wall_count, wall_fit, planes, inverse_h)
                arm = x - vector(inertia, body, 0)
                given += gradient.dot(vector(answer, body, 0) + vector(answer, body, 3).cross(arm))
        push[i].w = given


@ti.kernel
def expect(count: ti.i32, dt: real, push: Vec4Array, source: RealArray):
    """Take compression as it would be, had bodies not answered already."""
    for i in range(count):
        source[i] += dt * dt * push[i].w
