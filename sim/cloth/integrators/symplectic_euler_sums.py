"""Steps of symplectic Euler."""

from typing import Any

from sim.cloth.contact.projection import project_alone
from sim.cloth.fabric.air_drag import braked
from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import MassSpring, ProjectedContacts, StepMotion
from sim.cloth.fabric.springs import line
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors

ElementForces: Any = argpack(
    tension=Vectors,
    moment=Numbers,
    angle_gradient=Vectors,
)
"""Tensions of springs [N], and moments [N m] and gradients of the angles [1/m] of hinges."""


@ti.func
def _pull(k: ti.i32, cloth: ti.template(), elements: ti.template()):
    one, other = cloth.spring_ends[2 * k], cloth.spring_ends[2 * k + 1]
    along, length = line(cloth.position[one], cloth.position[other])
    tension = cloth.spring_stiffness[k] * (length - cloth.rest_length[k])
    tension += cloth.spring_damping[k] * along.dot(cloth.velocity[one] - cloth.velocity[other])
    elements.tension[k] = tension * along


@ti.func
def _bend(k: ti.i32, cloth: ti.template(), elements: ti.template()):
    p, q = cloth.hinge_points[4 * k], cloth.hinge_points[4 * k + 1]
    r, s = cloth.hinge_points[4 * k + 2], cloth.hinge_points[4 * k + 3]
    hinge = fold(cloth.position[p], cloth.position[q], cloth.position[r], cloth.position[s])
    rate = hinge.p.dot(cloth.velocity[p]) + hinge.q.dot(cloth.velocity[q])
    rate += hinge.r.dot(cloth.velocity[r]) + hinge.s.dot(cloth.velocity[s])
    turn = turned(hinge.angle, cloth.rest_angle[k])
    elements.moment[k] = cloth.rigidity[k] * turn + cloth.bend_damping[k] * rate
    elements.angle_gradient[4 * k] = hinge.p
    elements.angle_gradient[4 * k + 1] = hinge.q
    elements.angle_gradient[4 * k + 2] = hinge.r
    elements.angle_gradient[4 * k + 3] = hinge.s


@ti.func
def _advance(
    airy: ti.template(),
    i: ti.i32,
    dt: ti.f64,
    left: ti.i32,
    cloth: ti.template(),
    elements: ti.template(),
    motion: ti.template(),
):
    """v += dt f / m, then x += dt v; a held point goes its share of the way to its target."""
    motion.before[i] = cloth.position[i]
    if cloth.mobile[i]:
        force = cloth.mass[i] * cloth.gravity
        for entry in range(cloth.first_spring[i], cloth.first_spring[i + 1]):
            end = cloth.of_spring[entry] % 2
            force -= ti.cast(1 - 2 * end, ti.f64) * elements.tension[cloth.of_spring[entry] // 2]
        for entry in range(cloth.first_hinge[i], cloth.first_hinge[i + 1]):
            force -= elements.moment[cloth.of_hinge[entry] // 4] * elements.angle_gradient[cloth.of_hinge[entry]]
        momentum = cloth.mass[i] * cloth.velocity[i] + dt * force
        if ti.static(airy):
            cloth.velocity[i] = braked(i, cloth.mass[i], dt, momentum, cloth.wind, cloth)
        else:
            cloth.velocity[i] = momentum / cloth.mass[i]
        cloth.position[i] += dt * cloth.velocity[i]
    else:
        displacement = (motion.target[i] - cloth.position[i]) / ti.cast(left, ti.f64)
        cloth.velocity[i] = displacement / dt
        cloth.position[i] += displacement


@ti.kernel
def step(
    alone: ti.template(),
    airy: ti.template(),
    number: ti.i32,
    left: ti.i32,
    contact_count: ti.i32,
    sweeps: ti.i32,
    dt: ti.f64,
    recovery: ti.f64,
    cloth: MassSpring,
    elements: ElementForces,
    contacts: ProjectedContacts,
    motion: StepMotion,
):
    """One small step on all threads without contacts, or so many with them `alone` on one; `left`: small steps to the
    time at which held points are at their targets."""
    if ti.static(alone):
        ti.loop_config(serialize=True)
        for now in range(number):
            for k in range(cloth.spring_count):
                _pull(k, cloth, elements)
            for k in range(cloth.hinge_count):
                _bend(k, cloth, elements)
            for i in range(cloth.point_count):
                _advance(airy, i, dt, left - now, cloth, elements, motion)
            project_alone(
                cloth.point_count,
                contact_count,
                sweeps,
                number,
                left - now,
                dt,
                recovery,
                cloth,
                contacts,
                motion,
            )
    else:
        for k in range(cloth.spring_count):
            _pull(k, cloth, elements)
        for k in range(cloth.hinge_count):
            _bend(k, cloth, elements)
        for i in range(cloth.point_count):
            _advance(airy, i, dt, left, cloth, elements, motion)
