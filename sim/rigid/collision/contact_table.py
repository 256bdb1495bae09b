"""Contacts of all pairs in one table, with the forces of the step before."""

from sim.device.compiler import ti
from sim.device.double import Integers, Numbers, Vectors, vec3
from sim.rigid.collision.manifold import CLOSED, MOST, Found
from sim.rigid.dynamics.contact_solver import relative_velocity
from sim.rigid.dynamics.rotation import beyond, rotation_of
from sim.rigid.layout import Bounces, Contacts, Motion, Pairs, PreviousContacts

NEAR = 0.3
"""A contact goes on from the nearest of its pair in the step before, within this share of the smaller body."""


@ti.kernel
def gather(
    pairs: ti.i32,
    before: ti.i32,
    dt: ti.f64,
    allowed: ti.f64,
    near: Pairs,
    found: Found,
    previous: PreviousContacts,
    motion: Motion,
    contacts: Contacts,
    gap: Numbers,
    allowed_overlap: Numbers,
    bounces: Bounces,
) -> ti.i32:
    """Bring the contacts of pair k, `number[k]` of them, to `first[k]` and after, with the impulses of those `before`,
    in the last step, that they go on from; returns how many there are.

    allowed: overlap that is left alone, as a share of the smaller body.
    """
    total = 0
    ti.loop_config(serialize=True)
    for _ in range(1):
        old = 0
        for k in range(pairs):
            a, b = near.pair_body[2 * k], near.pair_body[2 * k + 1]
            near.first[k] = total
            total += near.number[k]
            while old < before and _comes_first(previous, old, a, b):
                old += 1
            previous.first_previous[2 * k] = old
            while old < before and previous.previous_body[2 * old] == a and previous.previous_body[2 * old + 1] == b:
                old += 1
            previous.first_previous[2 * k + 1] = old
    for k in range(pairs):
        a, b = near.pair_body[2 * k], near.pair_body[2 * k + 1]
        back = rotation_of(motion.rotation[a]).transpose()
        middle = vec3(0.0)
        for j in range(near.number[k]):
            middle += found.at[k * MOST + j] / near.number[k]
        for j in range(near.number[k]):
            source, c = k * MOST + j, near.first[k] + j
            contacts.body[2 * c], contacts.body[2 * c + 1] = a, b
            here, n = found.at[source], found.out[source]
            contacts.place[c], contacts.normal[c] = here, n
            gap[c] = found.apart[source]
            allowed_overlap[c] = allowed * near.scale[k]
            contacts.limit[c] = -dt * found.bend[source]
            if gap[c] > CLOSED * near.scale[k]:
                contacts.limit[c] -= (gap[c] - 0.5 * CLOSED * near.scale[k]) / dt
            contacts.arc_velocity[c] = _arc_velocity(motion, a, b, middle, n, dt)
            contacts.kinetic_friction[c] = near.surface[3 * k]
            contacts.static_friction[c] = near.surface[3 * k + 1]
            bounces.restitution[c] = near.surface[3 * k + 2]
            local = back @ (here - motion.position[a])
            nearest, last_force = NEAR * near.scale[k], vec3(0.0)
            for old in range(previous.first_previous[2 * k], previous.first_previous[2 * k + 1]):
                away = (previous.previous_place[old] - local).norm()
                if away < nearest:
                    nearest, last_force = away, previous.previous_force[old]
            contacts.normal_impulse[c] = dt * ti.max(last_force.dot(n), 0.0)
            contacts.friction_impulse[c] = dt * (last_force - n * last_force.dot(n))
    return total


@ti.func
def _comes_first(previous: ti.template(), old: ti.i32, a: ti.i32, b: ti.i32) -> ti.i32:
    """Whether the pair of a contact of the step before is listed before that of a and b."""
    one, other = previous.previous_body[2 * old], previous.previous_body[2 * old + 1]
    return one < a or (one == a and other < b)


@ti.func
def _arc_velocity(motion: ti.template(), a: ti.i32, b: ti.i32, middle: vec3, n: vec3, dt: ti.f64) -> vec3:
    """What the turning of both bodies adds to the relative velocity of their material in the middle of where they
    touch, over dt [s]: it goes along arcs, and not along the tangents that velocities at the start say [m/s].

    Bodies turn there about the normal, each by itself, and together across it: by the lesser of the two, since the rest
    is rolling, which has other material touch. All contacts of a pair have the value of the middle: each with its own,
    they would ask for what no motion of the bodies does, if one turns on the other until friction stops it.
    """
    spin_a, spin_b = motion.spin[a], motion.spin[b]
    along_a, along_b = n.dot(spin_a) * n, n.dot(spin_b) * n
    across_a, across_b = spin_a - along_a, spin_b - along_b
    common = across_b
    if across_a.norm_sqr() < across_b.norm_sqr():
        common = across_a
    arc_a = beyond(dt * (along_a + common), middle - motion.position[a])
    arc_b = beyond(dt * (along_b + common), middle - motion.position[b])
    return (arc_a - arc_b) / dt


@ti.kernel
def remember(
    count: ti.i32,
    dt: ti.f64,
    struck: Integers,
    motion: Motion,
    contacts: Contacts,
    place_out: Vectors,
    force_out: Vectors,
):
    """Places in the first bodies' axes [m] and forces [N] of all contacts, for the next step; a blow does not last."""
    for c in range(count):
        a = contacts.body[2 * c]
        back = rotation_of(motion.rotation[a]).transpose()
        place_out[c] = back @ (contacts.place[c] - motion.position[a])
        if struck[c] < 2:
            force_out[c] = (contacts.normal_impulse[c] * contacts.normal[c] + contacts.friction_impulse[c]) / dt


@ti.kernel
def separate(
    count: ti.i32,
    dt: ti.f64,
    allowed_overlap: Numbers,
    share: ti.f64,
    fastest: ti.f64,
    gap: Numbers,
    motion: Motion,
    contacts: Contacts,
    apart: Numbers,
    thrust: Numbers,
    slip: Vectors,
) -> ti.i32:
    """Ask overlapping bodies to part, no faster than `fastest` [m/s]; returns how many contacts overlap too much.

    The gap is that of the step's begin; what the velocities do to it is counted. Written: the speeds asked for, and
    impulses of zero to begin with.
    """
    deep = 0
    for c in range(count):
        now = gap[c] + dt * contacts.normal[c].dot(relative_velocity(motion, contacts, c))
        thrust[c] = 0.0
        slip[c] = vec3(0.0)
        apart[c] = -ti.max(now, 0.0) / dt
        if now < -allowed_overlap[c]:
            apart[c] = ti.min(share * (-now - allowed_overlap[c]) / dt, fastest)
            deep += 1
    return deep
