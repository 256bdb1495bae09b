"""Where points are tried in a step of implicit Euler: from where it starts to where it ends."""

from typing import Any

from sim.cloth.fabric.bending import fold
from sim.cloth.fabric.layout import MassSpring, Points
from sim.cloth.fabric.springs import line
from sim.device.argument_packs import argpack
from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors

Trial: Any = argpack(
    start=Vectors,
    predicted=Vectors,
    base=Vectors,
    place=Vectors,
    length_before=Numbers,
    angle_before=Numbers,
)
"""Where points were, are predicted to go without springs, were tried before, and are tried [m]; lengths [m] and angles
[rad] before the step."""


@ti.func
def hinge_fold(k: ti.i32, cloth: ti.template(), place: ti.template()):
    """The angle of a hinge and its gradients for places of points."""
    p, q = cloth.hinge_points[4 * k], cloth.hinge_points[4 * k + 1]
    r, s = cloth.hinge_points[4 * k + 2], cloth.hinge_points[4 * k + 3]
    return fold(place[p], place[q], place[r], place[s])


@ti.kernel
def begin(
    total: ti.i32,
    dt: ti.f64,
    falls: Numbers,
    now: ti.f64,
    ago: ti.f64,
    position_before: Vectors,
    velocity_before: Vectors,
    cloth: MassSpring,
    t: Trial,
) -> ti.i32:
    """Remember the start, and try the positions of steady motion, or of a free fall for points that are said to do so
    (1 or 0); held points, and those of solids after the cloth's, `total` with them, are in `place` already. `now` and
    `ago`: weights of what points do, and did a step before, in where they start
    (`sim.cloth.integrators.backward_differences`). Returns whether a spring would turn by more than a right angle."""
    for i in range(total):
        x, v = cloth.position[i], cloth.velocity[i]
        if i < cloth.point_count and ago > 0.0:
            x = now * x - ago * position_before[i]
            v = now * v - ago * velocity_before[i]
        t.start[i] = x
        if cloth.mobile[i]:
            t.predicted[i] = x + dt * (v + dt * cloth.gravity)
            t.place[i] = x + dt * (v + falls[i] * dt * cloth.gravity)
    turning = 0
    for k in range(cloth.spring_count):
        one, other = cloth.spring_ends[2 * k], cloth.spring_ends[2 * k + 1]
        along, length = line(t.start[one], t.start[other])
        t.length_before[k] = length
        if along.dot(t.place[one] - t.place[other]) < 0.0:
            ti.atomic_max(turning, 1)
    for k in range(cloth.hinge_count):
        t.angle_before[k] = hinge_fold(k, cloth, t.start).angle
    return turning


@ti.kernel
def stay(points: ti.i32, p: Points, t: Trial):
    """Try the places of the start."""
    for i in range(points):
        if p.mobile[i]:
            t.place[i] = t.start[i]


@ti.kernel
def add_load(points: ti.i32, dt: ti.f64, p: Points, load: Vectors, t: Trial):
    """Let forces on points [N] act in the step besides gravity."""
    for i in range(points):
        if p.mobile[i]:
            t.predicted[i] += dt * dt / p.mass[i] * load[i]


@ti.kernel
def shift(points: ti.i32, dt: ti.f64, acceleration: Vectors, t: Trial):
    """Move points by what an acceleration [m/s^2] does in a step."""
    for i in range(points):
        t.place[i] += dt * dt * acceleration[i]


@ti.kernel
def finish(
    points: ti.i32,
    total: ti.i32,
    dt: ti.f64,
    since: ti.f64,
    position_before: Vectors,
    velocity_before: Vectors,
    p: Points,
    t: Trial,
):
    """Take the places tried, and remember the step; `since`: the time in which points came there from their start."""
    for i in range(total):
        if i < points:
            position_before[i] = p.position[i]
            velocity_before[i] = p.velocity[i]
        p.velocity[i] = (t.place[i] - t.start[i]) / ti.select(i < points, since, dt)
        p.position[i] = t.place[i]


@ti.kernel
def accelerate(points: ti.i32, dt: ti.f64, acceleration: Vectors, p: Points):
    """Change velocities by what an acceleration [m/s^2] does in a step."""
    for i in range(points):
        p.velocity[i] += dt * acceleration[i]
