"""Implicit viscosity (Weiler et al. 2018): for fluids so thick that explicit steps would be tiny.

The velocities after the step dt are those that the friction of the step itself slows:
    v - dt K v = v*,    K v the sum over pairs of `sim.fluid.forces.pairwise.viscous` and the friction of
    `sim.fluid.forces.friction`
(backward Euler). K is symmetric and negative semidefinite. Conjugate gradients solve the system, with the
inverses of its diagonal's 3 x 3 blocks as preconditioner, from the velocities to which the
friction of the step before leads. What is left of the residual r at the end is added: v* + dt K v = v + r,
which is made of pair forces alone, so that momentum and angular momentum are kept whatever the tolerance.
"""

import math

import numpy as np
import taichi as ti

from sim.device.arrays import (
    Declared,
    DoubleTable,
    IntArray,
    IntTable,
    RealArray,
    Vec4Array,
    numpy_real,
    real,
    vec3,
    vec4,
)
from sim.fluid.boundary.look import surface_velocity
from sim.fluid.forces.body_unknowns import COLUMNS, advance, redirect, search_curvature, search_velocity
from sim.fluid.forces.friction import (
    face_friction,
    face_friction_block,
    find_grip,
)
from sim.fluid.forces.pairwise import SOFTENING, viscous
from sim.fluid.kernel import cubic_norm, cubic_slope, slope_norm
from sim.fluid.packed import DENSITY
from sim.fluid.sums import BLOCKS, span
from sim.fluid.system import FluidSystem, ViscousDrag
from sim.neighbors.spatial_hash import padded

ROUNDING = 4 * float(np.finfo(numpy_real).eps)
"""Residuals below this share of the velocities are rounding."""
WHOLE, PUSH, DESCEND = range(3)
CHECK = 4
"""The residual is read back after every so many iterations."""

ARRAYS = (
    Declared("slowing", "vec4", "acceleration by viscosity in the last step [m/s^2]", saved=False),
    Declared("viscous_search", "vec4", "direction of the search [m/s]; w: density [kg/m^3]", sorted=False, saved=False),
    Declared("residual", "vec4", "v* - (1 - dt K) v [m/s]", sorted=False, saved=False),
    Declared("image", "vec4", "(1 - dt K) times the direction of the search [m/s]", sorted=False, saved=False),
    Declared("inverse", "vec4", "diagonal of the inverse of a block of 1 - dt K; w: its xy", sorted=False, saved=False),
    Declared("inverse_off", "vec4", "its xz and yz", sorted=False, saved=False),
)


class Viscosity:
    """Slows the particles of a system, whose arrays are those declared in ARRAYS; `slowing` is sorted with them, and
    forgotten where a run may go on from a checkpoint."""

    def __init__(self, system: FluidSystem):
        self.system = system
        self.settings = system.spec.implicit_viscosity
        self.grip = find_grip(system.spec)
        self._sums = ti.ndarray(ti.f64, (BLOCKS + 1, 5))
        self._nowhere, self._nobody = ti.ndarray(ti.i32, 1), ti.ndarray(ti.f64, (1, COLUMNS))
        self._dragged: ViscousDrag | None = None

    def _drag(self) -> ViscousDrag | None:
        """The part of bodies that obey forces, if there are any that the fluid sticks to."""
        if self._dragged is None and self.system.bodies and self.grip.walls > 0:
            self._dragged = self.system.bodies.viscous_drag()
        return self._dragged

    def apply(self, dt: float) -> dict[str, float]:
        """Replace the velocities by those after `dt` of friction; returns the statistics."""
        system, particles = self.system, self.system.particles
        viscosity = dt * system.spec.viscosity
        drag = self._drag()
        self._begin(dt, viscosity)
        if drag:
            drag.begin(viscosity, self._sums)
        iterations, solved = 0, self._is_solved()
        while not solved and iterations < self.settings.max_iterations:
            for _ in range(min(CHECK, self.settings.max_iterations - iterations)):
                if drag:
                    self._iterate(PUSH, viscosity)
                    drag.pull()
                    self._iterate(DESCEND, viscosity)
                else:
                    self._iterate(WHOLE, viscosity)
                iterations += 1
            solved = self._is_solved()
        _finish(system.count, 1.0 / dt, solved, particles.velocity, particles.slowing, particles.residual)
        if drag and system.bodies:
            system.bodies.apply_viscosity(dt, drag.finish(solved=solved))
        return {"viscosity_iterations": iterations, "capped": not solved}

    def _is_solved(self) -> bool:
        """Whether the residual is small next to what viscosity changes, or no more than rounding."""
        left, change, whole = (math.sqrt(max(value, 0.0)) for value in _told(self._sums))
        return left <= max(self.settings.error * change, ROUNDING * whole)

    def _begin(self, dt: float, viscosity: float) -> None:
        system = self.system
        particles, boundary = system.particles, system.boundary
        _begin(
            system.count,
            0.0 if system.forgetful else dt,
            system.h,
            system.spec.spacing,
            system.mass,
            system.spec.rest_density,
            viscosity,
            self.grip.walls > 0,
            particles.position,
            particles.velocity,
            particles.slowing,
            particles.viscous_search,
            particles.residual,
            particles.inverse,
            particles.inverse_off,
            system.neighbors.size,
            system.neighbors.index,
            *boundary.faces.lists,
            boundary.faces.solid,
            boundary.shapes.pose,
            self._sums,
        )
        system.forgetful = False

    def _iterate(self, part: int, viscosity: float) -> None:
        system, drag = self.system, self._dragged
        particles, boundary = system.particles, system.boundary
        _iterate(
            part,
            system.count,
            system.h,
            system.spec.spacing,
            system.mass,
            system.spec.rest_density,
            viscosity,
            self.grip.walls > 0,
            particles.position,
            particles.velocity,
            particles.slowing,
            particles.viscous_search,
            particles.residual,
            particles.image,
            particles.inverse,
            particles.inverse_off,
            system.neighbors.size,
            system.neighbors.index,
            *boundary.faces.lists,
            boundary.faces.solid,
            drag.body_of if drag else self._nowhere,
            self._sums,
            drag.table if drag else self._nobody,
        )


@ti.func
def _solve(inverse: vec4, off: vec4, r: vec3) -> vec3:
    """The block's inverse times r."""
    return vec3(
        inverse.x * r.x + inverse.w * r.y + off.x * r.z,
        inverse.w * r.x + inverse.y * r.y + off.y * r.z,
        off.x * r.x + off.y * r.y + inverse.z * r.z,
    )


@ti.kernel
def _begin(
    count: ti.i32,
    remembered: real,
    h: real,
    spacing: real,
    mass: real,
    rest_density: real,
    viscosity: real,
    has_grip: ti.template(),
    position: Vec4Array,
    velocity: Vec4Array,
    slowing: Vec4Array,
    search: Vec4Array,
    residual: Vec4Array,
    inverse: Vec4Array,
    inverse_off: Vec4Array,
    size: IntArray,
    index: IntTable,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    solid: IntArray,
    pose: DoubleTable,
    sums: DoubleTable,
):
    """First guess as velocity, v* in slowing, preconditioner, residual and direction.

    remembered: the step [s] over which the last slowing is taken as guess, or zero. viscosity: times the
    step [m^2]. The sums are r.z, a factor of the iteration, and the squares of r, of v - v* and of v*.
    """
    inverse_h = 1.0 / h
    norm = cubic_norm(inverse_h)
    slope_strength = norm * inverse_h * inverse_h
    softening = SOFTENING * h * h
    for i in range(count):
        guess = velocity[i].xyz
        if remembered > 0.0:
            guess += remembered * slowing[i].xyz
        search[i] = vec4(guess, velocity[i][DENSITY])
    for i in range(count):
        x, v = position[i].xyz, search[i]
        block = ti.Matrix.identity(real, 3)
        pull = vec3(0.0)
        for k in range(padded(size[i])):
            vj = search[index[i, k]]
            d = x - position[index[i, k]].xyz
            r2 = d.dot(d)
            strength = mass * slope_strength * viscous(2.0, viscosity) / (v[DENSITY] + vj[DENSITY])
            strength *= cubic_slope(ti.sqrt(r2) * inverse_h) / (r2 + softening)
            block -= strength * d.outer_product(d)
            pull += strength * (v.xyz - vj.xyz).dot(d) * d
        if ti.static(has_grip):
            heavy = rest_density / v[DENSITY]
            for e in range(begin[i], begin[i] + solids_near[i]):
                one = face_weight[e] * heavy * viscosity * face_friction_block(face[e], spacing, inverse_h)
                block -= one
                pull += one @ (v.xyz - surface_velocity(solid[e], x, pose))
        mended = block.inverse()
        inverse[i] = vec4(mended[0, 0], mended[1, 1], mended[2, 2], mended[0, 1])
        inverse_off[i] = vec4(mended[0, 2], mended[1, 2], 0.0, 0.0)
        residual[i].xyz = velocity[i].xyz - v.xyz + pull
    for part in range(BLOCKS):
        across, left = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        change, whole = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        within = span(part, BLOCKS, count)
        for i in range(within[0], within[1]):
            before, guess, r = velocity[i].xyz, search[i].xyz, residual[i].xyz
            z = _solve(inverse[i], inverse_off[i], r)
            across += r.dot(z)
            left += r.dot(r)
            change += (guess - before).dot(guess - before)
            whole += before.dot(before)
            slowing[i].xyz = before
            velocity[i].xyz = guess
            search[i].xyz = z
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
def _iterate(
    part: ti.template(),
    count: ti.i32,
    h: real,
    spacing: real,
    mass: real,
    rest_density: real,
    viscosity: real,
    has_grip: ti.template(),
    position: Vec4Array,
    velocity: Vec4Array,
    slowing: Vec4Array,
    search: Vec4Array,
    residual: Vec4Array,
    image: Vec4Array,
    inverse: Vec4Array,
    inverse_off: Vec4Array,
    size: IntArray,
    index: IntTable,
    begin: IntArray,
    solids_near: IntArray,
    face: Vec4Array,
    face_weight: RealArray,
    held: RealArray,
    fit: vec4,
    solid: IntArray,
    body_of: IntArray,
    sums: DoubleTable,
    bodies: DoubleTable,
):
    """One step of conjugate gradients; where the residual vanishes it does nothing.

    Where bodies have a part in it, those before and after the images of their searches are two calls.
    """
    inverse_h = 1.0 / h
    slope_strength = slope_norm(inverse_h)
    softening = SOFTENING * h * h
    if ti.static(part != DESCEND):
        for i in range(count):
            x, p = position[i].xyz, search[i]
            pull = vec3(0.0)
            for k in range(padded(size[i])):
                j = index[i, k]
                pj = search[j]
                d = x - position[j].xyz
                r2 = d.dot(d)
                strength = viscous(2.0 * (p.xyz - pj.xyz).dot(d), viscosity) / (p[DENSITY] + pj[DENSITY])
                pull += strength * cubic_slope(ti.sqrt(r2) * inverse_h) / (r2 + softening) * d
            pull *= mass * slope_strength
            if ti.static(has_grip):
                heavy = rest_density / p[DENSITY]
                for e in range(begin[i], begin[i] + solids_near[i]):
                    moved = p.xyz
                    if ti.static(part == PUSH):
                        body = body_of[solid[e]]
                        if body >= 0:
                            moved -= search_velocity(bodies, body, x)
                    pull += face_weight[e] * heavy * viscosity * face_friction(face[e], moved, spacing, inverse_h)
            image[i].xyz = p.xyz - pull
        for block in range(BLOCKS):
            bend = ti.cast(0.0, ti.f64)
            within = span(block, BLOCKS, count)
            for i in range(within[0], within[1]):
                bend += search[i].xyz.dot(image[i].xyz)
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
                v = velocity[i].xyz + length * search[i].xyz
                r = residual[i].xyz - length * image[i].xyz
                velocity[i].xyz = v
                residual[i].xyz = r
                across += r.dot(_solve(inverse[i], inverse_off[i], r))
                left += r.dot(r)
                change += (v - slowing[i].xyz).dot(v - slowing[i].xyz)
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
            turned = ti.cast(sums[BLOCKS, 1], real) * search[i].xyz
            search[i].xyz = _solve(inverse[i], inverse_off[i], residual[i].xyz) + turned


@ti.kernel
def _told(sums: DoubleTable) -> ti.types.vector(3, ti.f64):
    """Squares of the residual, of what viscosity changes, and of the velocities before."""
    return ti.Vector([sums[BLOCKS, 2], sums[BLOCKS, 3], sums[BLOCKS, 4]])


@ti.kernel
def _finish(
    count: ti.i32, per_step: real, solved: ti.i32, velocity: Vec4Array, slowing: Vec4Array, residual: Vec4Array
):
    """Add the residual, where it is small, and keep what viscosity has changed."""
    for i in range(count):
        v = velocity[i].xyz
        if solved != 0:
            v += residual[i].xyz
        velocity[i].xyz = v
        slowing[i].xyz = per_step * (v - slowing[i].xyz)
