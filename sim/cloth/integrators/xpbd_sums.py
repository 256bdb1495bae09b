"""The parts of a substep of extended position-based dynamics."""

from typing import Any

import taichi as ti

from sim.cloth.contact.projection import keep_apart_alone, mobility
from sim.cloth.fabric.air_drag import braked
from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import Angles, Drag, Points, Strands, Touches, Way
from sim.cloth.fabric.springs import line
from sim.device.double import Numbers, vec3

Guess: Any = ti.types.argpack(pulled=Numbers, bent=Numbers)
"""Multipliers of springs and hinges."""


@ti.func
def _change(dt: ti.f64, over: ti.f64, since: ti.f64, stiff: ti.f64, damp: ti.f64, had: ti.f64, ease: ti.f64):
    """Of a multiplier: Macklin et al. 2016, eq. 26, times the stiffness."""
    soft = 1.0 / (dt * dt)
    slow = damp / dt
    return -(stiff * over + soft * had + slow * since) / ((stiff + slow) * ease + soft)


@ti.func
def _foresee(
    airy: ti.template(),
    i: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    gravity: vec3,
    wind: vec3,
    p: ti.template(),
    d: ti.template(),
    w: ti.template(),
):
    """Where a point would go without springs; `left`: substeps to the time at which held points are at their aims."""
    x = p.position[i]
    w.before[i] = x
    if p.mobile[i]:
        v = p.velocity[i] + dt * gravity
        if ti.static(airy):
            v = braked(i, p.mass[i], dt, p.mass[i] * v, wind, d)
        p.position[i] = x + dt * v
    else:
        p.position[i] = x + (w.aims[i] - x) / ti.cast(left, ti.f64)


@ti.func
def _project_spring(k: ti.i32, dt: ti.f64, p: ti.template(), s: ti.template(), g: ti.template(), w: ti.template()):
    one, other = s.ends[2 * k], s.ends[2 * k + 1]
    along, length = line(p.position[one], p.position[other])
    a, b = mobility(p, one), mobility(p, other)
    since = along.dot((p.position[one] - w.before[one]) - (p.position[other] - w.before[other]))
    change = _change(dt, length - s.rest[k], since, s.stiff[k], s.damp[k], g.pulled[k], a + b)
    g.pulled[k] += change
    # Macklin et al. 2016, eq. 17
    p.position[one] += a * change * along
    p.position[other] -= b * change * along


@ti.func
def _project_hinge(k: ti.i32, dt: ti.f64, p: ti.template(), a: ti.template(), g: ti.template(), w: ti.template()):
    i, j, m, n = a.corners[4 * k], a.corners[4 * k + 1], a.corners[4 * k + 2], a.corners[4 * k + 3]
    hinge = fold(p.position[i], p.position[j], p.position[m], p.position[n])
    wi, wj, wm, wn = mobility(p, i), mobility(p, j), mobility(p, m), mobility(p, n)
    ease = wi * hinge.p.norm_sqr() + wj * hinge.q.norm_sqr()
    ease += wm * hinge.r.norm_sqr() + wn * hinge.s.norm_sqr()
    since = hinge.p.dot(p.position[i] - w.before[i]) + hinge.q.dot(p.position[j] - w.before[j])
    since += hinge.r.dot(p.position[m] - w.before[m]) + hinge.s.dot(p.position[n] - w.before[n])
    over = turned(hinge.angle, a.rest_angle[k])
    change = _change(dt, over, since, a.rigid[k], a.bend_damp[k], g.bent[k], ease)
    g.bent[k] += change
    # Macklin et al. 2016, eq. 17
    p.position[i] += wi * change * hinge.p
    p.position[j] += wj * change * hinge.q
    p.position[m] += wm * change * hinge.r
    p.position[n] += wn * change * hinge.s


@ti.kernel
def substeps_alone(
    airy: ti.template(),
    number: ti.i32,
    sweeps: ti.i32,
    points: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    touches: ti.i32,
    projections: ti.i32,
    dt: ti.f64,
    prompt: ti.f64,
    gravity: vec3,
    wind: vec3,
    p: Points,
    s: Strands,
    a: Angles,
    d: Drag,
    g: Guess,
    touch: Touches,
    w: Way,
):
    """All substeps of a step, on one thread."""
    ti.loop_config(serialize=True)
    for now in range(number):
        for i in range(points):
            _foresee(airy, i, dt, number - now, gravity, wind, p, d, w)
        for k in range(springs):
            g.pulled[k] = 0.0
        for k in range(hinges):
            g.bent[k] = 0.0
        for _sweep in range(sweeps):
            for k in range(springs):
                _project_spring(k, dt, p, s, g, w)
            for k in range(hinges):
                _project_hinge(k, dt, p, a, g, w)
        keep_apart_alone(points, touches, projections, number, number - now, dt, prompt, p, touch, w)
        for i in range(points):
            p.velocity[i] = (p.position[i] - w.before[i]) / dt


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
    g: Guess,
    w: Way,
):
    """Take points to where they would go without springs, held ones on towards their aims, and begin with multipliers
    of zero."""
    for i in range(points):
        _foresee(airy, i, dt, left, gravity, wind, p, d, w)
    for k in range(springs):
        g.pulled[k] = 0.0
    for k in range(hinges):
        g.bent[k] = 0.0


@ti.kernel
def project_springs(first: ti.i32, last: ti.i32, dt: ti.f64, p: Points, s: Strands, g: Guess, w: Way):
    """Solve the springs of one colour, `first` up to, without, `last` (Macklin et al. 2016, eq. 17)."""
    for k in range(first, last):
        _project_spring(k, dt, p, s, g, w)


@ti.kernel
def project_hinges(first: ti.i32, last: ti.i32, dt: ti.f64, p: Points, a: Angles, g: Guess, w: Way):
    """Solve the hinges of one colour, `first` up to, without, `last` (Macklin et al. 2016, eq. 17)."""
    for k in range(first, last):
        _project_hinge(k, dt, p, a, g, w)


@ti.kernel
def finish(points: ti.i32, dt: ti.f64, p: Points, w: Way):
    """Velocities [m/s] are the ways of a substep over its dt [s]."""
    for i in range(points):
        p.velocity[i] = (p.position[i] - w.before[i]) / dt
