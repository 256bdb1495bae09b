"""Bodies between contacts: what forces do to velocities, and velocities to places."""

import taichi as ti

from sim.double import Integers, Matrices, Numbers, Vectors, vec3
from sim.rigid.contact_solver import Motion
from sim.rigid.rotation import angular_velocity, rotation_of, spun, turned


@ti.kernel
def accelerate(
    count: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    free: Integers,
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
):
    """Gravity [m/s^2], forces [N] and torques [N m] act on free bodies for dt [s]; velocities are kept as they
    were before, and as they are then.

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
            old_velocity[b] = motion.velocity[b]
            old_spin[b] = motion.inverse_inertia[b] @ motion.momentum[b]
            motion.velocity[b] += dt * (gravity + force[b] / mass[b])
            motion.momentum[b] += dt * torque[b]
            motion.spin[b] = motion.inverse_inertia[b] @ motion.momentum[b]
        else:
            old_velocity[b] = motion.velocity[b]
            old_spin[b] = motion.spin[b]
        free_velocity[b] = motion.velocity[b]
        free_spin[b] = motion.spin[b]


@ti.kernel
def move(
    count: ti.i32,
    dt: ti.f64,
    free: Integers,
    led: Integers,
    inverse_inertia: Matrices,
    old_velocity: Vectors,
    free_velocity: Vectors,
    motion: Motion,
):
    """Carry free bodies on for dt [s]: on a parabola, exactly, where nothing was met; those `led` by their velocities
    at the end of the step, as the fluid that moves them is (symplectic Euler)."""
    for b in range(count):
        if free[b] == 1:
            way = dt * motion.velocity[b]
            if led[b] == 0 and (motion.velocity[b] - free_velocity[b]).norm_sqr() == 0.0:
                way = 0.5 * dt * (old_velocity[b] + motion.velocity[b])
            motion.position[b] += way
            motion.rotation[b] = spun(motion.rotation[b], motion.momentum[b], inverse_inertia[b], dt)
            motion.spin[b] = angular_velocity(motion.rotation[b], motion.momentum[b], inverse_inertia[b])


@ti.kernel
def shift(count: ti.i32, dt: ti.f64, free: Integers, parting_velocity: Vectors, parting_spin: Vectors, motion: Motion):
    """Move free bodies by velocities that they do not keep."""
    for b in range(count):
        if free[b] == 1:
            motion.position[b] += dt * parting_velocity[b]
            motion.rotation[b] = turned(motion.rotation[b], dt * parting_spin[b])
