"""Contacts of all pairs in one table, with what is known of them from the step before."""

import taichi as ti

from sim.device.double import Integers, Numbers, Vectors, vec3
from sim.rigid.collision.manifold import CLOSED, MOST, Found
from sim.rigid.dynamics.contact_solver import Contacts, Motion, relative_velocity
from sim.rigid.dynamics.rotation import beyond, rotation_of

NEAR = 0.3
"""A contact goes on from the nearest of its pair in the step before, within this share of the smaller body."""


@ti.kernel
def gather(
    pairs: ti.i32,
    pair: Integers,
    number: Integers,
    first: Integers,
    material: Numbers,
    size: Numbers,
    found: Found,
    known: Integers,
    known_place: Vectors,
    known_force: Vectors,
    dt: ti.f64,
    motion: Motion,
    contacts: Contacts,
    gap: Numbers,
    restitution: Numbers,
):
    """Bring the contacts of pair k, `number[k]` of them, to `first[k]` and after.

    material: friction, friction at rest and restitution of each pair; size [m] of its smaller body; known: where its
    contacts of the step before begin and end, of which there are the place in the first body's axes and the force [N].
    """
    for k in range(pairs):
        a, b = pair[2 * k], pair[2 * k + 1]
        back = rotation_of(motion.rotation[a]).transpose()
        middle = vec3(0.0)
        for j in range(number[k]):
            middle += found.at[k * MOST + j] / number[k]
        for j in range(number[k]):
            source, c = k * MOST + j, first[k] + j
            contacts.body[2 * c], contacts.body[2 * c + 1] = a, b
            here, n = found.at[source], found.out[source]
            contacts.place[c], contacts.normal[c] = here, n
            gap[c] = found.apart[source]
            contacts.limit[c] = -dt * found.bend[source]
            if gap[c] > CLOSED * size[k]:
                contacts.limit[c] -= (gap[c] - 0.5 * CLOSED * size[k]) / dt
            contacts.carried[c] = _carried(motion, a, b, middle, n, dt)
            contacts.friction[c] = material[3 * k]
            contacts.grip[c] = material[3 * k + 1]
            restitution[c] = material[3 * k + 2]
            local = back @ (here - motion.position[a])
            nearest, force = NEAR * size[k], vec3(0.0)
            for old in range(known[2 * k], known[2 * k + 1]):
                away = (known_place[old] - local).norm()
                if away < nearest:
                    nearest, force = away, known_force[old]
            contacts.push[c] = dt * ti.max(force.dot(n), 0.0)
            contacts.drag[c] = dt * (force - n * force.dot(n))


@ti.func
def _carried(motion: ti.template(), a: ti.i32, b: ti.i32, middle: vec3, n: vec3, dt: ti.f64) -> vec3:
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
    known_place: Vectors,
    known_force: Vectors,
):
    """Places in the first bodies' axes [m] and forces [N] of all contacts, for the next step; a blow does not last."""
    for c in range(count):
        a = contacts.body[2 * c]
        back = rotation_of(motion.rotation[a]).transpose()
        known_place[c] = back @ (contacts.place[c] - motion.position[a])
        if struck[c] < 2:
            known_force[c] = (contacts.push[c] * contacts.normal[c] + contacts.drag[c]) / dt


@ti.kernel
def separate(
    count: ti.i32,
    dt: ti.f64,
    slack: Numbers,
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
        if now < -slack[c]:
            apart[c] = ti.min(share * (-now - slack[c]) / dt, fastest)
            deep += 1
    return deep
