"""The sums of `sim.coupling.fluid_cloth.sheet_samples` on the device."""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors
from sim.device.double import vec3 as vec3d
from sim.fluid.boundary.half_space import along_faces
from sim.fluid.boundary.one_sided_samples import beyond
from sim.fluid.forces.adhesion import adhesion
from sim.fluid.forces.terms import ADHESION, PRESSURE, Coefficients, slowed_by_sample
from sim.fluid.kernel import cubic_slope, slope_norm
from sim.fluid.layout import DENSITY, VOLUME, Q, Resolution, Samples, Walls
from sim.neighbors.spatial_hash import Neighbors

Sheets: Any = argpack(corners=Integers, weights=Vectors, share=Numbers, here=Vec4Array, facing=Vec4Array)
"""Of samples of sheets: the corners of their triangle and their barycentric weights, their share of its area, negative
on its back; place and volume; unit normal towards the fluid that it is for, and offset of the sheet along it [m]."""


@ti.kernel
def move(
    count: ti.i32,
    points: ti.i32,
    depth: ti.f64,
    weight: ti.f64,
    origin: vec3d,
    sheets: Sheets,
    place: Vectors,
    speed: Vectors,
    samples: Vec4Array,
    velocity: Vec4Array,
) -> ti.f64:
    """Bring samples to where the corners are; `weight`: volume over area [m]. Returns the greatest speed [m/s]."""
    for s in range(count):
        i, j, k = sheets.corners[3 * s], sheets.corners[3 * s + 1], sheets.corners[3 * s + 2]
        w = sheets.weights[s]
        on_sheet = w[0] * place[i] + w[1] * place[j] + w[2] * place[k] - origin
        across = (place[j] - place[i]).cross(place[k] - place[i])
        double_area = across.norm()
        normal = across / ti.max(double_area, 1e-30)
        if sheets.share[s] < 0.0:
            normal = -normal
        volume = 0.5 * weight * ti.abs(sheets.share[s]) * double_area
        moves = w[0] * speed[i] + w[1] * speed[j] + w[2] * speed[k]
        sheets.here[s] = vec4(ti.cast(on_sheet - depth * normal, real), ti.cast(volume, real))
        sheets.facing[s] = vec4(ti.cast(normal, real), ti.cast(normal.dot(on_sheet), real))
        samples[s] = sheets.here[s]
        velocity[s] = vec4(ti.cast(moves, real), 0.0)
    fastest = ti.cast(0.0, ti.f64)
    for i in range(points):
        ti.atomic_max(fastest, speed[i].norm())
    return fastest


@ti.kernel
def face(count: ti.i32, facing: Vec4Array, position: Vec4Array, near: Neighbors):
    """Take from lists the particles that samples are not for."""
    for s in range(count):
        left = 0
        for k in range(near.size[s]):
            i = near.index[near.begin[s] + k]
            if beyond(facing[s], position[i]):
                near.index[near.begin[s] + left] = i
                left += 1
        near.size[s] = left


@ti.kernel
def push_back(
    terms: ti.template(),
    count: ti.i32,
    adhesion_strength: real,
    coefficients: Coefficients,
    fluid: Resolution,
    position: Vec4Array,
    velocity: Vec4Array,
    near: Neighbors,
    samples: Samples,
    walls: Walls,
    force: Vectors,
):
    """Forces on samples that positions and velocities give [N]: the opposite of what they do to the particles near
    them, by `sim.fluid.forces.momentum` and `sim.fluid.forces.adhesion`."""
    for s in range(count):
        inverse_h = 1.0 / fluid.h
        slope_strength = slope_norm(inverse_h)
        total = vec3d(0.0, 0.0, 0.0)
        b, moves = samples.sample[s], samples.velocity[s].xyz
        for k in range(near.size[s]):
            i = near.index[near.begin[s] + k]
            x, v = position[i], velocity[i]
            d = x.xyz - b.xyz
            strength = fluid.rest_density * slope_strength * b[VOLUME]
            a = vec3(0.0)
            if ti.static(terms & PRESSURE):
                gradient = strength * cubic_slope(d.norm() * inverse_h) * d
                a -= along_faces(i, x[Q] * gradient, walls, inverse_h)
            a = slowed_by_sample(a, d, v.xyz - moves, v[DENSITY], strength, terms, coefficients, fluid, inverse_h)
            if ti.static(terms & ADHESION):
                r = ti.max(d.norm(), 1e-6 * fluid.h)
                a -= adhesion_strength * b[VOLUME] * adhesion(r * inverse_h) / r * d
            total -= ti.cast(fluid.mass * a, ti.f64)
        force[s] = total


@ti.kernel
def press(
    count: ti.i32,
    ahead: real,
    fluid: Resolution,
    position: Vec4Array,
    velocity: Vec4Array,
    pressure: Vec4Array,
    found: ti.template(),
    near: Neighbors,
    samples: Samples,
    walls: Walls,
    force: Vectors,
):
    """Forces of pressures on samples [N], which are in w, or where they are `found` already in x."""
    for s in range(count):
        inverse_h = 1.0 / fluid.h
        total = vec3d(0.0, 0.0, 0.0)
        for k in range(near.size[s]):
            i = near.index[near.begin[s] + k]
            x = position[i].xyz + ahead * velocity[i].xyz
            gradient = _sample_gradient(s, i, x, fluid, samples, walls, inverse_h)
            q = pressure[i][Q]
            if ti.static(found):
                q = pressure[i].x
            total += ti.cast(fluid.mass * q * gradient, ti.f64)
        force[s] = total


@ti.func
def _sample_gradient(
    s: ti.i32,
    i: ti.i32,
    x: vec3,
    fluid: ti.template(),
    samples: ti.template(),
    walls: ti.template(),
    inverse_h: real,
) -> vec3:
    """What sample s adds to the gradient of the density of particle i at x, as pressure feels it [kg/m^4]."""
    strength = fluid.rest_density * slope_norm(inverse_h)
    d = x - samples.sample[s].xyz
    gradient = strength * samples.sample[s][VOLUME] * cubic_slope(d.norm() * inverse_h) * d
    return along_faces(i, gradient, walls, inverse_h)


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
    fluid: Resolution,
    position: Vec4Array,
    velocity: Vec4Array,
    samples: Samples,
    walls: Walls,
    sway: Vectors,
    pressure_acceleration: Vec4Array,
):
    """In pressure_acceleration.w, by how much accelerations of samples lower the second derivative of densities
    [kg/(m^3 s^2)]."""
    inverse_h = 1.0 / fluid.h
    for i in range(count):
        x = position[i].xyz + ahead * velocity[i].xyz
        given = ti.cast(0.0, real)
        for k in range(samples.size[i]):
            s = samples.index[samples.begin[i] + k]
            gradient = _sample_gradient(s, i, x, fluid, samples, walls, inverse_h)
            given += gradient.dot(ti.cast(sway[s], real))
        pressure_acceleration[i].w = given if fresh != 0 else pressure_acceleration[i].w + given
