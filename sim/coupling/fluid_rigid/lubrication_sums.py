"""The sums of `sim.coupling.fluid_rigid.lubrication` on the device."""

import taichi as ti

from sim.device.arrays import DoubleTable, IntArray, IntTable, Vec4Array, real, vec3, vec4
from sim.fluid.boundary.gaps import facing, wide
from sim.fluid.kernel import cubic, cubic_norm
from sim.fluid.packed import Q

WET, FULL = 0.25, 0.5
"""Shares of the density, before a surface, from which on it counts as wet, and as covered with particles."""
CLOSED, ENTERED = 1.8, 2.0
"""Spacings between two solids up to which what no particles cover is a film, and from which it is a void. Particles
come into a gap once it is a spacing wide, and not at once: as a void, it stopped what came up from the ground."""


@ti.kernel
def place(
    arms: Vec4Array,
    areas: Vec4Array,
    body: IntArray,
    motions: DoubleTable,
    spacing: real,
    here: Vec4Array,
    ahead: Vec4Array,
    beyond: Vec4Array,
    normals: Vec4Array,
):
    """Where elements are, the first and second layer of particles before them, and their areas as vectors outward."""
    for e in range(arms.shape[0]):
        b = body[e]
        arm, area = ti.cast(arms[e].xyz, ti.f64), ti.cast(areas[e].xyz, ti.f64)
        at, outward = ti.Vector([0.0] * 3, dt=ti.f64), ti.Vector([0.0] * 3, dt=ti.f64)
        for row in ti.static(range(3)):
            for column in ti.static(range(3)):
                at[row] += motions[b, 3 * row + column] * arm[column]
                outward[row] += motions[b, 3 * row + column] * area[column]
        at += ti.Vector([motions[b, 9 + axis] for axis in range(3)])
        size = outward.norm()
        here[e] = vec4(ti.cast(at, real), ti.cast(size, real))
        ahead[e] = vec4(ti.cast(at + 0.5 * spacing / size * outward, real), 0.0)
        beyond[e] = vec4(ti.cast(at + 1.5 * spacing / size * outward, real), 0.0)
        normals[e] = vec4(ti.cast(outward, real), 0.0)


@ti.kernel
def press(
    h: real,
    spacing: real,
    mass: real,
    rest_density: real,
    gravity: vec3,
    position: Vec4Array,
    own: IntArray,
    slim: IntArray,
    body: IntArray,
    ends: IntArray,
    beside: IntTable,
    here: Vec4Array,
    ahead: Vec4Array,
    beyond: Vec4Array,
    normals: Vec4Array,
    ahead_size: IntArray,
    ahead_index: IntTable,
    beyond_size: IntArray,
    beyond_index: IntTable,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    found: Vec4Array,
    forces: Vec4Array,
    motions: DoubleTable,
    by_rim: DoubleTable,
    wrench: DoubleTable,
):
    """Wrenches on bodies by films, but for the pressures at their rims, and what those do.

    found: of each element the share of it that a film covers, by how much pressure is less `beyond` than where the
    particles there are [Pa], how wet it is there, and whether it is on the rim of a film. The first layer next to
    solids has not the fluid's pressure: it is what balances the slope of their share of the density. by_rim: the wrench
    over the pressure there [m^2, m^3], for each element of a rim.
    """
    inverse_h = 1.0 / h
    norm = cubic_norm(inverse_h)
    for e in range(ends[ends.shape[0] - 1]):
        wet, pressure = ti.cast(0.0, real), ti.cast(0.0, real)
        for k in range(beyond_size[e]):
            i = beyond_index[e, k]
            d = beyond[e].xyz - position[i].xyz
            one = norm * mass / rest_density * cubic(d.norm() * inverse_h)
            wet += one
            pressure += one * rest_density * gravity.dot(d)
        cover = ti.cast(0.0, real)
        for k in range(ahead_size[e]):
            i = ahead_index[e, k]
            cover += norm * mass / rest_density * cubic((ahead[e].xyz - position[i].xyz).norm() * inverse_h)
        covered = ti.math.clamp((cover - WET) / (FULL - WET), 0.0, 1.0)
        lubrication = ti.cast(0.0, real)
        for k in range(solids_near[e]):
            other = face[begin[e] + k]
            if facing(normals[e].xyz / here[e].w, other.xyz):
                closed = ti.math.clamp((ENTERED - other.w / spacing) / (ENTERED - CLOSED), 0.0, 1.0)
                lubrication = ti.max(lubrication, closed * (1.0 - covered * wide(other.w, spacing, slim[own[e]])))
        found[e] = vec4(lubrication, pressure / ti.max(wet, WET), wet, 0.0)
    for e in range(beside.shape[0]):
        if found[e].x < 0.5:
            for k in range(beside.shape[1]):
                if found[beside[e, k]].x >= 0.5:
                    found[e].w = 1.0
    for e in range(beside.shape[0]):
        forces[e] = vec4(0.0)
        if found[e].x > 0.0:
            weight, total = ti.cast(0.0, real), ti.cast(0.0, real)
            for r in range(ends[body[e]], ends[body[e] + 1]):
                if found[r].w > 0.0:
                    d = here[e].xyz - beyond[r].xyz
                    near = here[r].w / ti.max(d.dot(d), 1e-6 * h * h)
                    weight += near
                    total += near * (found[r].y + ti.min(found[r].z / WET, 1.0) * rest_density * gravity.dot(d))
            if weight > 0.0:
                forces[e] = vec4(-found[e].x * total / weight * normals[e].xyz, found[e].x / weight)
    for r in range(beside.shape[0]):
        force, torque = ti.Vector([0.0] * 3, dt=ti.f64), ti.Vector([0.0] * 3, dt=ti.f64)
        if found[r].w > 0.0:
            centre = ti.Vector([motions[body[r], 9 + axis] for axis in range(3)])
            for e in range(ends[body[r]], ends[body[r] + 1]):
                if forces[e].w > 0.0:
                    d = here[e].xyz - beyond[r].xyz
                    near = here[r].w / ti.max(d.dot(d), 1e-6 * h * h)
                    one = ti.cast(-forces[e].w * near * normals[e].xyz, ti.f64)
                    force += one
                    torque += (ti.cast(here[e].xyz, ti.f64) - centre).cross(one)
        for axis in ti.static(range(3)):
            by_rim[r, axis] = force[axis]
            by_rim[r, 3 + axis] = torque[axis]
    for b in range(wrench.shape[0]):
        force, torque = ti.Vector([0.0] * 3, dt=ti.f64), ti.Vector([0.0] * 3, dt=ti.f64)
        centre = ti.Vector([motions[b, 9 + axis] for axis in range(3)])
        for e in range(ends[b], ends[b + 1]):
            one = ti.cast(forces[e].xyz, ti.f64)
            force += one
            torque += (ti.cast(here[e].xyz, ti.f64) - centre).cross(one)
        for axis in ti.static(range(3)):
            wrench[b, axis] = force[axis]
            wrench[b, 3 + axis] = torque[axis]


@ti.func
def share_of(r: ti.i32, i: ti.i32, h: real, volume: real, position: Vec4Array, beyond: Vec4Array) -> real:
    """Of a particle in the pressure before an element of a rim, but for how wet it is there."""
    inverse_h = 1.0 / h
    weight = cubic((beyond[r].xyz - position[i].xyz).norm() * inverse_h)
    return cubic_norm(inverse_h) * volume * weight


@ti.kernel
def press_rims(
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    pressure: Vec4Array,
    is_found: ti.template(),
    ends: IntArray,
    beyond: Vec4Array,
    beyond_size: IntArray,
    beyond_index: IntTable,
    found: Vec4Array,
    by_rim: DoubleTable,
    at_rim: DoubleTable,
    wrench: DoubleTable,
):
    """Wrenches by the pressures at rims as q, which are in w, or where they are found already in x."""
    for r in range(at_rim.shape[0]):
        total = ti.cast(0.0, ti.f64)
        if found[r].w > 0.0:
            for k in range(beyond_size[r]):
                i = beyond_index[r, k]
                q = pressure[i].x if ti.static(is_found) else pressure[i][Q]
                total += share_of(r, i, h, mass / rest_density, position, beyond) * q
            total *= rest_density * rest_density / ti.max(found[r].z, WET)
        at_rim[r, 0] = total
    for b in range(wrench.shape[0]):
        for axis in range(6):
            total = ti.cast(0.0, ti.f64)
            for r in range(ends[b], ends[b + 1]):
                total += by_rim[r, axis] * at_rim[r, 0]
            wrench[b, axis] = total


@ti.kernel
def add_response_at_rims(
    h: real,
    mass: real,
    rest_density: real,
    position: Vec4Array,
    body: IntArray,
    beyond: Vec4Array,
    beyond_size: IntArray,
    beyond_index: IntTable,
    found: Vec4Array,
    by_rim: DoubleTable,
    response: DoubleTable,
    pressure_acceleration: Vec4Array,
):
    """Add to pressure_acceleration.w by how much accelerations of bodies, which widen films, lower the second
    derivative of the densities at their rims [kg/(m^3 s^2)]: the fluid that is to fill them comes from there."""
    ti.loop_config(serialize=True)
    for r in range(by_rim.shape[0]):
        if found[r].w > 0.0:
            widens = ti.cast(0.0, ti.f64)
            for axis in range(6):
                widens += by_rim[r, axis] * response[body[r], axis]
            widens *= rest_density * rest_density / (mass * ti.max(found[r].z, WET))
            for k in range(beyond_size[r]):
                i = beyond_index[r, k]
                pressure_acceleration[i].w += share_of(r, i, h, mass / rest_density, position, beyond) * ti.cast(
                    widens, real
                )
