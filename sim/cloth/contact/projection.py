"""Contacts of small steps: what springs and gravity make of one is changed as little as keeps everything apart.

Points go to the nearest places, in the metric of their masses, at which no contact is below its limit. Forces that take
them there are looked for by Jacobi's method, each projected to a push and to Coulomb's cone; every mass is shared among
its contacts, or that would not converge (Tonge et al. 2012). It begins with the forces of the
small step before.
"""

from sim.cloth.contact.augmented_lagrangian import NOTHING
from sim.cloth.fabric.layout import ACTIVE, KINETIC, LEAST, LIMIT, STATIC
from sim.device.compiler import ti
from sim.device.double import vec3


@ti.func
def mobility(p: ti.template(), i: ti.i32) -> ti.f64:
    """One over the mass [1/kg]; 0 of what is held."""
    found = ti.cast(0.0, ti.f64)
    if p.mobile[i]:
        found = 1.0 / p.mass[i]
    return found


@ti.func
def _separation(
    c: ti.i32, points: ti.i32, share: ti.f64, contacts: ti.template(), place: ti.template(), motion: ti.template()
):
    """Where the first side of a contact is, less that of the other [m], after a `share` of the displacements of
    solids."""
    total = vec3(0.0, 0.0, 0.0)
    for corner in ti.static(range(4)):
        i = contacts.corner[4 * c + corner]
        if i >= points:
            total += contacts.weight[c][corner] * (motion.start[i] + share * (motion.target[i] - motion.start[i]))
        elif i >= 0:
            total += contacts.weight[c][corner] * place[i]
    return total


@ti.func
def find_active(
    c: ti.i32,
    points: ti.i32,
    share: ti.f64,
    more: vec3,
    p: ti.template(),
    contacts: ti.template(),
    motion: ti.template(),
):
    """Say whether a contact presses, or will; bodies take its sides apart by `more` [m]."""
    there = _separation(c, points, share, contacts, p.position, motion) + more
    below = contacts.normal[c].dot(there) < contacts.active_limit[c][LEAST]
    contacts.active_limit[c][ACTIVE] = 1.0 if below or contacts.normal_force[c] > 0.0 else 0.0


@ti.func
def count_active(i: ti.i32, contacts: ti.template(), motion: ti.template()):
    """Count the contacts of a point that take part."""
    number = ti.cast(0.0, ti.f64)
    for entry in range(contacts.first_contact[i], contacts.first_contact[i + 1]):
        number += contacts.active_limit[contacts.of_contact[entry] // 4][ACTIVE]
    motion.active_contacts[i] = number


@ti.func
def warm_start(
    c: ti.i32,
    points: ti.i32,
    share: ti.f64,
    more: vec3,
    recovery: ti.f64,
    contacts: ti.template(),
    motion: ti.template(),
):
    """Begin with the force that there was, and remember where the contact was; `recovery`: share of what its limit
    lacks that is made up for at once."""
    n = contacts.normal[c]
    before = _separation(c, points, share, contacts, motion.before, motion) + more
    limit, was = contacts.law[c][LIMIT], n.dot(before)
    if was < limit:
        limit = was + recovery * (limit - was)
    contacts.before_step[c] = before
    contacts.active_limit[c] = vec3(0.0, limit, 0.0)
    contacts.force_change[c] = contacts.normal_force[c] * n + contacts.friction_force[c]


@ti.func
def project(
    c: ti.i32,
    points: ti.i32,
    dt: ti.f64,
    share: ti.f64,
    more: vec3,
    compliance: ti.f64,
    p: ti.template(),
    contacts: ti.template(),
    motion: ti.template(),
):
    """Change the force of a contact that takes part; bodies take its sides apart by `more` [m], and add `compliance`
    [1/kg]."""
    contacts.force_change[c] = vec3(0.0, 0.0, 0.0)
    soft = compliance
    for corner in ti.static(range(4)):
        i = contacts.corner[4 * c + corner]
        if 0 <= i < points:
            soft += contacts.weight[c][corner] ** 2 * motion.active_contacts[i] * mobility(p, i)
    if contacts.active_limit[c][ACTIVE] > 0.0 and soft > 0.0:
        n, before, k = contacts.normal[c], contacts.before_step[c], 1.0 / (soft * dt * dt)
        there = _separation(c, points, share, contacts, p.position, motion) + more
        push = ti.max(contacts.normal_force[c] - k * (n.dot(there) - contacts.active_limit[c][LEAST]), 0.0)
        moved = there - before
        friction = contacts.friction_force[c] - k * (moved - n.dot(moved) * n)
        size = friction.norm()
        if size > contacts.law[c][STATIC] * push + NOTHING:
            friction *= contacts.law[c][KINETIC] * push / size
        contacts.force_change[c] = (push - contacts.normal_force[c]) * n + friction - contacts.friction_force[c]
        contacts.normal_force[c] = push
        contacts.friction_force[c] = friction


@ti.func
def move_point(i: ti.i32, dt: ti.f64, p: ti.template(), contacts: ti.template()):
    """Move a point as the changes of forces on it ask."""
    change = vec3(0.0, 0.0, 0.0)
    for entry in range(contacts.first_contact[i], contacts.first_contact[i + 1]):
        c = contacts.of_contact[entry] // 4
        change += contacts.weight[c][contacts.of_contact[entry] % 4] * contacts.force_change[c]
    p.position[i] += dt * dt * mobility(p, i) * change


@ti.func
def finish_point(i: ti.i32, dt: ti.f64, p: ti.template(), contacts: ti.template(), motion: ti.template()):
    """The velocity over a small step of a point that has contacts."""
    if contacts.first_contact[i + 1] > contacts.first_contact[i]:
        p.velocity[i] = (p.position[i] - motion.before[i]) / dt


@ti.func
def add_mean_force(c: ti.i32, number: ti.i32, contacts: ti.template()):
    """Add the force of a contact in one of so many small steps to its mean in the step."""
    total = contacts.normal_force[c] * contacts.normal[c] + contacts.friction_force[c]
    contacts.contact_force[c] += total / ti.cast(number, ti.f64)


@ti.func
def solid_shares(number: ti.i32, left: ti.i32):
    """Shares of the displacements of solids after a small step and before it."""
    whole = ti.cast(number, ti.f64)
    return 1.0 - ti.cast(left - 1, ti.f64) / whole, 1.0 - ti.cast(left, ti.f64) / whole


@ti.func
def project_alone(
    points: ti.i32,
    contact_count: ti.i32,
    sweeps: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    recovery: ti.f64,
    p: ti.template(),
    contacts: ti.template(),
    motion: ti.template(),
):
    """The contacts of one of so many small steps, on one thread, without bodies that give way; `left`: small steps to
    the end of the step."""
    if contact_count > 0:
        none, alike = ti.cast(0.0, ti.f64), vec3(0.0, 0.0, 0.0)
        share, earlier = solid_shares(number, left)
        for c in range(contact_count):
            warm_start(c, points, earlier, alike, recovery, contacts, motion)
        for i in range(points):
            move_point(i, dt, p, contacts)
        for _sweep in range(sweeps):
            for c in range(contact_count):
                find_active(c, points, share, alike, p, contacts, motion)
            for i in range(points):
                count_active(i, contacts, motion)
            for c in range(contact_count):
                project(c, points, dt, share, alike, none, p, contacts, motion)
            for i in range(points):
                move_point(i, dt, p, contacts)
        for i in range(points):
            finish_point(i, dt, p, contacts, motion)
        for c in range(contact_count):
            add_mean_force(c, number, contacts)
