"""Explicit small steps of a shell: symplectic Euler."""

from sim.cloth.fabric.air_drag import braked
from sim.cloth.fabric.layout import Drag, Points, StepMotion
from sim.cloth.shell.elements import (
    barrier,
    bent,
    frame,
    normal_at,
    normal_rate_at,
    set_moments,
    shell_force,
    strain,
    strain_rate,
    stress_of,
)
from sim.cloth.shell.layout import ShellRest, ShellTrial
from sim.device.compiler import ti
from sim.device.double import vec3


@ti.func
def _stretch(t: ti.i32, p: ti.template(), shell: ti.template(), trial: ti.template()):
    """Stress of a triangle for where its corners are, and how fast."""
    f = frame(t, shell, p.position)
    felt = strain(f) + shell.stretch_delay[t] * strain_rate(t, f, shell, p.velocity)
    trial.along_warp[t] = f.warp
    trial.along_weft[t] = f.weft
    trial.shell_normal[t] = f.normal
    trial.stress[t] = stress_of(t, felt, shell)
    trial.stiffening[t] = vec3(shell.barrier[t] * barrier(f.spread)[1], 0.0, 0.0)


@ti.func
def _bend(i: ti.i32, p: ti.template(), shell: ti.template(), trial: ti.template()):
    """Moments around a point for where those beside it are, and how fast."""
    kinds, normal = bent(i, shell, p.position), normal_at(i, shell, p.position)
    size, unit, rate = normal.norm(), vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
    if size > 0.0:
        unit = normal / size
        turning = normal_rate_at(i, shell, p.position, p.velocity)
        rate = bent(i, shell, p.velocity) @ unit + kinds @ ((turning - unit.dot(turning) * unit) / size)
    moment = (1.0 - shell.flat_at_rest[i]) * (kinds @ unit) + shell.bend_delay[i] * rate - shell.rest_curvature[i]
    set_moments(i, kinds, unit, size, moment, shell, trial)


@ti.func
def _advance(
    airy: ti.template(),
    i: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    wind: vec3,
    p: ti.template(),
    d: ti.template(),
    motion: ti.template(),
):
    """Take the velocity that `motion.before` has, and go on by it; a held point goes its share of the way."""
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


@ti.func
def _hasten(
    i: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    p: ti.template(),
    shell: ti.template(),
    trial: ti.template(),
    motion: ti.template(),
):
    """Leave in `motion.before` the velocity that forces give, without air."""
    motion.before[i] = p.velocity[i]
    if p.mobile[i]:
        motion.before[i] += dt * (gravity + shell_force(i, shell, trial, p.position) / p.mass[i])


@ti.kernel
def step(
    alone: ti.template(),
    airy: ti.template(),
    number: ti.i32,
    left: ti.i32,
    triangles: ti.i32,
    points: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    wind: vec3,
    p: Points,
    d: Drag,
    shell: ShellRest,
    trial: ShellTrial,
    motion: StepMotion,
):
    """One small step on all threads, or so many `alone` on one; `left`: small steps to the time at which held points
    are at their targets."""
    if ti.static(alone):
        ti.loop_config(serialize=True)
        for now in range(number):
            for t in range(triangles):
                _stretch(t, p, shell, trial)
            for i in range(points):
                _bend(i, p, shell, trial)
            for i in range(points):
                _hasten(i, dt, gravity, p, shell, trial, motion)
            for i in range(points):
                _advance(airy, i, dt, left - now, wind, p, d, motion)
    else:
        for t in range(triangles):
            _stretch(t, p, shell, trial)
        for i in range(points):
            _bend(i, p, shell, trial)
        for i in range(points):
            _hasten(i, dt, gravity, p, shell, trial, motion)
        for i in range(points):
            _advance(airy, i, dt, left, wind, p, d, motion)
