"""Explicit small steps of a shell: symplectic Euler."""

from sim.cloth.fabric.air_drag import braked
from sim.cloth.fabric.layout import Drag, Points, StepMotion
from sim.cloth.shell.elements import (
    barrier,
    bent,
    frame,
    normal_at,
    normal_rate_at,
    shell_force,
    strain,
    strain_rate,
    stress_of,
)
from sim.cloth.shell.layout import ShellRest, ShellTrial
from sim.device.compiler import ti
from sim.device.double import vec3


@ti.kernel
def assess(triangles: ti.i32, points: ti.i32, p: Points, shell: ShellRest, trial: ShellTrial):
    """Stress and moments for where points are, and how fast."""
    for t in range(triangles):
        f = frame(t, shell, p.position)
        felt = strain(f) + shell.stretch_delay[t] * strain_rate(t, f, shell, p.velocity)
        trial.along_warp[t] = f.warp
        trial.along_weft[t] = f.weft
        trial.shell_normal[t] = f.normal
        trial.stress[t] = stress_of(t, felt, shell)
        trial.stiffening[t] = vec3(shell.barrier[t] * barrier(f.spread)[1], 0.0, 0.0)
    for i in range(points):
        kinds, normal = bent(i, shell, p.position), normal_at(i, shell, p.position)
        size, unit, rate = normal.norm(), vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
        if size > 0.0:
            unit = normal / size
            turning = normal_rate_at(i, shell, p.position, p.velocity)
            rate = bent(i, shell, p.velocity) @ unit + kinds @ ((turning - unit.dot(turning) * unit) / size)
        flat = shell.flat_at_rest[i]
        moment = (1.0 - flat) * (kinds @ unit) + shell.bend_delay[i] * rate - shell.rest_curvature[i]
        whole = flat * kinds + moment.outer_product(unit)
        trial.warp_moment[i] = vec3(whole[0, 0], whole[0, 1], whole[0, 2])
        trial.weft_moment[i] = vec3(whole[1, 0], whole[1, 1], whole[1, 2])
        trial.twist_moment[i] = vec3(whole[2, 0], whole[2, 1], whole[2, 2])
        lean = kinds.transpose() @ moment
        trial.normal_push[i] = vec3(0.0, 0.0, 0.0)
        if size > 0.0:
            trial.normal_push[i] = (lean - unit.dot(lean) * unit) / size


@ti.kernel
def find_momentum(
    points: ti.i32, dt: ti.f64, gravity: vec3, p: Points, shell: ShellRest, trial: ShellTrial, motion: StepMotion
):
    """The velocities that forces of a small step give, without air, in `before` [m/s]."""
    for i in range(points):
        motion.before[i] = p.velocity[i]
        if p.mobile[i]:
            motion.before[i] += dt * (gravity + shell_force(i, shell, trial, p.position) / p.mass[i])


@ti.kernel
def advance(
    airy: ti.template(), points: ti.i32, dt: ti.f64, left: ti.i32, wind: vec3, p: Points, d: Drag, motion: StepMotion
):
    """Take these velocities, and go on by them; a held point goes its share of the way to its target: `left` small
    steps."""
    for i in range(points):
        velocity, x = motion.before[i], p.position[i]
        motion.before[i] = x
        if p.mobile[i]:
            if ti.static(airy):
                velocity = braked(i, p.mass[i], dt, p.mass[i] * velocity, wind, d)
            p.velocity[i] = velocity
            p.position[i] = x + dt * velocity
        else:
            displacement = (motion.target[i] - x) / ti.cast(left, ti.f64)
            p.velocity[i] = displacement / dt
            p.position[i] = x + displacement
