"""The sums of `sim.coupling.fluid_rigid.reaction` on the device, in a fixed order, on all threads."""

from typing import Any

import taichi as ti

from sim.device.arrays import DoubleTable, IntArray, IntTable, RealArray, Vec4Array, real, vec3, vec4, vector
from sim.fluid.boundary.half_space import along_face, face_damping
from sim.fluid.boundary.look import surface_velocity
from sim.fluid.forces.adhesion import face_adhesion
from sim.fluid.forces.friction import face_friction
from sim.fluid.forces.pairwise import pair_pressures
from sim.fluid.kernel import slope_norm
from sim.fluid.packed import DENSITY, DISTANCE, Q
from sim.fluid.sums import span

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""

PARTS = 64
"""Entries of a body are summed over in so many ranges, and then over these."""
RANGES = 64
"""Entries are sorted by body in so many ranges of particles side by side."""

vec6d: Any = ti.types.vector(6, ti.f64)


@ti.func
def wrench_of(arm: vec3, force: vec3) -> vec6d:
    """Of a `force` [N] at `arm` [m] from the centre of mass: the force, then its torque [N m]."""
    torque = arm.cross(force)
    return vec6d([force.x, force.y, force.z, torque.x, torque.y, torque.z])


@ti.func
def keep(table: DoubleTable, row: ti.i32, first: ti.template(), total: vec6d):
    """Write a wrench to six columns of a row, from column `first` on."""
    for column in ti.static(range(6)):
        table[row, first + column] = total[column]


@ti.func
def gather(table: DoubleTable, body: ti.i32) -> vec6d:
    """Sum of the PARTS of a body."""
    total = vec6d(0.0)
    for row in range(PARTS * body, PARTS * (body + 1)):
        for column in ti.static(range(6)):
            total[column] += table[row, column]
    return total


@ti.func
def part_of(k: ti.i32, ends: IntArray) -> ti.types.vector(2, ti.i32):
    """Begin and end in the order of one of PARTS ranges of the entries of a body."""
    body = k // PARTS
    return ends[body] + span(k - PARTS * body, PARTS, ends[body + 1] - ends[body])


@ti.kernel
def tally(
    count: ti.i32,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    body_of: IntArray,
    tally: IntArray,
    ends: IntArray,
) -> ti.i32:
    """Write where the entries of each body will end, and in each range of particles begin; returns how many there
    are."""
    bodies = ends.shape[0] - 1
    for r in range(RANGES):
        for b in range(bodies):
            tally[b * RANGES + r] = 0
        within = span(r, RANGES, count)
        for i in range(within[0], within[1]):
            for e in range(begin[i], begin[i] + size[i]):
                b = body_of[solid[e]]
                if b >= 0:
                    tally[b * RANGES + r] += 1
    ti.loop_config(serialize=True)
    for _ in range(1):
        total = 0
        for b in range(bodies):
            ends[b] = total
            for r in range(RANGES):
                here = tally[b * RANGES + r]
                tally[b * RANGES + r] = total
                total += here
        ends[bodies] = total
    return ends[bodies]


@ti.kernel
def sort(
    count: ti.i32,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    body_of: IntArray,
    tally: IntArray,
    ends: IntArray,
    order: IntArray,
):
    """Write the entries to `order` by body, each range from where `tally` has it begin; moves these to where they
    end."""
    for r in range(RANGES):
        within = span(r, RANGES, count)
        for i in range(within[0], within[1]):
            for e in range(begin[i], begin[i] + size[i]):
                b = body_of[solid[e]]
                if b >= 0:
                    order[tally[b * RANGES + r]] = e
                    tally[b * RANGES + r] += 1


@ti.kernel
def push_back(
    ends: IntArray,
    order: IntArray,
    h: real,
    spacing: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    particle: IntArray,
    solid: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    pull: Vec4Array,
    fit: vec4,
    pose: DoubleTable,
    inertia: DoubleTable,
    has_pressure: ti.template(),
    has_grip: ti.template(),
    viscosity: real,
    has_damping: ti.template(),
    damping_strength: real,
    has_adhesion: ti.template(),
    adhesion_strength: real,
    partial: DoubleTable,
    wrench: DoubleTable,
):
    """The opposite of what the bodies do to particles by positions and velocities: `sim.fluid.forces.momentum` and
    `sim.fluid.forces.adhesion`."""
    inverse_h = 1.0 / h
    for k in range(partial.shape[0]):
        total = vec6d(0.0)
        centre = vector(inertia, k // PARTS, 0)
        within = part_of(k, ends)
        for entry in range(within[0], within[1]):
            e = order[entry]
            i = particle[e]
            x, v, one = position[i], velocity[i], face[e]
            relative = v.xyz - surface_velocity(solid[e], x.xyz, pose)
            heavy = face_weight[e] * rest_density / v[DENSITY]
            a = vec3(0.0)
            if ti.static(has_pressure):
                a -= x[Q] * rest_density * pull[e].xyz
            if ti.static(has_damping):
                a += (
                    heavy
                    * face_damping(one[DISTANCE], one.xyz.dot(relative), fit, inverse_h, damping_strength)
                    * one.xyz
                )
            if ti.static(has_grip):
                a += heavy * viscosity * face_friction(one, relative, spacing, inverse_h)
            if ti.static(has_adhesion):
                a -= face_weight[e] * face_adhesion(one[DISTANCE], adhesion_strength, h) * one.xyz
            total += wrench_of(x.xyz - centre, -mass * a)
        keep(partial, k, 0, total)
    for body in range(wrench.shape[0]):
        keep(wrench, body, 0, gather(partial, body))


@ti.kernel
def hold(
    ends: IntArray,
    order: IntArray,
    h: real,
    mass: real,
    position: Vec4Array,
    corrected: ti.template(),
    correction: Vec4Array,
    skew: Vec4Array,
    size: IntArray,
    index: IntTable,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    particle: IntArray,
    inertia: DoubleTable,
    partial: DoubleTable,
    wrench: DoubleTable,
):
    """The opposite of (B - 1) a, for the accelerations a by the pressures of pairs: those by what solids add are in
    their pulls, with B. Of several half-spaces each has what its own factors of B change, which is along it."""
    inverse_h = 1.0 / h
    strength = mass * slope_norm(inverse_h)
    for k in range(partial.shape[0]):
        total = vec6d(0.0)
        centre = vector(inertia, k // PARTS, 0)
        within = part_of(k, ends)
        for entry in range(within[0], within[1]):
            e = order[entry]
            i = particle[e]
            if held[e] > 0.0 and face[e][DISTANCE] < h:
                pushed = strength * pair_pressures(i, position, corrected, correction, skew, size, index, inverse_h)
                more = vec3(0.0)
                count = solids_near[i]
                for n in range(2 * count):
                    one = begin[i] + ti.min(n, 2 * count - 1 - n)
                    change = along_face(one, pushed, face, held, fit, inverse_h) - pushed
                    pushed += change
                    if one == e:
                        more += change
                total += wrench_of(position[i].xyz - centre, -mass * more)
        keep(partial, k, 0, total)
    for body in range(wrench.shape[0]):
        keep(wrench, body, 0, gather(partial, body))


@ti.kernel
def answer_pressure(
    ends: IntArray,
    order: IntArray,
    ahead: real,
    strength: real,
    position: Vec4Array,
    velocity: Vec4Array,
    pressure: Vec4Array,
    found: ti.template(),
    particle: IntArray,
    pull: Vec4Array,
    inertia: DoubleTable,
    by_film: DoubleTable,
    partial: DoubleTable,
    wrench: DoubleTable,
    response: DoubleTable,
):
    """Wrenches of pressures, which are in w, or where they are `found` already in x, and the bodies' answers; strength:
    mass of a particle times the rest density."""
    for k in range(partial.shape[0]):
        total = vec6d(0.0)
        centre = vector(inertia, k // PARTS, 0)
        within = part_of(k, ends)
        for entry in range(within[0], within[1]):
            e = order[entry]
            i = particle[e]
            x = position[i].xyz + ahead * velocity[i].xyz
            q = pressure[i].x if ti.static(found) else pressure[i][Q]
            total += wrench_of(x - centre, strength * q * pull[e].xyz)
        keep(partial, k, 0, total)
    for body in range(wrench.shape[0]):
        total = gather(partial, body)
        for axis in ti.static(range(6)):
            total[axis] += by_film[body, axis]
        keep(wrench, body, 0, total)
        for row in ti.static(range(3)):
            response[body, row] = inertia[body, 3] * total[row]
            turning = ti.cast(0.0, ti.f64)
            for column in ti.static(range(3)):
                turning += inertia[body, 4 + 3 * row + column] * total[3 + column]
            response[body, 3 + row] = turning


@ti.kernel
def add_response(
    count: ti.i32,
    ahead: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    begin: IntArray,
    size: IntArray,
    solid: IntArray,
    pull: Vec4Array,
    body_of: IntArray,
    inertia: DoubleTable,
    response: DoubleTable,
    pressure_acceleration: Vec4Array,
):
    """In pressure_acceleration.w, by how much accelerations of bodies lower the second derivative of densities [kg/(m^3
    s^2)]."""
    for i in range(count):
        given = ti.cast(0.0, real)
        for e in range(begin[i], begin[i] + size[i]):
            body = body_of[solid[e]]
            if body >= 0:
                arm = position[i].xyz + ahead * velocity[i].xyz - vector(inertia, body, 0)
                given += pull[e].xyz.dot(vector(response, body, 0) + vector(response, body, 3).cross(arm))
        pressure_acceleration[i].w = rest_density * given


@ti.kernel
def subtract_predicted(count: ti.i32, dt: real, pressure_acceleration: Vec4Array, source: RealArray):
    """Take compression as it would be, had bodies not answered already."""
    for i in range(count):
        source[i] += dt * dt * pressure_acceleration[i].w
