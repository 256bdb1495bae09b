"""The sums of `sim.coupling.fluid_rigid.lubrication` on the device."""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import DoubleTable, IntArray, IntTable, Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.gaps import facing, openness
from sim.fluid.kernel import cubic, cubic_norm
from sim.fluid.layout import Q, Resolution, Walls
from sim.neighbors.spatial_hash import Neighbors

WET, FULL = 0.25, 0.5
"""Shares of the density, before a surface, from which on it counts as wet, and as covered with particles."""
CLOSED, ENTERED = 1.8, 2.0
"""Spacings between two solids up to which what no particles cover is a film, and from which it is a void. Particles
come into a gap once it is a spacing wide, and not at once: as a void, it stopped what came up from the ground."""

Elements: Any = argpack(
    arms=Vec4Array,
    areas=Vec4Array,
    body=IntArray,
    own=IntArray,
    ends=IntArray,
    beside=IntTable,
    motions=DoubleTable,
    here=Vec4Array,
    ahead=Vec4Array,
    beyond=Vec4Array,
    normals=Vec4Array,
    found=Vec4Array,
    forces=Vec4Array,
    by_rim=DoubleTable,
)
"""Elements of surfaces: places [m] and areas [m^2] on the body as placed, the body, the solid that it is, the first of
each body, and those beside each; how bodies have moved; where elements are now, the first and second layer of particles
before them, and areas; what is `found` there (`press`), forces [N], and the wrench over the pressure at a rim."""


@ti.kernel
def place(elements: Elements, spacing: real):
    """Where elements are, the first and second layer of particles before them, and their areas as vectors outward."""
    for e in range(elements.arms.shape[0]):
        b = elements.body[e]
        arm, area = ti.cast(elements.arms[e].xyz, ti.f64), ti.cast(elements.areas[e].xyz, ti.f64)
        at, outward = ti.Vector([0.0] * 3, dt=ti.f64), ti.Vector([0.0] * 3, dt=ti.f64)
        for row in ti.static(range(3)):
            for column in ti.static(range(3)):
                at[row] += elements.motions[b, 3 * row + column] * arm[column]
                outward[row] += elements.motions[b, 3 * row + column] * area[column]
        at += ti.Vector([elements.motions[b, 9 + axis] for axis in range(3)])
        size = outward.norm()
        elements.here[e] = vec4(ti.cast(at, real), ti.cast(size, real))
        elements.ahead[e] = vec4(ti.cast(at + 0.5 * spacing / size * outward, real), 0.0)
        elements.beyond[e] = vec4(ti.cast(at + 1.5 * spacing / size * outward, real), 0.0)
        elements.normals[e] = vec4(ti.cast(outward, real), 0.0)


@ti.kernel
def press(
    fluid: Resolution,
    gravity: vec3,
    position: Vec4Array,
    slim: IntArray,
    elements: Elements,
    near: Neighbors,
    far: Neighbors,
    walls: Walls,
    wrench: DoubleTable,
):
    """Wrenches on bodies by films, but for the pressures at their rims, and what those do.

    found: of each element the share of it that a film covers, by how much pressure is less `beyond` than where the
    particles there are [Pa], how wet it is there, and whether it is on the rim of a film. The first layer next to
    solids has not the fluid's pressure: it is what balances the slope of their share of the density. by_rim: the wrench
    over the pressure there [m^2, m^3], for each element of a rim.
    """
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    for e in range(elements.ends[elements.ends.shape[0] - 1]):
        wet, pressure = ti.cast(0.0, real), ti.cast(0.0, real)
        for k in range(far.size[e]):
            i = far.index[far.begin[e] + k]
            d = elements.beyond[e].xyz - position[i].xyz
            one = norm * fluid.mass / fluid.rest_density * cubic(d.norm() * inverse_h)
            wet += one
            pressure += one * fluid.rest_density * gravity.dot(d)
        cover = ti.cast(0.0, real)
        for k in range(near.size[e]):
            i = near.index[near.begin[e] + k]
            d = elements.ahead[e].xyz - position[i].xyz
            cover += norm * fluid.mass / fluid.rest_density * cubic(d.norm() * inverse_h)
        covered = ti.math.clamp((cover - WET) / (FULL - WET), 0.0, 1.0)
        lubrication = ti.cast(0.0, real)
        for k in range(walls.size[e]):
            other = walls.face[walls.begin[e] + k]
            if facing(elements.normals[e].xyz / elements.here[e].w, other.xyz):
                closed = ti.math.clamp((ENTERED - other.w / fluid.spacing) / (ENTERED - CLOSED), 0.0, 1.0)
                open_gap = openness(other.w, fluid.spacing, slim[elements.own[e]])
                lubrication = ti.max(lubrication, closed * (1.0 - covered * open_gap))
        elements.found[e] = vec4(lubrication, pressure / ti.max(wet, WET), wet, 0.0)
    for e in range(elements.beside.shape[0]):
        if elements.found[e].x < 0.5:
            for k in range(elements.beside.shape[1]):
                if elements.found[elements.beside[e, k]].x >= 0.5:
                    elements.found[e].w = 1.0
    for e in range(elements.beside.shape[0]):
        elements.forces[e] = vec4(0.0)
        if elements.found[e].x > 0.0:
            weight, total = ti.cast(0.0, real), ti.cast(0.0, real)
            for r in range(elements.ends[elements.body[e]], elements.ends[elements.body[e] + 1]):
                if elements.found[r].w > 0.0:
                    d = elements.here[e].xyz - elements.beyond[r].xyz
                    share = elements.here[r].w / ti.max(d.dot(d), 1e-6 * fluid.h * fluid.h)
                    weight += share
                    wet = ti.min(elements.found[r].z / WET, 1.0)
                    total += share * (elements.found[r].y + wet * fluid.rest_density * gravity.dot(d))
            if weight > 0.0:
                elements.forces[e] = vec4(
                    -elements.found[e].x * total / weight * elements.normals[e].xyz, elements.found[e].x / weight
                )
    for r in range(elements.beside.shape[0]):
        force, torque = ti.Vector([0.0] * 3, dt=ti.f64), ti.Vector([0.0] * 3, dt=ti.f64)
        if elements.found[r].w > 0.0:
            centre = ti.Vector([elements.motions[elements.body[r], 9 + axis] for axis in range(3)])
            for e in range(elements.ends[elements.body[r]], elements.ends[elements.body[r] + 1]):
                if elements.forces[e].w > 0.0:
                    d = elements.here[e].xyz - elements.beyond[r].xyz
                    share = elements.here[r].w / ti.max(d.dot(d), 1e-6 * fluid.h * fluid.h)
                    one = ti.cast(-elements.forces[e].w * share * elements.normals[e].xyz, ti.f64)
                    force += one
                    torque += (ti.cast(elements.here[e].xyz, ti.f64) - centre).cross(one)
        for axis in ti.static(range(3)):
            elements.by_rim[r, axis] = force[axis]
            elements.by_rim[r, 3 + axis] = torque[axis]
    for b in range(wrench.shape[0]):
        force, torque = ti.Vector([0.0] * 3, dt=ti.f64), ti.Vector([0.0] * 3, dt=ti.f64)
        centre = ti.Vector([elements.motions[b, 9 + axis] for axis in range(3)])
        for e in range(elements.ends[b], elements.ends[b + 1]):
            one = ti.cast(elements.forces[e].xyz, ti.f64)
            force += one
            torque += (ti.cast(elements.here[e].xyz, ti.f64) - centre).cross(one)
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
    fluid: Resolution,
    position: Vec4Array,
    pressure: Vec4Array,
    is_found: ti.template(),
    elements: Elements,
    far: Neighbors,
    at_rim: DoubleTable,
    wrench: DoubleTable,
):
    """Wrenches by the pressures at rims as q, which are in w, or where they are found already in x."""
    for r in range(at_rim.shape[0]):
        total = ti.cast(0.0, ti.f64)
        if elements.found[r].w > 0.0:
            for k in range(far.size[r]):
                i = far.index[far.begin[r] + k]
                q = pressure[i][Q]
                if ti.static(is_found):
                    q = pressure[i].x
                total += share_of(r, i, fluid.h, fluid.mass / fluid.rest_density, position, elements.beyond) * q
            total *= fluid.rest_density * fluid.rest_density / ti.max(elements.found[r].z, WET)
        at_rim[r, 0] = total
    for b in range(wrench.shape[0]):
        for axis in range(6):
            total = ti.cast(0.0, ti.f64)
            for r in range(elements.ends[b], elements.ends[b + 1]):
                total += elements.by_rim[r, axis] * at_rim[r, 0]
            wrench[b, axis] = total


@ti.kernel
def add_response_at_rims(
    fluid: Resolution,
    position: Vec4Array,
    elements: Elements,
    far: Neighbors,
    response: DoubleTable,
    pressure_acceleration: Vec4Array,
):
    """Add to pressure_acceleration.w by how much accelerations of bodies, which widen films, lower the second
    derivative of the densities at their rims [kg/(m^3 s^2)]: the fluid that is to fill them comes from there."""
    ti.loop_config(serialize=True)
    for r in range(elements.by_rim.shape[0]):
        if elements.found[r].w > 0.0:
            widens = ti.cast(0.0, ti.f64)
            for axis in range(6):
                widens += elements.by_rim[r, axis] * response[elements.body[r], axis]
            widens *= fluid.rest_density * fluid.rest_density / (fluid.mass * ti.max(elements.found[r].z, WET))
            for k in range(far.size[r]):
                i = far.index[far.begin[r] + k]
                share = share_of(r, i, fluid.h, fluid.mass / fluid.rest_density, position, elements.beyond)
                pressure_acceleration[i].w += share * ti.cast(widens, real)
