"""The linear system of a step of Newton's method, contacts and coupled bodies included."""

from typing import Any

from sim.cloth.contact.augmented_lagrangian import friction_direction, on_body
from sim.cloth.fabric.layout import PARTITIONS, BlockMatrix, Contacts, CoupledBodies, Points
from sim.cloth.fabric.partition_sums import sum_partition, sum_partitions
from sim.cloth.integrators.newton.trial import Trial
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Matrices, Numbers, Vectors, cross_matrix, mat3, vec2, vec3, vec5

RESIDUAL, DECREASE, CURVATURE, STEP, BETA, LOW, HIGH, SLOPE_LOW, SLOPE_HIGH, SETTLED = range(10)
"""Scalars of conjugate gradients: r.z; along the direction p of the search, p.r, by which the energy falls at first,
and p.Ap; the length of the step, and which share of the direction the next one keeps; between which lengths the step
is, the slopes at these, and whether it is settled."""

System: Any = argpack(
    force=Vectors,
    force_before=Vectors,
    residual=Vectors,
    preconditioned=Vectors,
    direction=Vectors,
    product=Vectors,
    solution=Vectors,
    newton_direction=Vectors,
    preconditioner=Matrices,
    sum_term=Vectors,
    scalar=Numbers,
)
"""Of points: forces that are left where Newton's method is, and where it was [N]; of conjugate gradients r, z, p, A p
and x; the last direction of Newton's method [m]; the preconditioner. Terms of sums, three at once, and scalars."""


@ti.func
def conjugate_direction(sums: vec3, before: ti.f64, e: ti.template()):
    """Which share of the direction before the next one keeps (Polak and Ribiere); `sums`: r.z, z and the r before, and
    r and the direction before; `before`: r.z before, or 0 to keep nothing."""
    keep = ti.cast(0.0, ti.f64)
    if before > 0.0:
        keep = ti.max((sums[0] - sums[1]) / before, 0.0)
    decrease = sums[0] + keep * sums[2]
    if not decrease > 0.0:
        keep, decrease = ti.cast(0.0, ti.f64), sums[0]
    e.scalar[RESIDUAL] = sums[0]
    e.scalar[DECREASE] = decrease
    e.scalar[BETA] = keep


@ti.func
def _contact_block(c: ti.i32, contacts: ti.template()) -> mat3:
    """How much less a contact pushes for each displacement that its sides move apart."""
    unit = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    n, slip, b = contacts.normal[c], friction_direction(c, contacts), contacts.tangent_stiffness[c]
    return b[1] * unit + (b[0] - b[1]) * n.outer_product(n) + (b[2] - b[1]) * slip.outer_product(slip)


@ti.kernel
def linearize(
    points: ti.i32,
    body_count: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    p: Points,
    contacts: Contacts,
    bodies: CoupledBodies,
    matrix: BlockMatrix,
    t: Trial,
    e: System,
) -> vec5:
    """Add forces of contacts, and find the preconditioner: blocks of the diagonal. Returns r.z; the sum of r^2 / m,
    which bounds what is wrong whatever the springs: A is at least m / dt^2; the same of the forces that act; and both
    of bodies."""
    for row in range(2 * body_count):
        i, off = points + row, bodies.body_displacement[row] - bodies.body_predicted[row]
        inertia, found = bodies.body_inertia[row], bodies.body_inertia[row]
        for entry in range(bodies.first_body_contact[row // 2], bodies.first_body_contact[row // 2 + 1]):
            k = bodies.of_body_contact[entry]
            block = _contact_block(k // 2, contacts)
            if row % 2 == 0:
                found += contacts.body_weight[k] ** 2 * block
            else:
                lever = cross_matrix(contacts.body_arm[k])
                found += lever @ block @ lever.transpose()
        r = on_body(row, contacts, bodies, contacts.contact_force) - inertia @ off
        e.preconditioner[i] = found.inverse()
        e.force[i] = r
        e.residual[i] = r
        e.preconditioned[i] = e.preconditioner[i] @ r
        e.direction[i] = e.preconditioned[i]
        e.solution[i] = vec3(0.0, 0.0, 0.0)
        bodies.body_base[row] = bodies.body_displacement[row]
        if row % 2 == 0:
            off += dt * dt * gravity
        sums = vec3(dt * dt * r.dot(e.preconditioned[i]), r.dot(inertia.inverse() @ r), off.dot(inertia @ off))
        # Behind the sums over ranges of points.
        e.sum_term[points + PARTITIONS + row] = sums / (dt * dt)
    for i in range(points):
        z, r, left, acting = vec3(0.0, 0.0, 0.0), e.force[i], ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        if p.mobile[i]:
            whole = matrix.diagonal[i]
            for entry in range(contacts.first_contact[i], contacts.first_contact[i + 1]):
                c = contacts.of_contact[entry] // 4
                w = contacts.weight[c][contacts.of_contact[entry] % 4]
                r += w * contacts.contact_force[c]
                whole += w * w * _contact_block(c, contacts)
            e.preconditioner[i] = whole.inverse()
            z = e.preconditioner[i] @ r
            left = r.norm_sqr() / p.mass[i]
            acting = p.mass[i] * ((t.place[i] - t.predicted[i]) / (dt * dt) + gravity).norm_sqr()
        e.force[i] = r
        e.residual[i] = r
        e.preconditioned[i] = z
        e.direction[i] = z
        e.solution[i] = vec3(0.0, 0.0, 0.0)
        t.base[i] = t.place[i]
        e.sum_term[i] = vec3(r.dot(z), left, acting)
    for partition in range(PARTITIONS):
        sum_partition(partition, points, vec3(0.0, 0.0, 0.0), e.sum_term)
    total, of_bodies = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
    ti.loop_config(serialize=True)
    for _once in range(1):
        for row in range(2 * body_count):
            of_bodies += e.sum_term[points + PARTITIONS + row]
        total = sum_partitions(points, vec3(0.0, 0.0, 0.0), e.sum_term)
        e.scalar[RESIDUAL] = total[0] + of_bodies[0]
        e.scalar[DECREASE] = e.scalar[RESIDUAL]
    return vec5(e.scalar[RESIDUAL], total[1], total[2], of_bodies[1], of_bodies[2])


@ti.kernel
def set_load(points: ti.i32, rows: ti.i32, p: Points, load: Vectors, e: System) -> ti.f64:
    """Begin to look for how points, and bodies in so many rows, give way to forces [N] on points beside those there
    are; returns r.z."""
    for i in range(points + rows):
        z, r = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
        if i < points and p.mobile[i]:
            r = load[i]
            z = e.preconditioner[i] @ r
        e.residual[i] = r
        e.direction[i] = z
        e.solution[i] = vec3(0.0, 0.0, 0.0)
        e.sum_term[i] = vec3(r.dot(z), 0.0, 0.0)
    for partition in range(PARTITIONS):
        sum_partition(partition, points + rows, vec3(0.0, 0.0, 0.0), e.sum_term)
    ti.loop_config(serialize=True)
    for _once in range(1):
        total = sum_partitions(points + rows, vec3(0.0, 0.0, 0.0), e.sum_term)[0]
        e.scalar[RESIDUAL] = total
        e.scalar[DECREASE] = total
    return e.scalar[RESIDUAL]


@ti.kernel
def respond(points: ti.i32, e: System, found: Vectors):
    """What conjugate gradients found of points alone."""
    for i in range(points):
        found[i] = e.solution[i]


@ti.kernel
def conjugate(rows: ti.i32, before: ti.f64, e: System) -> vec2:
    """Turn the direction found, unless `before` is 0, so that it is conjugate to the one before; returns r.z and the
    predicted decrease of the energy: its slope along the direction. `rows`: of points and bodies."""
    for i in range(rows):
        z = e.solution[i]
        e.sum_term[i] = vec3(e.force[i].dot(z), e.force_before[i].dot(z), e.force[i].dot(e.newton_direction[i]))
    for partition in range(PARTITIONS):
        sum_partition(partition, rows, vec3(0.0, 0.0, 0.0), e.sum_term)
    ti.loop_config(serialize=True)
    for _once in range(1):
        conjugate_direction(sum_partitions(rows, vec3(0.0, 0.0, 0.0), e.sum_term), before, e)
    for i in range(rows):
        e.newton_direction[i] = e.solution[i] + e.scalar[BETA] * e.newton_direction[i]
        e.solution[i] = e.newton_direction[i]
        e.force_before[i] = e.force[i]
    return vec2(e.scalar[RESIDUAL], e.scalar[DECREASE])


@ti.kernel
def move(
    points: ti.i32, rows: ti.i32, share: ti.f64, reach: Numbers, bodies: CoupledBodies, t: Trial, e: System
) -> ti.f64:
    """Try a share of the direction found, of bodies in so many rows, too; returns how far the whole of it takes any
    point [m]. `reach`: how far a displacement or turn of 1 of a row of a body takes its points."""
    longest = ti.cast(0.0, ti.f64)
    for row in range(rows):
        bodies.body_displacement[row] = bodies.body_base[row] + share * e.solution[points + row]
        ti.atomic_max(longest, reach[row] * e.solution[points + row].norm())
    for i in range(points):
        t.place[i] = t.base[i] + share * e.solution[i]
        ti.atomic_max(longest, e.solution[i].norm())
    return longest
