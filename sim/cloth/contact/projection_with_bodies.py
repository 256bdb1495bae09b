"""Contacts of small steps, by the method of `projection`, on all threads or where bodies give way to the cloth."""

from sim.cloth.contact.augmented_lagrangian import body_displacement, on_body
from sim.cloth.contact.projection import (
    add_mean_force,
    count_active,
    find_active,
    finish_point,
    move_point,
    project,
    solid_shares,
    warm_start,
)
from sim.cloth.fabric.layout import ACTIVE, CoupledBodies, Points, ProjectedContacts, StepMotion
from sim.device.compiler import ti
from sim.device.double import cross_matrix


@ti.func
def _advance_body(row: ti.i32, number: ti.i32, dt: ti.f64, bodies: ti.template(), motion: ti.template()):
    """Take a body's row on at its velocity, without the forces that it was predicted with."""
    motion.body_velocity[row] += bodies.body_predicted[row] / (dt * number * number)
    bodies.body_base[row] = bodies.body_displacement[row]
    bodies.body_displacement[row] += dt * motion.body_velocity[row]


@ti.func
def _count_active_of_body(row: ti.i32, contacts: ti.template(), bodies: ti.template(), motion: ti.template()):
    number = ti.cast(0.0, ti.f64)
    for entry in range(bodies.first_body_contact[row // 2], bodies.first_body_contact[row // 2 + 1]):
        number += contacts.active_limit[bodies.of_body_contact[entry] // 2][ACTIVE]
    motion.body_active_contacts[row] = number


@ti.func
def _compliance(c: ti.i32, contacts: ti.template(), motion: ti.template()) -> ti.f64:
    """How much bodies give way to a contact at most, each with its share of them [1/kg]."""
    found = ti.cast(0.0, ti.f64)
    for side in ti.static(range(2)):
        k = 2 * c + side
        if contacts.body[k] >= 0:
            row, lever = 2 * contacts.body[k], cross_matrix(contacts.body_arm[k])
            turning = (lever.transpose() @ motion.body_mobility[row + 1] @ lever).trace()
            straight = contacts.body_weight[k] ** 2 * motion.body_mobility[row][0, 0]
            found += motion.body_active_contacts[row] * (straight + turning)
    return found


@ti.func
def _move_body(row: ti.i32, dt: ti.f64, contacts: ti.template(), bodies: ti.template(), motion: ti.template()):
    change = on_body(row, contacts, bodies, contacts.force_change)
    bodies.body_displacement[row] += dt * dt * motion.body_mobility[row] @ change


@ti.func
def _recovery(c: ti.i32, number: ti.i32, recovery: ti.f64, contacts: ti.template()) -> ti.f64:
    """The share of what a limit lacks that is made up for in a small step: of bodies so little that they are not thrown
    by it."""
    found = recovery
    if contacts.body[2 * c] >= 0 or contacts.body[2 * c + 1] >= 0:
        found = 1.0 / number
    return found


@ti.kernel
def project_bodies_alone(
    points: ti.i32,
    rows: ti.i32,
    contact_count: ti.i32,
    sweeps: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    recovery: ti.f64,
    p: Points,
    contacts: ProjectedContacts,
    bodies: CoupledBodies,
    motion: StepMotion,
):
    """The contacts of one of so many small steps, on one thread, with bodies in so many rows."""
    ti.loop_config(serialize=True)
    for _once in range(1):
        share, earlier = solid_shares(number, left)
        for row in range(rows):
            _advance_body(row, number, dt, bodies, motion)
        for c in range(contact_count):
            recovered = _recovery(c, number, recovery, contacts)
            apart = body_displacement(c, 0, contacts, bodies.body_base)
            warm_start(c, points, earlier, apart, recovered, contacts, motion)
        for i in range(points):
            move_point(i, dt, p, contacts)
        for row in range(rows):
            _move_body(row, dt, contacts, bodies, motion)
        for _sweep in range(sweeps):
            for c in range(contact_count):
                apart = body_displacement(c, 0, contacts, bodies.body_displacement)
                find_active(c, points, share, apart, p, contacts, motion)
            for i in range(points):
                count_active(i, contacts, motion)
            for row in range(rows):
                _count_active_of_body(row, contacts, bodies, motion)
            for c in range(contact_count):
                apart = body_displacement(c, 0, contacts, bodies.body_displacement)
                compliance = _compliance(c, contacts, motion)
                project(c, points, dt, share, apart, compliance, p, contacts, motion)
            for i in range(points):
                move_point(i, dt, p, contacts)
            for row in range(rows):
                _move_body(row, dt, contacts, bodies, motion)
        for i in range(points):
            finish_point(i, dt, p, contacts, motion)
        for row in range(rows):
            motion.body_velocity[row] = (bodies.body_displacement[row] - bodies.body_base[row]) / dt
        for c in range(contact_count):
            add_mean_force(c, number, contacts)


@ti.kernel
def begin(
    points: ti.i32,
    rows: ti.i32,
    contact_count: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    recovery: ti.f64,
    p: Points,
    contacts: ProjectedContacts,
    bodies: CoupledBodies,
    motion: StepMotion,
):
    """Begin with the contacts of one of so many small steps, on all threads, with bodies in so many rows."""
    for row in range(rows):
        _advance_body(row, number, dt, bodies, motion)
    for c in range(contact_count):
        _share, earlier = solid_shares(number, left)
        recovered = _recovery(c, number, recovery, contacts)
        apart = body_displacement(c, 0, contacts, bodies.body_base)
        warm_start(c, points, earlier, apart, recovered, contacts, motion)
    for i in range(points):
        move_point(i, dt, p, contacts)
    for row in range(rows):
        _move_body(row, dt, contacts, bodies, motion)


@ti.kernel
def sweep(
    points: ti.i32,
    rows: ti.i32,
    contact_count: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    p: Points,
    contacts: ProjectedContacts,
    bodies: CoupledBodies,
    motion: StepMotion,
):
    """One round of Jacobi's method in a small step: contacts change their forces, then points and bodies move by the
    changes."""
    for c in range(contact_count):
        share, _earlier = solid_shares(number, left)
        apart = body_displacement(c, 0, contacts, bodies.body_displacement)
        find_active(c, points, share, apart, p, contacts, motion)
    for i in range(points):
        count_active(i, contacts, motion)
    for row in range(rows):
        _count_active_of_body(row, contacts, bodies, motion)
    for c in range(contact_count):
        share, _earlier = solid_shares(number, left)
        apart = body_displacement(c, 0, contacts, bodies.body_displacement)
        compliance = _compliance(c, contacts, motion)
        project(c, points, dt, share, apart, compliance, p, contacts, motion)
    for i in range(points):
        move_point(i, dt, p, contacts)
    for row in range(rows):
        _move_body(row, dt, contacts, bodies, motion)


@ti.kernel
def end(
    points: ti.i32,
    rows: ti.i32,
    contact_count: ti.i32,
    number: ti.i32,
    dt: ti.f64,
    p: Points,
    contacts: ProjectedContacts,
    bodies: CoupledBodies,
    motion: StepMotion,
):
    """Velocities over a small step dt [s] of points that have contacts and of bodies, and the step's mean forces of
    contacts."""
    for i in range(points):
        finish_point(i, dt, p, contacts, motion)
    for row in range(rows):
        motion.body_velocity[row] = (bodies.body_displacement[row] - bodies.body_base[row]) / dt
    for c in range(contact_count):
        add_mean_force(c, number, contacts)
