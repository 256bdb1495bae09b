"""Conjugate gradients for a step of Newton's method, in which contacts close, open, stick and slide as laws say.

What is minimised is quadratic but for contacts, whose energies are convex: the residual is that of the energy itself,
the step along a direction is where its slope ends, and directions follow Polak and Ribiere (Nocedal & Wright 2006,
sec. 5.2). Without contacts, or where contacts go on as they do, that is the linear method. Blocks of the diagonal are
the preconditioner. Small cloths are solved by one thread in one launch: threads would wait for one another most of the
time.
"""

from sim.cloth.contact.augmented_lagrangian import admissible_force, on_body, separation, tangent_force, work_along
from sim.cloth.fabric.layout import PARTITIONS, AlikeRows, BlockMatrix, Contacts, CoupledBodies, Points
from sim.cloth.fabric.partition_sums import partition_start, sum_partitions
from sim.cloth.integrators.newton.linear_system import (
    BETA,
    CURVATURE,
    DECREASE,
    HIGH,
    LOW,
    RESIDUAL,
    SETTLED,
    SLOPE_HIGH,
    SLOPE_LOW,
    STEP,
    System,
    conjugate_direction,
)
from sim.device.compiler import ti
from sim.device.double import vec3

TRIES, TRIES_ALONE = 3, 20
"""To find the length of a step, after the first: friction turns round within a hair's breadth, and threads that share
the work pay for each."""
FLAT = 0.1
"""Of the slope of the energy at the start of a step, so much may be left at its end."""
FAR = 1e30
"""No step is as long."""


@ti.func
def _multiply(
    i: ti.i32,
    points: ti.i32,
    p: ti.template(),
    bodies: ti.template(),
    matrix: ti.template(),
    rows: ti.template(),
    e: ti.template(),
) -> vec3:
    """Of A p, but for contacts, one row; returns its part of p.Ap."""
    q = vec3(0.0, 0.0, 0.0)
    if i >= points:
        q = bodies.body_inertia[i - points] @ e.direction[i]
    elif p.mobile[i]:
        # Springs and hinges feel differences: what moves as a whole does not push itself, whatever their stiffness.
        own = e.direction[i]
        q = matrix.inertial_diagonal[i] @ own
        for k in range(matrix.first_block[i], matrix.first_block[i + 1]):
            q += matrix.off_diagonal[k] @ (e.direction[matrix.column[k]] - own)
        for k in range(rows.first_alike[i], rows.first_alike[i + 1]):
            q += rows.alike[k] * (e.direction[rows.alike_column[k]] - own)
    e.product[i] = q
    return vec3(0.0, q.dot(e.direction[i]), 0.0)


@ti.func
def _slope(linear: ti.template(), c: ti.i32, contacts: ti.template(), e: ti.template()) -> vec3:
    """What a contact does to the slope of the energy after a step along the direction: that it takes away, and its
    curvature."""
    decrease, curvature = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    if contacts.active[c]:
        displacement, step = contacts.relative_displacement[c], e.scalar[STEP]
        if ti.static(linear):
            curvature = displacement.dot(tangent_force(c, contacts, displacement))
            decrease = -step * curvature
        else:
            trial = contacts.trial_force[c] - step * contacts.stiffness[c] * displacement
            work, less = work_along(c, contacts, trial, displacement)
            decrease, curvature = work - displacement.dot(contacts.contact_force[c]), less
    return vec3(decrease, curvature, 0.0)


@ti.func
def _choose_step(of_contacts: vec3, e: ti.template()):
    """The next step to try, by Newton's method on the slope, or, where that leads out, by the secant between those
    known to be too small and too large, the slope at the end that stays halved (Illinois); or settle for this one."""
    step = e.scalar[STEP]
    decrease = e.scalar[DECREASE] - step * e.scalar[CURVATURE] + of_contacts[0]
    curvature = e.scalar[CURVATURE] + of_contacts[1]
    if abs(decrease) <= FLAT * e.scalar[DECREASE]:
        e.scalar[SETTLED] = 1.0
    else:
        if decrease > 0.0:
            e.scalar[LOW] = step
            e.scalar[SLOPE_LOW] = decrease
            e.scalar[SLOPE_HIGH] *= 0.5
        else:
            e.scalar[HIGH] = step
            e.scalar[SLOPE_HIGH] = decrease
            e.scalar[SLOPE_LOW] *= 0.5
        low, high = e.scalar[LOW], e.scalar[HIGH]
        found = step
        if curvature > 0.0:
            found = step + decrease / curvature
        if found > high or found < low:
            found = low + (high - low) * e.scalar[SLOPE_LOW] / (e.scalar[SLOPE_LOW] - e.scalar[SLOPE_HIGH])
        e.scalar[STEP] = found


@ti.func
def _begin_to_choose_step(curvature: ti.f64, e: ti.template()):
    e.scalar[CURVATURE] = curvature
    e.scalar[STEP] = 0.0
    e.scalar[LOW] = 0.0
    e.scalar[HIGH] = FAR
    e.scalar[SLOPE_LOW] = e.scalar[DECREASE]
    e.scalar[SLOPE_HIGH] = 0.0
    e.scalar[SETTLED] = 0.0


@ti.func
def _update_contact(linear: ti.template(), c: ti.i32, contacts: ti.template(), e: ti.template()):
    """Take the step with a contact; leaves by what its force changes."""
    if contacts.active[c]:
        step, displacement = e.scalar[STEP], contacts.relative_displacement[c]
        if ti.static(linear):
            contacts.force_change[c] = -step * tangent_force(c, contacts, displacement)
        else:
            trial = contacts.trial_force[c] - step * contacts.stiffness[c] * displacement
            force = admissible_force(c, contacts, trial)
            contacts.trial_force[c] = trial
            contacts.force_change[c] = force - contacts.contact_force[c]
            contacts.contact_force[c] = force


@ti.func
def _update_row(
    i: ti.i32, points: ti.i32, p: ti.template(), contacts: ti.template(), bodies: ti.template(), e: ti.template()
) -> vec3:
    """Take the step with a row; returns its parts of r.z, of z and the residual before, and of p.r."""
    step, before, z = e.scalar[STEP], e.residual[i], vec3(0.0, 0.0, 0.0)
    e.solution[i] += step * e.direction[i]
    r = before - step * e.product[i]
    if i >= points:
        r += on_body(i - points, contacts, bodies, contacts.force_change)
        z = e.preconditioner[i] @ r
    elif p.mobile[i]:
        for entry in range(contacts.first_contact[i], contacts.first_contact[i + 1]):
            c = contacts.of_contact[entry] // 4
            if contacts.active[c]:
                r += contacts.weight[c][contacts.of_contact[entry] % 4] * contacts.force_change[c]
        z = e.preconditioner[i] @ r
    e.residual[i] = r
    e.preconditioned[i] = z
    return vec3(r.dot(z), before.dot(z), r.dot(e.direction[i]))


@ti.kernel
def solve_alone(
    linear: ti.template(),
    points: ti.i32,
    body_count: ti.i32,
    contact_count: ti.i32,
    most: ti.i32,
    enough: ti.f64,
    p: Points,
    contacts: Contacts,
    bodies: CoupledBodies,
    matrix: BlockMatrix,
    alike_rows: AlikeRows,
    e: System,
) -> ti.i32:
    """On one thread, until r.z is not above `enough`; returns iterations, one more than `most` where that is not so."""
    made = 0
    ti.loop_config(serialize=True)
    for _once in range(1):
        while e.scalar[RESIDUAL] > enough and made <= most:
            made += 1
            curvature = vec3(0.0, 0.0, 0.0)
            for i in range(points + 2 * body_count):
                curvature += _multiply(i, points, p, bodies, matrix, alike_rows, e)
            _begin_to_choose_step(curvature[1], e)
            for c in range(contact_count):
                if contacts.active[c]:
                    contacts.relative_displacement[c] = separation(c, points, contacts, e.direction)
            for _try in range(1 + TRIES_ALONE):
                if e.scalar[SETTLED] == 0.0:
                    of_contacts = vec3(0.0, 0.0, 0.0)
                    for c in range(contact_count):
                        of_contacts += _slope(linear, c, contacts, e)
                    _choose_step(of_contacts, e)
            for c in range(contact_count):
                _update_contact(linear, c, contacts, e)
            sums = vec3(0.0, 0.0, 0.0)
            for i in range(points + 2 * body_count):
                sums += _update_row(i, points, p, contacts, bodies, e)
            conjugate_direction(sums, e.scalar[RESIDUAL], e)
            for i in range(points + 2 * body_count):
                e.direction[i] = e.preconditioned[i] + e.scalar[BETA] * e.direction[i]
    return made


@ti.kernel
def iterate(
    linear: ti.template(),
    touching: ti.template(),
    points: ti.i32,
    rows: ti.i32,
    contact_count: ti.i32,
    p: Points,
    contacts: Contacts,
    bodies: CoupledBodies,
    matrix: BlockMatrix,
    alike_rows: AlikeRows,
    e: System,
) -> ti.f64:
    """An iteration on all threads, for so many points, rows of points and bodies, and contacts; returns r.z.
    `touching`: whether there are contacts. Threads meet after each loop, which takes as long as a thousand points: so
    each loop does all that it can."""
    ti.loop_config(block_dim=4)
    for partition in range(PARTITIONS):
        total = vec3(0.0, 0.0, 0.0)
        for i in range(partition_start(partition, rows), partition_start(partition + 1, rows)):
            total += _multiply(i, points, p, bodies, matrix, alike_rows, e)
        e.sum_term[rows + partition] = total
    ti.loop_config(serialize=True)
    for _once in range(1):
        _begin_to_choose_step(sum_partitions(rows, vec3(0.0, 0.0, 0.0), e.sum_term)[1], e)
        if ti.static(not touching):
            _choose_step(vec3(0.0, 0.0, 0.0), e)
    if ti.static(touching):
        for c in range(contact_count):
            if contacts.active[c]:
                contacts.relative_displacement[c] = separation(c, points, contacts, e.direction)
        for _try in ti.static(range(1 + TRIES)):
            ti.loop_config(block_dim=4)
            for partition in range(PARTITIONS):
                if e.scalar[SETTLED] == 0.0:
                    total = vec3(0.0, 0.0, 0.0)
                    begin = partition_start(partition, contact_count)
                    for c in range(begin, partition_start(partition + 1, contact_count)):
                        total += _slope(linear, c, contacts, e)
                    e.sum_term[contact_count + partition] = total
            ti.loop_config(serialize=True)
            for _once in range(1):
                if e.scalar[SETTLED] == 0.0:
                    _choose_step(sum_partitions(contact_count, vec3(0.0, 0.0, 0.0), e.sum_term), e)
        for c in range(contact_count):
            _update_contact(linear, c, contacts, e)
    ti.loop_config(block_dim=4)
    for partition in range(PARTITIONS):
        total = vec3(0.0, 0.0, 0.0)
        for i in range(partition_start(partition, rows), partition_start(partition + 1, rows)):
            total += _update_row(i, points, p, contacts, bodies, e)
        e.sum_term[rows + partition] = total
    ti.loop_config(serialize=True)
    for _once in range(1):
        conjugate_direction(sum_partitions(rows, vec3(0.0, 0.0, 0.0), e.sum_term), e.scalar[RESIDUAL], e)
    for i in range(rows):
        e.direction[i] = e.preconditioned[i] + e.scalar[BETA] * e.direction[i]
    return e.scalar[RESIDUAL]
