"""What `sim.fluid.forces.implicit_viscosity` does on the device."""

from typing import Any

from sim.device.argument_packs import argpack
from sim.device.arrays import DoubleTable, IntArray, Vec4Array, real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.half_spaces.pose import surface_velocity
from sim.fluid.forces.body_unknowns import advance, redirect, search_curvature, search_velocity
from sim.fluid.forces.friction import face_friction, face_friction_block
from sim.fluid.forces.pairwise import SOFTENING, viscous
from sim.fluid.kernel import cubic_norm, cubic_slope, slope_norm
from sim.fluid.layout import DENSITY, Resolution, Walls
from sim.fluid.sums import BLOCKS, span
from sim.neighbors.spatial_hash import Neighbors, padded

WHOLE, PUSH, DESCEND = range(3)
"""Parts of an iteration: all of it, or what comes before and after bodies respond to the search."""

Unknowns: Any = argpack(
    position=Vec4Array,
    velocity=Vec4Array,
    viscous_acceleration=Vec4Array,
    viscous_search=Vec4Array,
    residual=Vec4Array,
    image=Vec4Array,
    inverse=Vec4Array,
    inverse_off=Vec4Array,
)
"""Particles, and the arrays declared in `implicit_viscosity.ARRAYS`."""


@ti.func
def _solve(inverse: vec4, off: vec4, r: vec3) -> vec3:
    """The block's inverse times r."""
    return vec3(
        inverse.x * r.x + inverse.w * r.y + off.x * r.z,
        inverse.w * r.x + inverse.y * r.y + off.y * r.z,
        off.x * r.x + off.y * r.y + inverse.z * r.z,
    )


@ti.kernel
def begin(
    count: ti.i32,
    remembered: real,
    viscosity: real,
    has_grip: ti.template(),
    fluid: Resolution,
    p: Unknowns,
    near: Neighbors,
    walls: Walls,
    sums: DoubleTable,
):
    """First guess as velocity, v* in viscous_acceleration, preconditioner, residual and direction.

    remembered: the step [s] over which the last viscous acceleration is taken as guess, or zero. viscosity: times the
    step [m^2]. The sums are r.z, a factor of the iteration, and the squares of r, of v - v* and of v*.
    """
    inverse_h = 1.0 / fluid.h
    norm = cubic_norm(inverse_h)
    slope_strength = norm * inverse_h * inverse_h
    softening = SOFTENING * fluid.h * fluid.h
    for i in range(count):
        guess = p.velocity[i].xyz
        if remembered > 0.0:
            guess += remembered * p.viscous_acceleration[i].xyz
        p.viscous_search[i] = vec4(guess, p.velocity[i][DENSITY])
    for i in range(count):
        x, v = p.position[i].xyz, p.viscous_search[i]
        block = ti.Matrix.identity(real, 3)
        pull = vec3(0.0)
        for k in range(padded(near.size[i])):
            vj = p.viscous_search[near.index[near.begin[i] + k]]
            d = x - p.position[near.index[near.begin[i] + k]].xyz
            r2 = d.dot(d)
            strength = fluid.mass * slope_strength * viscous(2.0, viscosity) / (v[DENSITY] + vj[DENSITY])
            strength *= cubic_slope(ti.sqrt(r2) * inverse_h) / (r2 + softening)
            block -= strength * d.outer_product(d)
            pull += strength * (v.xyz - vj.xyz).dot(d) * d
        if ti.static(has_grip):
            heavy = fluid.rest_density / v[DENSITY]
            for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                one = walls.weight[e] * heavy * viscosity * face_friction_block(walls.face[e], fluid.spacing, inverse_h)
                block -= one
                pull += one @ (v.xyz - surface_velocity(walls.solid[e], x, walls.pose))
        mended = block.inverse()
        p.inverse[i] = vec4(mended[0, 0], mended[1, 1], mended[2, 2], mended[0, 1])
        p.inverse_off[i] = vec4(mended[0, 2], mended[1, 2], 0.0, 0.0)
        p.residual[i].xyz = p.velocity[i].xyz - v.xyz + pull
    for part in range(BLOCKS):
        across, left = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        change, whole = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        within = span(part, BLOCKS, count)
        for i in range(within[0], within[1]):
            before, guess, r = p.velocity[i].xyz, p.viscous_search[i].xyz, p.residual[i].xyz
            z = _solve(p.inverse[i], p.inverse_off[i], r)
            across += r.dot(z)
            left += r.dot(r)
            change += (guess - before).dot(guess - before)
            whole += before.dot(before)
            p.viscous_acceleration[i].xyz = before
            p.velocity[i].xyz = guess
            p.viscous_search[i].xyz = z
        sums[part, 0] = across
        sums[part, 2] = left
        sums[part, 3] = change
        sums[part, 4] = whole
    ti.loop_config(serialize=True)
    for column in range(5):
        total = ti.cast(0.0, ti.f64)
        for part in range(BLOCKS):
            total += sums[part, column]
        sums[BLOCKS, column] = total


@ti.kernel
def iterate(
    part: ti.template(),
    count: ti.i32,
    viscosity: real,
    has_grip: ti.template(),
    fluid: Resolution,
    p: Unknowns,
    near: Neighbors,
    walls: Walls,
    body_of: IntArray,
    sums: DoubleTable,
    bodies: DoubleTable,
):
    """One step of conjugate gradients; where the residual vanishes it does nothing.

    Where bodies have a part in it, those before and after the images of their searches are two calls.
    """
    inverse_h = 1.0 / fluid.h
    slope_strength = slope_norm(inverse_h)
    softening = SOFTENING * fluid.h * fluid.h
    if ti.static(part != DESCEND):
        for i in range(count):
            x, s = p.position[i].xyz, p.viscous_search[i]
            pull = vec3(0.0)
            for k in range(padded(near.size[i])):
                j = near.index[near.begin[i] + k]
                sj = p.viscous_search[j]
                d = x - p.position[j].xyz
                r2 = d.dot(d)
                strength = viscous(2.0 * (s.xyz - sj.xyz).dot(d), viscosity) / (s[DENSITY] + sj[DENSITY])
                pull += strength * cubic_slope(ti.sqrt(r2) * inverse_h) / (r2 + softening) * d
            pull *= fluid.mass * slope_strength
            if ti.static(has_grip):
                heavy = fluid.rest_density / s[DENSITY]
                for e in range(walls.begin[i], walls.begin[i] + walls.size[i]):
                    moved = s.xyz
                    if ti.static(part == PUSH):
                        body = body_of[walls.solid[e]]
                        if body >= 0:
                            moved -= search_velocity(bodies, body, x)
                    friction = face_friction(walls.face[e], moved, fluid.spacing, inverse_h)
                    pull += walls.weight[e] * heavy * viscosity * friction
            p.image[i].xyz = s.xyz - pull
        for block in range(BLOCKS):
            bend = ti.cast(0.0, ti.f64)
            within = span(block, BLOCKS, count)
            for i in range(within[0], within[1]):
                bend += p.viscous_search[i].xyz.dot(p.image[i].xyz)
            sums[block, 1] = bend
    if ti.static(part != PUSH):
        ti.loop_config(serialize=True)
        for _ in range(1):
            bend = ti.cast(0.0, ti.f64)
            for block in range(BLOCKS):
                bend += sums[block, 1]
            if ti.static(part == DESCEND):
                bend += search_curvature(bodies)
            sums[BLOCKS, 1] = ti.select(bend > 0.0, sums[BLOCKS, 0] / bend, 0.0)
        for block in range(BLOCKS):
            length = ti.cast(sums[BLOCKS, 1], real)
            across, left, change = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
            within = span(block, BLOCKS, count)
            for i in range(within[0], within[1]):
                v = p.velocity[i].xyz + length * p.viscous_search[i].xyz
                r = p.residual[i].xyz - length * p.image[i].xyz
                p.velocity[i].xyz = v
                p.residual[i].xyz = r
                across += r.dot(_solve(p.inverse[i], p.inverse_off[i], r))
                left += r.dot(r)
                change += (v - p.viscous_acceleration[i].xyz).dot(v - p.viscous_acceleration[i].xyz)
            sums[block, 0] = across
            sums[block, 2] = left
            sums[block, 3] = change
        ti.loop_config(serialize=True)
        for _ in range(1):
            across, left, change = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
            for block in range(BLOCKS):
                across += sums[block, 0]
                left += sums[block, 2]
                change += sums[block, 3]
            if ti.static(part == DESCEND):
                more = advance(bodies, sums[BLOCKS, 1])
                across += more
                left += more
            sums[BLOCKS, 1] = ti.select(sums[BLOCKS, 0] > 0.0, across / sums[BLOCKS, 0], 0.0)
            if ti.static(part == DESCEND):
                redirect(bodies, sums[BLOCKS, 1])
            sums[BLOCKS, 0] = across
            sums[BLOCKS, 2] = left
            sums[BLOCKS, 3] = change
        for i in range(count):
            turned = ti.cast(sums[BLOCKS, 1], real) * p.viscous_search[i].xyz
            p.viscous_search[i].xyz = _solve(p.inverse[i], p.inverse_off[i], p.residual[i].xyz) + turned


@ti.kernel
def norms(sums: DoubleTable) -> ti.types.vector(3, ti.f64):
    """Squares of the residual, of what viscosity changes, and of the velocities before."""
    return ti.Vector([sums[BLOCKS, 2], sums[BLOCKS, 3], sums[BLOCKS, 4]])


@ti.kernel
def finish(count: ti.i32, per_step: real, solved: ti.i32, p: Unknowns):
    """Add the residual, where it is small, and keep what viscosity has changed."""
    for i in range(count):
        v = p.velocity[i].xyz
        if solved != 0:
            v += p.residual[i].xyz
        p.velocity[i].xyz = v
        p.viscous_acceleration[i].xyz = per_step * (v - p.viscous_acceleration[i].xyz)
