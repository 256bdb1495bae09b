"""Forces of contacts, as implicit Euler looks for them: an augmented Lagrangian (Alart and Curnier 1991).

A contact presses with max(0, press - k gap), and grips with grip - k slip, where press and grip are its forces in the
step before; the grip is cut to the coefficient of friction times the press. So what rests, rests without a gap below
zero and without creeping, whatever k is: Signorini's and Coulomb's laws. In a step all of that follows from one energy,
as the press that friction counts is renewed only when the rest has come to an end (`press_on`).
"""

import taichi as ti

from sim.cloth.layout import Touches
from sim.double import Numbers, vec3

NOTHING = 1e-30
"""A force of friction below this [N] has no direction."""


@ti.func
def carried(c: ti.i32, touch: ti.template(), values: ti.template()) -> vec3:
    """A vector of points where the first side of a contact is, less that of the other side."""
    total = vec3(0.0, 0.0, 0.0)
    for corner in ti.static(range(4)):
        i = touch.touch_corner[4 * c + corner]
        if i >= 0:
            total += touch.touch_weight[c][corner] * values[i]
    return total


@ti.func
def touch_energy(c: ti.i32, touch: ti.template(), start: ti.template(), place: ti.template()) -> ti.f64:
    """Set the force of a contact; returns what it stores [J]."""
    n, k = touch.touch_normal[c], touch.hard[c]
    there = carried(c, touch, place)
    trial = touch.press[c] - k * (n.dot(there) - touch.law[c][0])
    push = ti.max(trial, 0.0)
    energy = 0.5 * (push * push - touch.press[c] * touch.press[c]) / k
    moved = there - carried(c, touch, start)
    grip = touch.grip[c] - k * (moved - n * n.dot(moved))
    size = grip.norm()
    firm, loose = k, k
    slip = vec3(0.0, 0.0, 0.0)
    if size <= touch.law[c][2] * touch.law[c][3] + NOTHING:
        energy += 0.5 * size * size / k
    else:
        most = touch.law[c][1] * touch.law[c][3]
        energy += (most * size - 0.5 * most * most) / k
        slip = grip / size
        grip = most * slip
        firm, loose = k * most / size, ti.cast(0.0, ti.f64)
    touch.touch_force[c] = push * n + grip
    touch.touch_block[c] = vec3(k if trial > 0.0 else 0.0, firm, loose)
    touch.touch_slip[c] = slip
    return energy


@ti.func
def yielding(c: ti.i32, touch: ti.template(), way: vec3) -> vec3:
    """How much less a contact pushes after its sides have moved apart by `way` [m]."""
    n, t, b = touch.touch_normal[c], touch.touch_slip[c], touch.touch_block[c]
    along, slipping = n.dot(way), t.dot(way)
    return b[0] * along * n + b[1] * (way - along * n - slipping * t) + b[2] * slipping * t


@ti.kernel
def harden(touches: ti.i32, points: ti.i32, factor: ti.f64, dt: ti.f64, mass: Numbers, stiff: Numbers, touch: Touches):
    """Set the stiffness with which contacts are looked for: that of the cloth where they are, times a factor."""
    for c in range(touches):
        soft = ti.cast(0.0, ti.f64)
        for corner in ti.static(range(4)):
            i = touch.touch_corner[4 * c + corner]
            if 0 <= i < points:
                w = touch.touch_weight[c][corner]
                soft += w * w / (mass[i] / (dt * dt) + stiff[i])
        touch.hard[c] = factor / ti.max(soft, 1e-30)


@ti.kernel
def press_on(touches: ti.i32, touch: Touches) -> ti.f64:
    """Let friction count the present forces along normals; returns the greatest change of what it allows, over the
    stiffness [m]."""
    most = ti.cast(0.0, ti.f64)
    for c in range(touches):
        push = touch.touch_normal[c].dot(touch.touch_force[c])
        ti.atomic_max(most, touch.law[c][2] * abs(push - touch.law[c][3]) / touch.hard[c])
        touch.law[c][3] = push
    return most


@ti.kernel
def learn(touches: ti.i32, touch: Touches):
    """Take the forces of contacts for known."""
    for c in range(touches):
        n, force = touch.touch_normal[c], touch.touch_force[c]
        push = n.dot(force)
        hold = force - push * n
        size = hold.norm()
        if size > touch.law[c][2] * push + NOTHING:
            hold *= touch.law[c][1] * push / size
        touch.press[c] = push
        touch.grip[c] = hold
