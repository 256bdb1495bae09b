"""Bodies between contacts: what forces do to velocities, and velocities to places.

Velocities that take a body through a step are those of its middle (leapfrog, Verlet 1967): steady forces, contacts of
what slides and rolls among them, then move it exactly as they should. A body that meets nothing has its velocity
brought to the end of the step at once. One that touches something keeps that of the middle, since the force there is
found with the next step, and its velocity lags by half of this one.
"""

from sim.device.compiler import ti
from sim.device.double import Vectors, vec3
from sim.rigid.dynamics.rotation import angular_velocity, rotation_of, spun, turned
from sim.rigid.layout import BodyProperties, Loads, Motion, StepVelocities


@ti.kernel
def accelerate(
    count: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    bodies: BodyProperties,
    loads: Loads,
    motion: Motion,
    velocities: StepVelocities,
):
    """Gravity [m/s^2] and loads act on dynamic bodies up to the middle of a step of dt [s], on those that fluid drives
    up to its end. Velocities are kept as they were before, as they would be at the end if nothing were met, and in the
    middle.

    What the fluid does counts as if it had been done before: forces that change from step to step must not be taken
    for constant, or bodies that bob would gain energy.
    """
    for b in range(count):
        if bodies.dynamic[b] == 1:
            turn = rotation_of(motion.rotation[b])
            motion.inverse_inertia[b] = turn @ bodies.own_inverse_inertia[b] @ turn.transpose()
            motion.velocity[b] += dt / bodies.mass[b] * loads.fluid_force[b]
            motion.momentum[b] += dt * loads.fluid_torque[b]
            pull = gravity + loads.force[b] / bodies.mass[b]
            velocities.old_velocity[b] = motion.velocity[b]
            velocities.old_spin[b] = motion.inverse_inertia[b] @ motion.momentum[b]
            velocities.free_velocity[b] = motion.velocity[b] + dt * pull
            velocities.free_spin[b] = motion.inverse_inertia[b] @ (motion.momentum[b] + dt * loads.torque[b])
            ahead = bodies.velocity_lag[b] + ti.select(bodies.fluid_driven[b] == 1, dt, 0.5 * dt)
            motion.velocity[b] += ahead * pull
            motion.momentum[b] += ahead * loads.torque[b]
            motion.spin[b] = motion.inverse_inertia[b] @ motion.momentum[b]
        else:
            velocities.old_velocity[b] = motion.velocity[b]
            velocities.old_spin[b] = motion.spin[b]
            velocities.free_velocity[b] = motion.velocity[b]
            velocities.free_spin[b] = motion.spin[b]
        velocities.middle_velocity[b] = motion.velocity[b]


@ti.kernel
def move(
    count: ti.i32,
    dt: ti.f64,
    bodies: BodyProperties,
    loads: Loads,
    motion: Motion,
    velocities: StepVelocities,
):
    """Carry dynamic bodies on for dt [s], and bring the velocities of those that have met nothing to the end of the
    step; those that fluid drives have that already and go by it, as the fluid does (symplectic Euler)."""
    for b in range(count):
        if bodies.dynamic[b] == 1:
            motion.position[b] += dt * motion.velocity[b]
            motion.rotation[b] = spun(motion.rotation[b], motion.momentum[b], bodies.own_inverse_inertia[b], dt)
            bodies.velocity_lag[b] = 0.0
            if bodies.fluid_driven[b] == 0:
                if (motion.velocity[b] - velocities.middle_velocity[b]).norm_sqr() == 0.0:
                    motion.velocity[b] += 0.5 * (velocities.free_velocity[b] - velocities.old_velocity[b])
                    motion.momentum[b] += 0.5 * dt * loads.torque[b]
                else:
                    bodies.velocity_lag[b] = 0.5 * dt
            motion.spin[b] = angular_velocity(motion.rotation[b], motion.momentum[b], bodies.own_inverse_inertia[b])


@ti.kernel
def turn(count: ti.i32, bodies: BodyProperties, motion: Motion):
    """Angular velocities of dynamic bodies from their momenta."""
    for b in range(count):
        if bodies.dynamic[b] == 1:
            motion.spin[b] = angular_velocity(motion.rotation[b], motion.momentum[b], bodies.own_inverse_inertia[b])


@ti.kernel
def shift(
    count: ti.i32, dt: ti.f64, bodies: BodyProperties, parting_velocity: Vectors, parting_spin: Vectors, motion: Motion
):
    """Move dynamic bodies by velocities that they do not keep."""
    for b in range(count):
        if bodies.dynamic[b] == 1:
            motion.position[b] += dt * parting_velocity[b]
            motion.rotation[b] = turned(motion.rotation[b], dt * parting_spin[b])
