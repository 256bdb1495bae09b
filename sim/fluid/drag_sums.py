"""The sums of `sim.fluid.drag` on the device."""

import taichi as ti

from sim.arrays import DoubleTable, IntArray, IntTable, Vec4Array, real, vec3, vec4
from sim.fluid.friction import sample_friction
from sim.fluid.reaction_sums import gather, keep, vector, wrench_of

RESIDUAL, SEARCH, IMAGE, CHANGE, INVERSE, CENTRE, MASS, INERTIA, COLUMNS = 0, 6, 12, 18, 24, 60, 63, 64, 73
"""Where the numbers of a body begin in its row: vectors of a velocity and an angular velocity, the preconditioner by
rows, centre of mass [m], mass and inertia [m^2] by rows over the mass of a particle."""


@ti.kernel
def spread(body_of: IntArray, samples: Vec4Array, bodies: DoubleTable, sample_search: Vec4Array):
    """The search of bodies where their samples are."""
    for s in range(body_of.shape[0]):
        b = body_of[s]
        if b >= 0:
            arm = samples[s].xyz - vector(bodies, b, CENTRE)
            sample_search[s] = vec4(vector(bodies, b, SEARCH) + vector(bodies, b, SEARCH + 3).cross(arm), 0.0)


@ti.kernel
def drag(
    ends: IntArray,
    chunks: IntTable,
    h: real,
    rest_density: real,
    sample_viscosity: real,
    nearest_sample: real,
    position: Vec4Array,
    density: Vec4Array,
    field: Vec4Array,
    alone: ti.template(),
    near_size: IntArray,
    near_index: IntTable,
    first: ti.i32,
    samples: Vec4Array,
    sample_field: Vec4Array,
    with_mass: ti.template(),
    bodies: DoubleTable,
    partial: DoubleTable,
):
    """As image the mass times the search of bodies, and what the friction of pairs adds where particles move by `field`
    and samples by `sample_field`; densities are in w."""
    inverse_h = 1.0 / h
    norm = 8.0 / ti.math.pi * inverse_h**5 * rest_density * sample_viscosity
    for c in range(chunks.shape[0]):
        total = wrench_of(vec3(0.0), vec3(0.0))
        centre = vector(bodies, chunks[c, 2], CENTRE)
        for s in range(chunks[c, 0], chunks[c, 1]):
            b = samples[s]
            for k in range(near_size[s - first]):
                i = near_index[s - first, k]
                x = position[i].xyz
                moved = -sample_field[s].xyz
                if ti.static(not alone):
                    moved += field[i].xyz
                pull = norm * b.w / density[i].w * sample_friction(x - b.xyz, moved, nearest_sample, inverse_h)
                total += wrench_of(x - centre, pull)
        keep(partial, c, 0, total)
    for b in range(bodies.shape[0]):
        image = gather(partial, ends[b], ends[b + 1])
        if ti.static(with_mass):
            for row in ti.static(range(3)):
                image[row] += bodies[b, MASS] * bodies[b, SEARCH + row]
                for column in ti.static(range(3)):
                    image[3 + row] += bodies[b, INERTIA + 3 * row + column] * bodies[b, SEARCH + 3 + column]
        keep(bodies, b, IMAGE, image)


@ti.kernel
def begin(bodies: DoubleTable, sums: DoubleTable, total: ti.i32):
    """Residual and direction of bodies that have not changed yet, whose friction is in the image; adds to the sums."""
    ti.loop_config(serialize=True)
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            bodies[b, CHANGE + k] = 0.0
            bodies[b, RESIDUAL + k] = -bodies[b, IMAGE + k]
        for k in ti.static(range(6)):
            bodies[b, SEARCH + k] = solved(bodies, b, k)
            sums[total, 0] += bodies[b, RESIDUAL + k] * bodies[b, SEARCH + k]
            sums[total, 2] += bodies[b, RESIDUAL + k] * bodies[b, SEARCH + k]


@ti.func
def solved(bodies: DoubleTable, b: ti.i32, row: ti.template()) -> ti.f64:
    """A component of the preconditioned residual."""
    value = ti.cast(0.0, ti.f64)
    for column in ti.static(range(6)):
        value += bodies[b, INVERSE + 6 * row + column] * bodies[b, RESIDUAL + column]
    return value


@ti.func
def bend_of(bodies: DoubleTable) -> ti.f64:
    """Search times image."""
    value = ti.cast(0.0, ti.f64)
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            value += bodies[b, SEARCH + k] * bodies[b, IMAGE + k]
    return value


@ti.func
def go(bodies: DoubleTable, length: ti.f64) -> ti.f64:
    """Go on by `length` along the search; returns the residual times the preconditioned one."""
    value = ti.cast(0.0, ti.f64)
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            bodies[b, CHANGE + k] += length * bodies[b, SEARCH + k]
            bodies[b, RESIDUAL + k] -= length * bodies[b, IMAGE + k]
        for k in ti.static(range(6)):
            value += bodies[b, RESIDUAL + k] * solved(bodies, b, k)
    return value


@ti.func
def turn(bodies: DoubleTable, turning: ti.f64):
    """Turn the search to the preconditioned residual."""
    for b in range(bodies.shape[0]):
        for k in ti.static(range(6)):
            bodies[b, SEARCH + k] = solved(bodies, b, k) + turning * bodies[b, SEARCH + k]
