"""Bodies between contacts: what forces do to velocities, and velocities to places.

Velocities that take a body through a step are those of its middle (leapfrog, Verlet 1967): steady forces, contacts of
what slides and rolls among them, then move it exactly as they should. A body that meets nothing has its velocity
brought to the end of the step at once. One that touches something keeps that of the middle, since the force there is
found with the next step, and is `late` by half of this one.
"""

import taichi as ti

from sim.device.double import Integers, Matrices, Numbers, Vectors, vec3
from sim.rigid.dynamics.contact_solver import Motion
from sim.rigid.dynamics.rotation import angular_velocity, rotation_of, spun, turned


@ti.kernel
def accelerate(
    count: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    free: Integers,
    led: Integers,
    late: Numbers,
    mass: Numbers,
    inverse_inertia: Matrices,
    force: Vectors,
    torque: Vectors,
    fluid_force: Vectors,
    fluid_torque: Vectors,
    motion: Motion,
    old_velocity: Vectors,
    old_spin: Vectors,
    free_velocity: Vectors,
    free_spin: Vectors,
    middle: Vectors,
):
    """Gravity [m/s^2], forces [N] and torques [N m] act on free bodies up to the middle of a step of dt [s], on those
    `led` up to its end. Velocities are kept as they were before, as they would be at the end if nothing were met, and
    in the middle.

    What the fluid does counts as if it had been done before: forces that change from step to step must not be taken
    for constant, or bodies that bob would gain energy.

    inverse_inertia: in the bodies' own axes [1/(kg m^2)].
    """
    for b in range(count):
        if free[b] == 1:
            turn = rotation_of(motion.rotation[b])
            motion.inverse_inertia[b] = turn @ inverse_inertia[b] @ turn.transpose()
            motion.velocity[b] += dt / mass[b] * fluid_force[b]
            motion.momentum[b] += dt * fluid_torque[b]
            pull = gravity + force[b] / mass[b]
            old_velocity[b] = motion.velocity[b]
            old_spin[b] = motion.inverse_inertia[b] @ motion.momentum[b]
            free_velocity[b] = motion.velocity[b] + dt * pull
            free_spin[b] = motion.inverse_inertia[b] @ (motion.momentum[b] + dt * torque[b])
            ahead = late[b] + ti.select(led[b] == 1, dt, 0.5 * dt)
            motion.velocity[b] += ahead * pull
            motion.momentum[b] += ahead * torque[b]
            motion.spin[b] = motion.inverse_inertia[b] @ motion.momentum[b]
        else:
            old_velocity[b] = motion.velocity[b]
            old_spin[b] = motion.spin[b]
            free_velocity[b] = motion.velocity[b]
            free_spin[b] = motion.spin[b]
        middle[b] = motion.velocity[b]


@ti.kernel
def move(
    count: ti.i32,
    dt: ti.f64,
    free: Integers,
    led: Integers,
    inverse_inertia: Matrices,
    torque: Vectors,
    old_velocity: Vectors,
    free_velocity: Vectors,
    middle: Vectors,
    motion: Motion,
    late: Numbers,
):
    """Carry free bodies on for dt [s], and bring the velocities of those that have met nothing to the end of the step;
    those `led` have that already and go by it, as the fluid that moves them does (symplectic Euler)."""
    for b in range(count):
        if free[b] == 1:
            motion.position[b] += dt * motion.velocity[b]
            motion.rotation[b] = spun(motion.rotation[b], motion.momentum[b], inverse_inertia[b], dt)
            late[b] = 0.0
            if led[b] == 0:
                if (motion.velocity[b] - middle[b]).norm_sqr() == 0.0:
                    motion.velocity[b] += 0.5 * (free_velocity[b] - old_velocity[b])
                    motion.momentum[b] += 0.5 * dt * torque[b]
                else:
                    late[b] = 0.5 * dt
            motion.spin[b] = angular_velocity(motion.rotation[b], motion.momentum[b], inverse_inertia[b])


@ti.kernel
def turn(count: ti.i32, free: Integers, inverse_inertia: Matrices, motion: Motion):
    """Angular velocities of free bodies from their momenta."""
    for b in range(count):
        if free[b] == 1:
            motion.spin[b] = angular_velocity(motion.rotation[b], motion.momentum[b], inverse_inertia[b])


@ti.kernel
def shift(count: ti.i32, dt: ti.f64, free: Integers, parting_velocity: Vectors, parting_spin: Vectors, motion: Motion):
    """Move free bodies by velocities that they do not keep."""
    for b in range(count):
        if free[b] == 1:
            motion.position[b] += dt * parting_velocity[b]
            motion.rotation[b] = turned(motion.rotation[b], dt * parting_spin[b])
