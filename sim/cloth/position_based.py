"""The parts of a substep of extended position-based dynamics."""

import taichi as ti

from sim.cloth.explicit import braked
from sim.cloth.hinges import fold, turned
from sim.cloth.layout import Angles, Points, Strands
from sim.cloth.springs import line
from sim.double import Numbers, Vectors, vec3


@ti.kernel
def foresee(
    airy: ti.template(),
    points: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    gravity: vec3,
    wind: vec3,
    p: Points,
    place: Vectors,
    face: Vectors,
    drag_across: Numbers,
    drag_along: Numbers,
    before: Vectors,
    pull: Numbers,
    moment: Numbers,
):
    """Where points would go without springs; `left`: substeps to the time at which held points are in `place`."""
    for i in range(points):
        x = p.position[i]
        before[i] = x
        if p.mobile[i]:
            v = p.velocity[i] + dt * gravity
            if ti.static(airy):
                momentum, held_back = braked(p.mass[i], dt, p.mass[i] * v, wind, face[i], drag_across[i], drag_along[i])
                v = held_back @ momentum
            p.position[i] = x + dt * v
        else:
            p.position[i] = x + (place[i] - x) / ti.cast(left, ti.f64)
    for k in range(springs):
        pull[k] = 0.0
    for k in range(hinges):
        moment[k] = 0.0


@ti.func
def _mobility(p: ti.template(), i: ti.i32) -> ti.f64:
    found = ti.cast(0.0, ti.f64)
    if p.mobile[i]:
        found = 1.0 / p.mass[i]
    return found


@ti.func
def _change(dt: ti.f64, over: ti.f64, since: ti.f64, stiff: ti.f64, damp: ti.f64, had: ti.f64, mobility: ti.f64):
    """Of a multiplier: equation 26 of Macklin et al. 2016, times the stiffness."""
    soft = 1.0 / (dt * dt)
    slow = damp / dt
    return -(stiff * over + soft * had + slow * since) / ((stiff + slow) * mobility + soft)


@ti.kernel
def project_springs(first: ti.i32, last: ti.i32, dt: ti.f64, p: Points, s: Strands, before: Vectors, pull: Numbers):
    for k in range(first, last):
        one, other = s.ends[2 * k], s.ends[2 * k + 1]
        along, length = line(p.position[one], p.position[other])
        a, b = _mobility(p, one), _mobility(p, other)
        since = along.dot((p.position[one] - before[one]) - (p.position[other] - before[other]))
        change = _change(dt, length - s.rest[k], since, s.stiff[k], s.damp[k], pull[k], a + b)
        pull[k] += change
        p.position[one] += a * change * along
        p.position[other] -= b * change * along


@ti.kernel
def project_hinges(first: ti.i32, last: ti.i32, dt: ti.f64, p: Points, a: Angles, before: Vectors, moment: Numbers):
    for k in range(first, last):
        i, j, m, n = a.corners[4 * k], a.corners[4 * k + 1], a.corners[4 * k + 2], a.corners[4 * k + 3]
        hinge = fold(p.position[i], p.position[j], p.position[m], p.position[n])
        wi, wj, wm, wn = _mobility(p, i), _mobility(p, j), _mobility(p, m), _mobility(p, n)
        mobility = wi * hinge.p.norm_sqr() + wj * hinge.q.norm_sqr()
        mobility += wm * hinge.r.norm_sqr() + wn * hinge.s.norm_sqr()
        since = hinge.p.dot(p.position[i] - before[i]) + hinge.q.dot(p.position[j] - before[j])
        since += hinge.r.dot(p.position[m] - before[m]) + hinge.s.dot(p.position[n] - before[n])
        over = turned(hinge.angle, a.rest_angle[k])
        change = _change(dt, over, since, a.rigid[k], a.bend_damp[k], moment[k], mobility)
        moment[k] += change
        p.position[i] += wi * change * hinge.p
        p.position[j] += wj * change * hinge.q
        p.position[m] += wm * change * hinge.r
        p.position[n] += wn * change * hinge.s


@ti.kernel
def finish(points: ti.i32, dt: ti.f64, p: Points, before: Vectors):
    for i in range(points):
        p.velocity[i] = (p.position[i] - before[i]) / dt
