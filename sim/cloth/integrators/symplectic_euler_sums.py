"""Steps of symplectic Euler."""

from typing import Any

import taichi as ti

from sim.cloth.contact.projection import keep_apart_alone
from sim.cloth.fabric.air_drag import braked
from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import Angles, Drag, Points, Strands, Touches, Way
from sim.cloth.fabric.springs import line
from sim.device.double import Numbers, Vectors, vec3

Workspace: Any = ti.types.argpack(
    pull=Vectors,
    bending=Numbers,
    leaning=Vectors,
)
"""Pulls of springs [N], and moments [N m] and slopes [1/m] of hinges."""


@ti.func
def _pull(k: ti.i32, p: ti.template(), s: ti.template(), pull: ti.template()):
    one, other = s.ends[2 * k], s.ends[2 * k + 1]
    along, length = line(p.position[one], p.position[other])
    tension = s.stiff[k] * (length - s.rest[k])
    tension += s.damp[k] * along.dot(p.velocity[one] - p.velocity[other])
    pull[k] = tension * along


@ti.func
def _bend(k: ti.i32, p: ti.template(), a: ti.template(), moment: ti.template(), slope: ti.template()):
    c = ti.Vector([a.corners[4 * k], a.corners[4 * k + 1], a.corners[4 * k + 2], a.corners[4 * k + 3]])
    hinge = fold(p.position[c[0]], p.position[c[1]], p.position[c[2]], p.position[c[3]])
    rate = hinge.p.dot(p.velocity[c[0]]) + hinge.q.dot(p.velocity[c[1]])
    rate += hinge.r.dot(p.velocity[c[2]]) + hinge.s.dot(p.velocity[c[3]])
    moment[k] = a.rigid[k] * turned(hinge.angle, a.rest_angle[k]) + a.bend_damp[k] * rate
    slope[4 * k] = hinge.p
    slope[4 * k + 1] = hinge.q
    slope[4 * k + 2] = hinge.r
    slope[4 * k + 3] = hinge.s


@ti.func
def _go(
    airy: ti.template(),
    i: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    gravity: vec3,
    wind: vec3,
    p: ti.template(),
    s: ti.template(),
    a: ti.template(),
    d: ti.template(),
    e: ti.template(),
    w: ti.template(),
):
    w.before[i] = p.position[i]
    if p.mobile[i]:
        force = p.mass[i] * gravity
        for entry in range(s.first_spring[i], s.first_spring[i + 1]):
            end = s.of_spring[entry] % 2
            force -= ti.cast(1 - 2 * end, ti.f64) * e.pull[s.of_spring[entry] // 2]
        for entry in range(a.first_hinge[i], a.first_hinge[i + 1]):
            force -= e.bending[a.of_hinge[entry] // 4] * e.leaning[a.of_hinge[entry]]
        momentum = p.mass[i] * p.velocity[i] + dt * force
        if ti.static(airy):
            p.velocity[i] = braked(i, p.mass[i], dt, momentum, wind, d)
        else:
            p.velocity[i] = momentum / p.mass[i]
        p.position[i] += dt * p.velocity[i]
    else:
        displacement = (w.aims[i] - p.position[i]) / ti.cast(left, ti.f64)
        p.velocity[i] = displacement / dt
        p.position[i] += displacement


@ti.kernel
def step(
    alone: ti.template(),
    airy: ti.template(),
    number: ti.i32,
    left: ti.i32,
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
    e: Workspace,
    touch: Touches,
    w: Way,
):
    """One small step on all threads without contacts, or so many with them `alone` on one; `left`: small steps to the
    time at which held points are at their aims."""
    if ti.static(alone):
        ti.loop_config(serialize=True)
        for now in range(number):
            for k in range(springs):
                _pull(k, p, s, e.pull)
            for k in range(hinges):
                _bend(k, p, a, e.bending, e.leaning)
            for i in range(points):
                _go(airy, i, dt, left - now, gravity, wind, p, s, a, d, e, w)
            keep_apart_alone(points, touches, projections, number, left - now, dt, prompt, p, touch, w)
    else:
        for k in range(springs):
            _pull(k, p, s, e.pull)
        for k in range(hinges):
            _bend(k, p, a, e.bending, e.leaning)
        for i in range(points):
            _go(airy, i, dt, left, gravity, wind, p, s, a, d, e, w)
