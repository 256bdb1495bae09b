"""The parts of a substep of extended position-based dynamics."""

from typing import Any

from sim.cloth.contact.projection import mobility, project_alone
from sim.cloth.fabric.air_drag import braked
from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import Drag, Hinges, MassSpring, Points, ProjectedContacts, Springs, StepMotion
from sim.cloth.fabric.springs import line
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Numbers, vec3

Multipliers: Any = argpack(spring_multiplier=Numbers, hinge_multiplier=Numbers)
"""Multipliers of springs and hinges."""


@ti.func
def _change(
    dt: ti.f64,
    over: ti.f64,
    since: ti.f64,
    stiffness: ti.f64,
    damping: ti.f64,
    multiplier: ti.f64,
    inverse_mass: ti.f64,
):
    """Of a multiplier: Macklin et al. 2016, eq. 26, times the stiffness; `inverse_mass`: grad C M^-1 grad C [1/kg]."""
    soft = 1.0 / (dt * dt)
    slow = damping / dt
    return -(stiffness * over + soft * multiplier + slow * since) / ((stiffness + slow) * inverse_mass + soft)


@ti.func
def predict_point(
    airy: ti.template(),
    i: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    gravity: vec3,
    wind: vec3,
    p: ti.template(),
    d: ti.template(),
    motion: ti.template(),
):
    """Where a point would go without springs; `left`: substeps until held points are at their targets."""
    x = p.position[i]
    motion.before[i] = x
    if p.mobile[i]:
        v = p.velocity[i] + dt * gravity
        if ti.static(airy):
            v = braked(i, p.mass[i], dt, p.mass[i] * v, wind, d)
        p.position[i] = x + dt * v
    else:
        p.position[i] = x + (motion.target[i] - x) / ti.cast(left, ti.f64)


@ti.func
def _project_spring(
    k: ti.i32, dt: ti.f64, p: ti.template(), s: ti.template(), multipliers: ti.template(), motion: ti.template()
):
    one, other = s.spring_ends[2 * k], s.spring_ends[2 * k + 1]
    along, length = line(p.position[one], p.position[other])
    a, b = mobility(p, one), mobility(p, other)
    since = along.dot((p.position[one] - motion.before[one]) - (p.position[other] - motion.before[other]))
    change = _change(
        dt,
        length - s.rest_length[k],
        since,
        s.spring_stiffness[k],
        s.spring_damping[k],
        multipliers.spring_multiplier[k],
        a + b,
    )
    multipliers.spring_multiplier[k] += change
    # Macklin et al. 2016, eq. 17
    p.position[one] += a * change * along
    p.position[other] -= b * change * along


@ti.func
def _project_hinge(
    k: ti.i32, dt: ti.f64, p: ti.template(), a: ti.template(), multipliers: ti.template(), motion: ti.template()
):
    i, j, m, n = a.hinge_points[4 * k], a.hinge_points[4 * k + 1], a.hinge_points[4 * k + 2], a.hinge_points[4 * k + 3]
    hinge = fold(p.position[i], p.position[j], p.position[m], p.position[n])
    wi, wj, wm, wn = mobility(p, i), mobility(p, j), mobility(p, m), mobility(p, n)
    inverse_mass = wi * hinge.p.norm_sqr() + wj * hinge.q.norm_sqr()
    inverse_mass += wm * hinge.r.norm_sqr() + wn * hinge.s.norm_sqr()
    since = hinge.p.dot(p.position[i] - motion.before[i]) + hinge.q.dot(p.position[j] - motion.before[j])
    since += hinge.r.dot(p.position[m] - motion.before[m]) + hinge.s.dot(p.position[n] - motion.before[n])
    over = turned(hinge.angle, a.rest_angle[k])
    change = _change(dt, over, since, a.rigidity[k], a.bend_damping[k], multipliers.hinge_multiplier[k], inverse_mass)
    multipliers.hinge_multiplier[k] += change
    # Macklin et al. 2016, eq. 17
    p.position[i] += wi * change * hinge.p
    p.position[j] += wj * change * hinge.q
    p.position[m] += wm * change * hinge.r
    p.position[n] += wn * change * hinge.s


@ti.kernel
def substeps_alone(
    airy: ti.template(),
    number: ti.i32,
    iterations: ti.i32,
    contact_count: ti.i32,
    sweeps: ti.i32,
    dt: ti.f64,
    recovery: ti.f64,
    cloth: MassSpring,
    multipliers: Multipliers,
    contacts: ProjectedContacts,
    motion: StepMotion,
):
    """All substeps of a step, on one thread: so many `iterations` over springs and hinges, `sweeps` over contacts."""
    ti.loop_config(serialize=True)
    for now in range(number):
        for i in range(cloth.point_count):
            predict_point(airy, i, dt, number - now, cloth.gravity, cloth.wind, cloth, cloth, motion)
        for k in range(cloth.spring_count):
            multipliers.spring_multiplier[k] = 0.0
        for k in range(cloth.hinge_count):
            multipliers.hinge_multiplier[k] = 0.0
        for _iteration in range(iterations):
            for k in range(cloth.spring_count):
                _project_spring(k, dt, cloth, cloth, multipliers, motion)
            for k in range(cloth.hinge_count):
                _project_hinge(k, dt, cloth, cloth, multipliers, motion)
        project_alone(
            cloth.point_count,
            contact_count,
            sweeps,
            number,
            number - now,
            dt,
            recovery,
            cloth,
            contacts,
            motion,
        )
        for i in range(cloth.point_count):
            cloth.velocity[i] = (cloth.position[i] - motion.before[i]) / dt


@ti.kernel
def predict(
    airy: ti.template(),
    points: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    gravity: vec3,
    wind: vec3,
    p: Points,
    d: Drag,
    multipliers: Multipliers,
    motion: StepMotion,
):
    """Take points to where they would go without springs, held ones on towards their targets, and begin with
    multipliers of zero."""
    for i in range(points):
        predict_point(airy, i, dt, left, gravity, wind, p, d, motion)
    for k in range(springs):
        multipliers.spring_multiplier[k] = 0.0
    for k in range(hinges):
        multipliers.hinge_multiplier[k] = 0.0


@ti.kernel
def project_springs(
    first: ti.i32, last: ti.i32, dt: ti.f64, p: Points, s: Springs, multipliers: Multipliers, motion: StepMotion
):
    """Solve the springs of one colour, `first` up to, without, `last` (Macklin et al. 2016, eq. 17)."""
    for k in range(first, last):
        _project_spring(k, dt, p, s, multipliers, motion)


@ti.kernel
def project_hinges(
    first: ti.i32, last: ti.i32, dt: ti.f64, p: Points, a: Hinges, multipliers: Multipliers, motion: StepMotion
):
    """Solve the hinges of one colour, `first` up to, without, `last` (Macklin et al. 2016, eq. 17)."""
    for k in range(first, last):
        _project_hinge(k, dt, p, a, multipliers, motion)


@ti.kernel
def finish(points: ti.i32, dt: ti.f64, p: Points, motion: StepMotion):
    """Velocities [m/s] are the displacements of a substep over its dt [s]."""
    for i in range(points):
        p.velocity[i] = (p.position[i] - motion.before[i]) / dt
