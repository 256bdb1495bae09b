"""The energy of a step of implicit Euler.

The new positions minimise the energy

    sum m |x - y|^2 / (2 dt^2) + springs(x) + hinges(x) + dampers(x) + drag(x),

y where the points would go with gravity alone (Martin et al. 2011). Dampers store c (l - l_before)^2 / (2 dt), which
depends on lengths alone, so that turning is not damped. Second derivatives are taken without what would make them
negative, so that every direction found leads down.
"""

from typing import Any

from sim.cloth.contact.augmented_lagrangian import contact_energy
from sim.cloth.fabric.air_drag import drag, drag_block
from sim.cloth.fabric.bending import turned
from sim.cloth.fabric.layout import PARTITIONS, BlockMatrix, Contacts, CoupledBodies, MassSpring
from sim.cloth.fabric.partition_sums import sum_partition, sum_partitions
from sim.cloth.fabric.springs import block, line
from sim.cloth.integrators.newton.trial import Trial, hinge_fold
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors, mat3, vec3

ElementForces: Any = argpack(
    spring_direction=Vectors,
    spring_tangent=Vectors,
    moment=Numbers,
    hinge_stiffness=Numbers,
    angle_gradient=Vectors,
    energy_term=Numbers,
)
"""Springs: directions; stiffness along and across [N/m], tension [N]. Hinges: moments [N m], stiffness [N m], the four
gradients of each angle [1/m]. Energies of all of them, of contacts and of points [J]."""


@ti.kernel
def assess_contacts(
    first: ti.i32,
    contact_count: ti.i32,
    rows: ti.i32,
    contacts: Contacts,
    bodies: CoupledBodies,
    t: Trial,
    energy_term: Numbers,
):
    """Forces and stiffness of contacts at the places tried; energies [J] of them, and of the displacements of bodies in
    so many rows, from the `first` term on."""
    for c in range(contact_count):
        energy_term[first + c] = contact_energy(c, contacts, t.start, t.place, bodies.body_displacement)
    for row in range(rows):
        off = bodies.body_displacement[row] - bodies.body_predicted[row]
        energy_term[first + contact_count + row] = 0.5 * off.dot(bodies.body_inertia[row] @ off)


@ti.kernel
def assess(
    airy: ti.template(), others: ti.i32, dt: ti.f64, cloth: MassSpring, t: Trial, elements: ElementForces
) -> ti.f64:
    """Forces and stiffness of springs and hinges at the places tried; returns the energy [J], with so many terms of
    others that `assess_contacts` has found."""
    for k in range(cloth.spring_count):
        along, length = line(t.place[cloth.spring_ends[2 * k]], t.place[cloth.spring_ends[2 * k + 1]])
        over, since = length - cloth.rest_length[k], length - t.length_before[k]
        k_spring, damping = cloth.spring_stiffness[k], cloth.spring_damping[k]
        tension = k_spring * over + damping / dt * since
        stiffness, across = block(k_spring + damping / dt, tension, length)
        elements.spring_direction[k] = along
        elements.spring_tangent[k] = vec3(stiffness, across, tension)
        elements.energy_term[cloth.point_count + k] = 0.5 * (k_spring * over * over + damping / dt * since * since)
    for k in range(cloth.hinge_count):
        hinge = hinge_fold(k, cloth, t.place)
        over, since = turned(hinge.angle, cloth.rest_angle[k]), turned(hinge.angle, t.angle_before[k])
        k_hinge, damping = cloth.rigidity[k], cloth.bend_damping[k]
        elements.moment[k] = k_hinge * over + damping / dt * since
        elements.hinge_stiffness[k] = k_hinge + damping / dt
        elements.angle_gradient[4 * k] = hinge.p
        elements.angle_gradient[4 * k + 1] = hinge.q
        elements.angle_gradient[4 * k + 2] = hinge.r
        elements.angle_gradient[4 * k + 3] = hinge.s
        stored = 0.5 * (k_hinge * over * over + damping / dt * since * since)
        elements.energy_term[cloth.point_count + cloth.spring_count + k] = stored
    for i in range(cloth.point_count):
        energy = ti.cast(0.0, ti.f64)
        if cloth.mobile[i]:
            energy = 0.5 * cloth.mass[i] / (dt * dt) * (t.place[i] - t.predicted[i]).norm_sqr()
            if ti.static(airy):
                past = (t.place[i] - t.start[i]) / dt - cloth.wind
                energy += 0.5 * dt * past.dot(drag(i, past, cloth))
        elements.energy_term[i] = energy
    for partition in range(PARTITIONS):
        count = cloth.point_count + cloth.spring_count + cloth.hinge_count + others
        sum_partition(partition, count, ti.cast(0.0, ti.f64), elements.energy_term)
    energy = ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for _once in range(1):
        count = cloth.point_count + cloth.spring_count + cloth.hinge_count + others
        energy = sum_partitions(count, ti.cast(0.0, ti.f64), elements.energy_term)
    return energy


@ti.func
def _spring_block(n: vec3, b: vec3):
    """How the force of a spring changes."""
    return b[1] * mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) + (b[0] - b[1]) * n.outer_product(n)


@ti.kernel
def fill_off_diagonal(pairs: ti.i32, matrix: BlockMatrix, elements: ElementForces):
    """The blocks of the matrix beside the diagonal."""
    for pair in range(pairs):
        found = ti.Matrix.zero(ti.f64, 3, 3)
        for entry in range(matrix.first_element[pair], matrix.first_element[pair + 1]):
            what = matrix.of_element[entry]
            if what < 0:
                found -= _spring_block(elements.spring_direction[-1 - what], elements.spring_tangent[-1 - what])
            else:
                k, one, other = what // 16, what // 4 % 4, what % 4
                lean = elements.hinge_stiffness[k] * elements.angle_gradient[4 * k + one]
                found += lean.outer_product(elements.angle_gradient[4 * k + other])
        matrix.off_diagonal[matrix.slot[2 * pair]] = found
        matrix.off_diagonal[matrix.slot[2 * pair + 1]] = found.transpose()


@ti.kernel
def differentiate(
    airy: ti.template(),
    dt: ti.f64,
    cloth: MassSpring,
    matrix: BlockMatrix,
    t: Trial,
    elements: ElementForces,
    force: Vectors,
):
    """Forces that are left at the places tried, and the blocks of the diagonal, both without contacts."""
    for i in range(cloth.point_count):
        r = vec3(0.0, 0.0, 0.0)
        if cloth.mobile[i]:
            inertia = cloth.mass[i] / (dt * dt)
            r = inertia * (t.predicted[i] - t.place[i])
            inertial = inertia * mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            if ti.static(airy):
                r -= drag(i, (t.place[i] - t.start[i]) / dt - cloth.wind, cloth)
                inertial += drag_block(i, cloth) / dt
            whole = inertial
            for entry in range(cloth.first_spring[i], cloth.first_spring[i + 1]):
                k, end = cloth.of_spring[entry] // 2, cloth.of_spring[entry] % 2
                n, b = elements.spring_direction[k], elements.spring_tangent[k]
                r -= ti.cast(1 - 2 * end, ti.f64) * b[2] * n
                whole += _spring_block(n, b)
            for entry in range(cloth.first_hinge[i], cloth.first_hinge[i + 1]):
                k, gradient = cloth.of_hinge[entry] // 4, elements.angle_gradient[cloth.of_hinge[entry]]
                r -= elements.moment[k] * gradient
                whole += elements.hinge_stiffness[k] * gradient.outer_product(gradient)
            matrix.diagonal[i] = whole
            matrix.inertial_diagonal[i] = inertial
        force[i] = r
