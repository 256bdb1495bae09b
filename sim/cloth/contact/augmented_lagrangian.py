"""Forces of contacts, as implicit Euler looks for them: an augmented Lagrangian (Alart & Curnier 1991).

The normal force is max(0, lambda_n - k gap) and friction lambda_t - k slip, where k is the contact stiffness and the
multipliers lambda are the forces in the step before; friction is cut to its coefficient times the normal force. So what
rests, rests without a gap below zero and without creeping, whatever k is: Signorini's and Coulomb's laws. In a step all
of that follows from one energy, as the normal force that bounds friction lags behind (`update_lagged_forces`).
"""

from sim.cloth.fabric.layout import KINETIC, LAGGED, LIMIT, STATIC, Contacts, CoupledBodies
from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors, vec3

NOTHING = 1e-30
"""A force of friction below this [N] has no direction."""


@ti.func
def point_separation(c: ti.i32, contacts: ti.template(), values: ti.template()) -> vec3:
    """A vector of points where the first side of a contact is, less that of the other side."""
    total = vec3(0.0, 0.0, 0.0)
    for corner in ti.static(range(4)):
        i = contacts.corner[4 * c + corner]
        if i >= 0:
            total += contacts.weight[c][corner] * values[i]
    return total


@ti.func
def body_displacement(c: ti.i32, first: ti.i32, contacts: ti.template(), values: ti.template()) -> vec3:
    """By how much bodies take the sides of a contact apart; their displacements and turns are `values`, from
    `first` on."""
    total = vec3(0.0, 0.0, 0.0)
    for side in ti.static(range(2)):
        k = 2 * c + side
        if contacts.body[k] >= 0:
            row = first + 2 * contacts.body[k]
            total += contacts.body_weight[k] * values[row] + values[row + 1].cross(contacts.body_arm[k])
    return total


@ti.func
def separation(c: ti.i32, points: ti.i32, contacts: ti.template(), values: ti.template()) -> vec3:
    """How far displacements of points, and of bodies in the rows after them, take the sides of a contact apart."""
    total = body_displacement(c, points, contacts, values)
    for corner in ti.static(range(4)):
        i = contacts.corner[4 * c + corner]
        if 0 <= i < points:
            total += contacts.weight[c][corner] * values[i]
    return total


@ti.func
def on_body(row: ti.i32, contacts: ti.template(), bodies: ti.template(), values: ti.template()) -> vec3:
    """What vectors of contacts add up to on a row of a body: forces, or torques about its centre of mass."""
    total = vec3(0.0, 0.0, 0.0)
    for entry in range(bodies.first_body_contact[row // 2], bodies.first_body_contact[row // 2 + 1]):
        k = bodies.of_body_contact[entry]
        if row % 2 == 0:
            total += contacts.body_weight[k] * values[k // 2]
        else:
            total += contacts.body_arm[k].cross(values[k // 2])
    return total


@ti.func
def friction_bound(c: ti.i32, contacts: ti.template()) -> ti.f64:
    """The greatest friction of a contact [N], by the lagged normal force."""
    bound = contacts.law[c][KINETIC]
    if contacts.tangent_stiffness[c][2] > 0.0:
        bound = contacts.law[c][STATIC]
    return bound * contacts.law[c][LAGGED]


@ti.func
def admissible_force(c: ti.i32, contacts: ti.template(), trial: vec3) -> vec3:
    """What the laws of contact leave of a trial force: a push, and friction in the cone that holds for now."""
    n = contacts.normal[c]
    along = n.dot(trial)
    force, most = ti.max(along, 0.0) * n, friction_bound(c, contacts)
    if most > 0.0:
        friction = trial - along * n
        size = friction.norm()
        if size > most + NOTHING:
            friction *= most / size
        force += friction
    return force


@ti.func
def work_along(c: ti.i32, contacts: ti.template(), trial: vec3, displacement: vec3):
    """The work of a contact at a trial force along a displacement [J], and how much less it is for each displacement
    more that it has gone."""
    n, k = contacts.normal[c], contacts.stiffness[c]
    along, opening, most = n.dot(trial), n.dot(displacement), friction_bound(c, contacts)
    work, less = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    if along > 0.0:
        work += along * opening
        less += k * opening * opening
    if most > 0.0:
        friction, across = trial - along * n, displacement - opening * n
        size, done = friction.norm(), friction.dot(across)
        if size > most + NOTHING:
            work += most / size * done
            less += k * most / size * (across.norm_sqr() - (done / size) ** 2)
        else:
            work += done
            less += k * across.norm_sqr()
    return work, less


@ti.func
def contact_energy(
    c: ti.i32, contacts: ti.template(), start: ti.template(), place: ti.template(), displacement: ti.template()
) -> ti.f64:
    """Set the force of a contact; returns what it stores [J]. `displacement`: of bodies, besides the places of their
    points."""
    n, k = contacts.normal[c], contacts.stiffness[c]
    there = point_separation(c, contacts, place) + body_displacement(c, 0, contacts, displacement)
    moved = there - point_separation(c, contacts, start)
    friction = contacts.friction_force[c] - k * moved
    friction -= n.dot(friction) * n
    push = contacts.normal_force[c] - k * (n.dot(there) - contacts.law[c][LIMIT])
    size, most = friction.norm(), contacts.law[c][KINETIC] * contacts.law[c][LAGGED]
    across, along_slip = k, k
    energy = 0.5 * (ti.max(push, 0.0) ** 2 - contacts.normal_force[c] * contacts.normal_force[c]) / k
    if size <= contacts.law[c][STATIC] * contacts.law[c][LAGGED] + NOTHING:
        energy += 0.5 * size * size / k
    else:
        energy += (most * size - 0.5 * most * most) / k
        across, along_slip = k * most / size, ti.cast(0.0, ti.f64)
    contacts.trial_force[c] = push * n + friction
    contacts.tangent_stiffness[c] = vec3(k if push > 0.0 else 0.0, across, along_slip)
    contacts.contact_force[c] = admissible_force(c, contacts, contacts.trial_force[c])
    return energy


@ti.func
def friction_direction(c: ti.i32, contacts: ti.template()) -> vec3:
    """The unit vector along the friction of a contact; zero where there is none."""
    n, trial = contacts.normal[c], contacts.trial_force[c]
    friction = trial - n.dot(trial) * n
    size, found = friction.norm(), vec3(0.0, 0.0, 0.0)
    if size > NOTHING:
        found = friction / size
    return found


@ti.func
def tangent_force(c: ti.i32, contacts: ti.template(), displacement: vec3) -> vec3:
    """How much less a contact pushes after its sides have moved apart by `displacement` [m], if it goes on as it
    does."""
    n, t, b = contacts.normal[c], friction_direction(c, contacts), contacts.tangent_stiffness[c]
    along, sliding = n.dot(displacement), t.dot(displacement)
    return b[0] * along * n + b[1] * (displacement - along * n - sliding * t) + b[2] * sliding * t


@ti.kernel
def activate(contact_count: ti.i32, reach: ti.f64, contacts: Contacts):
    """Find the active contacts: those that press or hold, or would if their sides came nearer by `reach` [m]."""
    for c in range(contact_count):
        along = contacts.normal[c].dot(contacts.trial_force[c])
        contacts.active[c] = int(along > -reach * contacts.stiffness[c] or friction_bound(c, contacts) > 0.0)
        if not contacts.active[c]:
            contacts.force_change[c] = vec3(0.0, 0.0, 0.0)


@ti.kernel
def set_stiffness(
    contact_count: ti.i32,
    points: ti.i32,
    inertias: ti.f64,
    springs: ti.f64,
    sinking: ti.f64,
    borne: ti.f64,
    dt: ti.f64,
    mass: Numbers,
    springs_at_point: Numbers,
    thickness: Numbers,
    contacts: Contacts,
    bodies: CoupledBodies,
):
    """Set the contact stiffness: so many times the inertia of their points in a step, or of the mass of bodies that
    each has to bear [kg]; or such that the multiplier would let them sink by a share of their thickness, but not more
    than so many times that of springs and inertia there.

    Forces that go on from step to step follow what is sunk: with less stiffness than the inertia of all that they bear
    they come too late, and what lies there is thrown up."""
    for c in range(contact_count):
        heavy, soft = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for corner in ti.static(range(4)):
            i = contacts.corner[4 * c + corner]
            if 0 <= i < points:
                inertia, squared = mass[i] / (dt * dt), contacts.weight[c][corner] ** 2
                heavy += squared / inertia
                soft += squared / (inertia + springs_at_point[i])
        for side in ti.static(range(2)):
            row = 2 * contacts.body[2 * c + side]
            if row >= 0:
                give = contacts.body_weight[2 * c + side] ** 2 / bodies.body_inertia[row][0, 0]
                heavy += give
                soft += give
        least, most = inertias / ti.max(heavy, 1e-30), springs / ti.max(soft, 1e-30)
        least = ti.max(least, inertias * borne / (dt * dt))
        contacts.stiffness[c] = ti.max(least, ti.min(contacts.normal_force[c] / (sinking * thickness[c]), most))


@ti.kernel
def count_violations(
    contact_count: ti.i32, both: ti.i32, share: ti.f64, thickness: Numbers, contacts: Contacts, place: Vectors
) -> ti.i32:
    """How many contacts lack more than a share of their thickness, or, of `both`, press from as far."""
    found = 0
    for c in range(contact_count):
        n = contacts.normal[c]
        over = n.dot(point_separation(c, contacts, place)) - contacts.law[c][LIMIT]
        if over < -share * thickness[c] or (
            both and over > share * thickness[c] and n.dot(contacts.contact_force[c]) > 0.0
        ):
            found += 1
    return found


@ti.kernel
def update_lagged_forces(contact_count: ti.i32, contacts: Contacts) -> ti.f64:
    """Let the present normal forces bound friction; returns the greatest change of the bounds, over the stiffness
    [m]."""
    most = ti.cast(0.0, ti.f64)
    for c in range(contact_count):
        push = contacts.normal[c].dot(contacts.contact_force[c])
        ti.atomic_max(most, contacts.law[c][STATIC] * abs(push - contacts.law[c][LAGGED]) / contacts.stiffness[c])
        contacts.law[c][LAGGED] = push
    return most


@ti.kernel
def update_multipliers(contact_count: ti.i32, contacts: Contacts):
    """Take the forces of contacts for the multipliers."""
    for c in range(contact_count):
        n, force = contacts.normal[c], contacts.contact_force[c]
        push = n.dot(force)
        hold = force - push * n
        size = hold.norm()
        if size > contacts.law[c][STATIC] * push + NOTHING:
            hold *= contacts.law[c][KINETIC] * push / size
        contacts.normal_force[c] = push
        contacts.friction_force[c] = hold
