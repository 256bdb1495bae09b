"""The sums of `sim.coupling.fluid_rigid.reaction` on the device, in a fixed order, on all threads."""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import DoubleTable, IntArray, RealArray, Vec4Array, real, vec3, vector
from sim.device.compiler import ti
from sim.fluid.boundary.half_space import along_face
from sim.fluid.boundary.half_spaces.pose import surface_velocity
from sim.fluid.forces.adhesion import face_adhesion
from sim.fluid.forces.pairwise import Lens, pair_pressures
from sim.fluid.forces.terms import ADHESION, PRESSURE, Coefficients, slowed_by_face
from sim.fluid.kernel import slope_norm
from sim.fluid.layout import DENSITY, DISTANCE, Q, Resolution, Walls
from sim.fluid.sums import span
from sim.neighbors.spatial_hash import Neighbors

MATERIALS = ("fluid",)
"""Of a scene, for this to be loaded."""

PARTS = 64
"""Entries of a body are summed over in so many ranges, and then over these."""
RANGES = 64
"""Entries are sorted by body in so many ranges of particles side by side."""

vec6d: Any = ti.types.vector(6, ti.f64)

BodySums: Any = argpack(
    body_of=IntArray,
    ends=IntArray,
    order=IntArray,
    inertia=DoubleTable,
    partial=DoubleTable,
    by_lubrication=DoubleTable,
    wrench=DoubleTable,
    response=DoubleTable,
)
"""The body of each solid, or -1; the entries of `Walls` in the `order` of bodies, those of body b from ends[b] to
ends[b + 1]; centre and inverse inertia of each body (`reaction.INERTIA`); sums over PARTS of its entries, wrenches of
films and of all [N, N m], and the accelerations by these [m/s^2, rad/s^2]."""


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
def tally(count: ti.i32, walls: Walls, bodies: BodySums, tally: IntArray) -> ti.i32:
    """Write where the entries of each body will end, and in each range of particles begin; returns how many there
    are."""
    number = bodies.ends.shape[0] - 1
    for r in range(RANGES):
        for b in range(number):
            tally[b * RANGES + r] = 0
        within = span(r, RANGES, count)
        for i in range(within[0], within[1]):
            for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                b = bodies.body_of[walls.solid[e]]
                if b >= 0:
                    tally[b * RANGES + r] += 1
    ti.loop_config(serialize=True)
    for _ in range(1):
        total = 0
        for b in range(number):
            bodies.ends[b] = total
            for r in range(RANGES):
                here = tally[b * RANGES + r]
                tally[b * RANGES + r] = total
                total += here
        bodies.ends[number] = total
    return bodies.ends[number]


@ti.kernel
def sort(count: ti.i32, walls: Walls, bodies: BodySums, tally: IntArray):
    """Write the entries to `order` by body, each range from where `tally` has it begin; moves these to where they
    end."""
    for r in range(RANGES):
        within = span(r, RANGES, count)
        for i in range(within[0], within[1]):
            for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                b = bodies.body_of[walls.solid[e]]
                if b >= 0:
                    bodies.order[tally[b * RANGES + r]] = e
                    tally[b * RANGES + r] += 1


@ti.kernel
def push_back(
    terms: ti.template(),
    viscosity: real,
    adhesion_strength: real,
    coefficients: Coefficients,
    fluid: Resolution,
    position: Vec4Array,
    velocity: Vec4Array,
    walls: Walls,
    bodies: BodySums,
):
    """The opposite of what the bodies do to particles by positions and velocities: `sim.fluid.forces.momentum` and
    `sim.fluid.forces.adhesion`."""
    inverse_h = 1.0 / fluid.h
    for k in range(bodies.partial.shape[0]):
        total = vec6d(0.0)
        centre = vector(bodies.inertia, k // PARTS, 0)
        within = part_of(k, bodies.ends)
        for entry in range(within[0], within[1]):
            e = bodies.order[entry]
            i = walls.particle[e]
            x, v, one = position[i], velocity[i], walls.face[e]
            relative = v.xyz - surface_velocity(walls.solid[e], x.xyz, walls.pose)
            a = vec3(0.0)
            if ti.static(terms & PRESSURE):
                a -= x[Q] * fluid.rest_density * walls.pull[e].xyz
            a = slowed_by_face(a, e, relative, v[DENSITY], terms, viscosity, coefficients, fluid, walls, inverse_h)
            if ti.static(terms & ADHESION):
                a -= walls.weight[e] * face_adhesion(one[DISTANCE], adhesion_strength, fluid.h) * one.xyz
            total += wrench_of(x.xyz - centre, -fluid.mass * a)
        keep(bodies.partial, k, 0, total)
    for body in range(bodies.wrench.shape[0]):
        keep(bodies.wrench, body, 0, gather(bodies.partial, body))


@ti.kernel
def hold(
    corrected: ti.template(),
    fluid: Resolution,
    position: Vec4Array,
    lens: Lens,
    near: Neighbors,
    walls: Walls,
    bodies: BodySums,
):
    """The opposite of (B - 1) a, for the accelerations a by the pressures of pairs: those by what solids add are in
    their pulls, with B. Of several half-spaces each has what its own factors of B change, which is along it."""
    inverse_h = 1.0 / fluid.h
    strength = fluid.mass * slope_norm(inverse_h)
    for k in range(bodies.partial.shape[0]):
        total = vec6d(0.0)
        centre = vector(bodies.inertia, k // PARTS, 0)
        within = part_of(k, bodies.ends)
        for entry in range(within[0], within[1]):
            e = bodies.order[entry]
            i = walls.particle[e]
            if walls.held[e] > 0.0 and walls.face[e][DISTANCE] < fluid.h:
                pushed = strength * pair_pressures(i, position, corrected, lens, near, inverse_h)
                more = vec3(0.0)
                count = walls.size[i]
                for n in range(2 * count):
                    one = walls.begin[i] + ti.min(n, 2 * count - 1 - n)
                    change = along_face(one, pushed, walls, inverse_h) - pushed
                    pushed += change
                    if one == e:
                        more += change
                total += wrench_of(position[i].xyz - centre, -fluid.mass * more)
        keep(bodies.partial, k, 0, total)
    for body in range(bodies.wrench.shape[0]):
        keep(bodies.wrench, body, 0, gather(bodies.partial, body))


@ti.kernel
def respond(
    ahead: real,
    strength: real,
    position: Vec4Array,
    velocity: Vec4Array,
    pressure: Vec4Array,
    found: ti.template(),
    walls: Walls,
    bodies: BodySums,
):
    """Wrenches of pressures, which are in w, or where they are `found` already in x, and the responses of bodies;
    strength: mass of a particle times the rest density."""
    for k in range(bodies.partial.shape[0]):
        total = vec6d(0.0)
        centre = vector(bodies.inertia, k // PARTS, 0)
        within = part_of(k, bodies.ends)
        for entry in range(within[0], within[1]):
            e = bodies.order[entry]
            i = walls.particle[e]
            x = position[i].xyz + ahead * velocity[i].xyz
            q = pressure[i][Q]
            if ti.static(found):
                q = pressure[i].x
            total += wrench_of(x - centre, strength * q * walls.pull[e].xyz)
        keep(bodies.partial, k, 0, total)
    for body in range(bodies.wrench.shape[0]):
        total = gather(bodies.partial, body)
        for axis in ti.static(range(6)):
            total[axis] += bodies.by_lubrication[body, axis]
        keep(bodies.wrench, body, 0, total)
        for row in ti.static(range(3)):
            bodies.response[body, row] = bodies.inertia[body, 3] * total[row]
            turning = ti.cast(0.0, ti.f64)
            for column in ti.static(range(3)):
                turning += bodies.inertia[body, 4 + 3 * row + column] * total[3 + column]
            bodies.response[body, 3 + row] = turning


@ti.kernel
def add_response(
    count: ti.i32,
    ahead: real,
    rest_density: real,
    position: Vec4Array,
    velocity: Vec4Array,
    walls: Walls,
    bodies: BodySums,
    pressure_acceleration: Vec4Array,
):
    """In pressure_acceleration.w, by how much accelerations of bodies lower the second derivative of densities [kg/(m^3
    s^2)]."""
    for i in range(count):
        given = ti.cast(0.0, real)
        for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
            body = bodies.body_of[walls.solid[e]]
            if body >= 0:
                arm = position[i].xyz + ahead * velocity[i].xyz - vector(bodies.inertia, body, 0)
                turning = vector(bodies.response, body, 3)
                given += walls.pull[e].xyz.dot(vector(bodies.response, body, 0) + turning.cross(arm))
        pressure_acceleration[i].w = rest_density * given


@ti.kernel
def subtract_predicted(count: ti.i32, dt: real, pressure_acceleration: Vec4Array, source: RealArray):
    """Take compression as it would be, had bodies not responded already."""
    for i in range(count):
        source[i] += dt * dt * pressure_acceleration[i].w
