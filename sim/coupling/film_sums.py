"""The sums of `sim.coupling.film` on the device."""

import taichi as ti

from sim.arrays import DoubleTable, IntArray, IntTable, Vec4Array, real, vec3, vec4
from sim.fluid.kernel import cubic
from sim.fluid.walls import wall_share

FULL, WET = 0.25, 0.5
"""Shares of the density, half a spacing off a surface, up to which there is none but a film, and from which there are
particles."""
CLOSE, APART = 0.7, 0.3
"""In what a solid adds to the density of the layer next to it: from where another is so near that there is a film, and
under which there is none."""


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
    mass: real,
    rest_density: real,
    lacking: real,
    gravity: vec3,
    position: Vec4Array,
    velocity: Vec4Array,
    body: IntArray,
    number: IntArray,
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
    samples: Vec4Array,
    sample_velocity: Vec4Array,
    has_standing: ti.template(),
    standing_size: IntArray,
    standing_index: IntTable,
    moving_first: ti.i32,
    moving_order: IntArray,
    moving_size: IntArray,
    moving_index: IntTable,
    wall_count: ti.i32,
    wall_fit: vec4,
    planes: Vec4Array,
    found: Vec4Array,
    forces: Vec4Array,
    motions: DoubleTable,
    wrench: DoubleTable,
):
    """Wrenches on bodies by films.

    found: of each element the share of it that a film covers, the pressure of particles `beyond` [Pa], how wet it is
    there, and whether it is on the rim of a film. The first layer next to samples has not the fluid's pressure: it is
    what balances the slope of their share of the density.
    """
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h**3
    for e in range(ends[ends.shape[0] - 1]):
        y = ahead[e].xyz
        cover = ti.cast(0.0, real)
        for k in range(ahead_size[e]):
            i = ahead_index[e, k]
            cover += norm * mass / velocity[i].w * cubic((y - position[i].xyz).norm() * inverse_h)
        wet, pressure = ti.cast(0.0, real), ti.cast(0.0, real)
        for k in range(beyond_size[e]):
            i = beyond_index[e, k]
            d = beyond[e].xyz - position[i].xyz
            one = norm * mass / velocity[i].w * cubic(d.norm() * inverse_h)
            wet += one
            pressure += one * rest_density * (rest_density * position[i].w + gravity.dot(d))
        others = wall_share(y, wall_count, wall_fit, planes, inverse_h).w
        if ti.static(has_standing):
            for k in range(standing_size[e]):
                b = samples[standing_index[e, k]]
                others += norm * b.w * cubic((y - b.xyz).norm() * inverse_h)
        for k in range(moving_size[e]):
            s = moving_first + moving_order[moving_index[e, k]]
            if ti.cast(sample_velocity[s].w, ti.i32) != number[body[e]]:
                others += norm * samples[s].w * cubic((y - samples[s].xyz).norm() * inverse_h)
        closed = ti.math.clamp((others / lacking - APART) / (CLOSE - APART), 0.0, 1.0)
        film = closed * ti.math.clamp((WET - cover) / (WET - FULL), 0.0, 1.0)
        found[e] = vec4(film, ti.max(pressure, 0.0) / ti.max(wet, FULL), ti.min(wet / FULL, 1.0), 0.0)
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
                    total += near * (found[r].y + found[r].z * rest_density * gravity.dot(d))
            if weight > 0.0:
                forces[e] = vec4(-found[e].x * ti.max(total / weight, 0.0) * normals[e].xyz, 0.0)
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
