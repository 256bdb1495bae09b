"""The sums of `sim.coupling.fluid_rigid.viscous_drag` on the device."""

from sim.coupling.fluid_rigid.reaction_sums import PARTS, BodySums, gather, keep, part_of, wrench_of
from sim.device.arrays import DoubleTable, Vec4Array, real, vec3, vector
from sim.device.compiler import ti
from sim.fluid.boundary.half_spaces.pose import surface_velocity
from sim.fluid.forces.body_unknowns import (
    CENTRE,
    CHANGE,
    IMAGE,
    INERTIA,
    MASS,
    RESIDUAL,
    SEARCH,
    search_velocity,
    solved,
)
from sim.fluid.forces.friction import face_friction
from sim.fluid.layout import DENSITY, Walls

AS_THEY_MOVE, SEARCHES, ALONE = range(3)


@ti.kernel
def drag(
    which: ti.template(),
    with_mass: ti.template(),
    inverse_h: real,
    strength: real,
    position: Vec4Array,
    velocity: Vec4Array,
    search: Vec4Array,
    walls: Walls,
    entries: BodySums,
    bodies: DoubleTable,
):
    """As image the mass times the search of bodies, and what the friction of pairs adds: where all move as they do,
    along the searches of all, or along those of the bodies alone; densities are in search.w. strength: rest density
    times viscosity and step."""
    for k in range(entries.partial.shape[0]):
        total = wrench_of(vec3(0.0), vec3(0.0))
        body = k // PARTS
        centre = vector(bodies, body, CENTRE)
        within = part_of(k, entries.ends)
        for entry in range(within[0], within[1]):
            e = entries.order[entry]
            i = walls.particle[e]
            x = position[i].xyz
            moved = vec3(0.0)
            if ti.static(which == AS_THEY_MOVE):
                moved = velocity[i].xyz - surface_velocity(walls.solid[e], x, walls.pose)
            else:
                moved = -search_velocity(bodies, body, x)
            if ti.static(which == SEARCHES):
                moved += search[i].xyz
            friction = face_friction(walls.face[e], moved, walls.spacing, inverse_h)
            pull = strength * walls.weight[e] / search[i][DENSITY] * friction
            total += wrench_of(x - centre, pull)
        keep(entries.partial, k, 0, total)
    for b in range(bodies.shape[0]):
        image = gather(entries.partial, b)
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
