"""How a step of many small ones begins, and begins again: where points and bodies were, and are to be."""

from sim.cloth.fabric.layout import CoupledBodies, Points, ProjectedContacts, StepMotion
from sim.device.compiler import ti
from sim.device.double import Vectors, vec3


@ti.kernel
def rest_bodies(rows: ti.i32, dt: ti.f64, bodies: CoupledBodies, motion: StepMotion):
    """Bodies in so many rows begin a step of dt [s] without displacements of their own."""
    for row in range(rows):
        motion.body_mobility[row] = (dt * dt * bodies.body_inertia[row]).inverse()
        motion.body_velocity[row] = vec3(0.0, 0.0, 0.0)
        bodies.body_displacement[row] = vec3(0.0, 0.0, 0.0)


@ti.kernel
def clear_forces(contact_count: ti.i32, contacts: ProjectedContacts):
    """Forget the mean forces of contacts."""
    for c in range(contact_count):
        contacts.contact_force[c] = vec3(0.0, 0.0, 0.0)


@ti.kernel
def remember(total: ti.i32, dt: ti.f64, p: Points, velocity: Vectors, ahead: Vectors, motion: StepMotion):
    """Remember where points are and how fast [m/s], and predict where they would go at that speed [m]."""
    for i in range(total):
        motion.start[i] = p.position[i]
        velocity[i] = p.velocity[i]
        ahead[i] = p.position[i] + dt * p.velocity[i]
        if p.mobile[i] == 0:
            ahead[i] = motion.target[i]


@ti.kernel
def shift(points: ti.i32, displacement: Vectors, p: Points):
    """Move points by displacements [m]."""
    for i in range(points):
        p.position[i] += displacement[i]


@ti.kernel
def put_back(total: ti.i32, p: Points, velocity: Vectors, motion: StepMotion):
    """Take points, those of solids too, back to where they were before the step, and to their `velocity` then [m/s]."""
    for i in range(total):
        p.position[i] = motion.start[i]
        p.velocity[i] = velocity[i]


@ti.kernel
def carry_solids(points: ti.i32, total: ti.i32, dt: ti.f64, p: Points, motion: StepMotion):
    """Put the points of solids, behind the cloth's, at their targets, with the velocities that take them there in
    dt [s]."""
    for i in range(points, total):
        p.velocity[i] = (motion.target[i] - motion.start[i]) / dt
        p.position[i] = motion.target[i]
