"""Forces of contacts, as implicit Euler looks for them: an augmented Lagrangian (Alart & Curnier 1991).

A contact presses with max(0, press - k gap), and grips with grip - k slip, where press and grip are its forces in the
step before; the grip is cut to the coefficient of friction times the press. So what rests, rests without a gap below
zero and without creeping, whatever k is: Signorini's and Coulomb's laws. In a step all of that follows from one energy,
as the press that friction counts is renewed only when the rest has come to an end (`press_on`).
"""

import taichi as ti

from sim.cloth.fabric.layout import Loose, Touches
from sim.device.double import Numbers, Vectors, vec3

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
def led(c: ti.i32, first: ti.i32, touch: ti.template(), values: ti.template()) -> vec3:
    """By how much bodies take the sides of a contact apart; their ways and turns are `values` from `first` on."""
    total = vec3(0.0, 0.0, 0.0)
    for side in ti.static(range(2)):
        k = 2 * c + side
        if touch.touch_body[k] >= 0:
            row = first + 2 * touch.touch_body[k]
            total += touch.touch_sum[k] * values[row] + values[row + 1].cross(touch.touch_arm[k])
    return total


@ti.func
def parted(c: ti.i32, points: ti.i32, touch: ti.template(), values: ti.template()) -> vec3:
    """How far ways of points, and of bodies in the rows after them, take the sides of a contact apart."""
    total = led(c, points, touch, values)
    for corner in ti.static(range(4)):
        i = touch.touch_corner[4 * c + corner]
        if 0 <= i < points:
            total += touch.touch_weight[c][corner] * values[i]
    return total


@ti.func
def on_body(row: ti.i32, touch: ti.template(), holds: ti.template(), values: ti.template()) -> vec3:
    """What vectors of contacts add up to on a row of a body: forces, or torques about its centre of mass."""
    total = vec3(0.0, 0.0, 0.0)
    for entry in range(holds.first_hold[row // 2], holds.first_hold[row // 2 + 1]):
        k = holds.of_hold[entry]
        if row % 2 == 0:
            total += touch.touch_sum[k] * values[k // 2]
        else:
            total += touch.touch_arm[k].cross(values[k // 2])
    return total


@ti.func
def most_grip(c: ti.i32, touch: ti.template()) -> ti.f64:
    """How much a contact can grip [N], by the force along the normal that friction counts."""
    bound = touch.law[c][1]
    if touch.touch_block[c][2] > 0.0:
        bound = touch.law[c][2]
    return bound * touch.law[c][3]


@ti.func
def pressed(c: ti.i32, touch: ti.template(), trial: vec3) -> vec3:
    """The force that the laws of contact leave of a trial: a push, and a grip in the cone that holds for now."""
    n = touch.touch_normal[c]
    along = n.dot(trial)
    force, most = ti.max(along, 0.0) * n, most_grip(c, touch)
    if most > 0.0:
        grip = trial - along * n
        size = grip.norm()
        if size > most + NOTHING:
            grip *= most / size
        force += grip
    return force


@ti.func
def works(c: ti.i32, touch: ti.template(), trial: vec3, displacement: vec3):
    """What a contact at a trial does along a way [J], and how much less for each way more that it has gone."""
    n, k = touch.touch_normal[c], touch.hard[c]
    along, pace, most = n.dot(trial), n.dot(displacement), most_grip(c, touch)
    work, less = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    if along > 0.0:
        work += along * pace
        less += k * pace * pace
    if most > 0.0:
        grip, across = trial - along * n, displacement - pace * n
        size, done = grip.norm(), grip.dot(across)
        if size > most + NOTHING:
            work += most / size * done
            less += k * most / size * (across.norm_sqr() - (done / size) ** 2)
        else:
            work += done
            less += k * across.norm_sqr()
    return work, less


@ti.func
def touch_energy(
    c: ti.i32, touch: ti.template(), start: ti.template(), place: ti.template(), displacement: ti.template()
) -> ti.f64:
    """Set the force of a contact; returns what it stores [J]. `displacement`: of bodies, besides the places of their
    points."""
    n, k = touch.touch_normal[c], touch.hard[c]
    there = carried(c, touch, place) + led(c, 0, touch, displacement)
    moved = there - carried(c, touch, start)
    grip = touch.grip[c] - k * moved
    grip -= n.dot(grip) * n
    push = touch.press[c] - k * (n.dot(there) - touch.law[c][0])
    size, most = grip.norm(), touch.law[c][1] * touch.law[c][3]
    firm, loose = k, k
    energy = 0.5 * (ti.max(push, 0.0) ** 2 - touch.press[c] * touch.press[c]) / k
    if size <= touch.law[c][2] * touch.law[c][3] + NOTHING:
        energy += 0.5 * size * size / k
    else:
        energy += (most * size - 0.5 * most * most) / k
        firm, loose = k * most / size, ti.cast(0.0, ti.f64)
    touch.touch_trial[c] = push * n + grip
    touch.touch_block[c] = vec3(k if push > 0.0 else 0.0, firm, loose)
    touch.touch_force[c] = pressed(c, touch, touch.touch_trial[c])
    return energy


@ti.func
def slipping(c: ti.i32, touch: ti.template()) -> vec3:
    """The direction in which a contact grips; zero where it does not."""
    n, trial = touch.touch_normal[c], touch.touch_trial[c]
    grip = trial - n.dot(trial) * n
    size, found = grip.norm(), vec3(0.0, 0.0, 0.0)
    if size > NOTHING:
        found = grip / size
    return found


@ti.func
def yielding(c: ti.i32, touch: ti.template(), displacement: vec3) -> vec3:
    """How much less a contact pushes after its sides have moved apart by `displacement` [m], if it goes on as it
    does."""
    n, t, b = touch.touch_normal[c], slipping(c, touch), touch.touch_block[c]
    along, sliding = n.dot(displacement), t.dot(displacement)
    return b[0] * along * n + b[1] * (displacement - along * n - sliding * t) + b[2] * sliding * t


@ti.kernel
def wake(touches: ti.i32, reach: ti.f64, touch: Touches):
    """Say which contacts press or grip, or would if their sides came nearer by `reach` [m]."""
    for c in range(touches):
        along = touch.touch_normal[c].dot(touch.touch_trial[c])
        touch.awake[c] = int(along > -reach * touch.hard[c] or most_grip(c, touch) > 0.0)
        if not touch.awake[c]:
            touch.touch_way[c] = vec3(0.0, 0.0, 0.0)


@ti.kernel
def harden(
    touches: ti.i32,
    points: ti.i32,
    inertias: ti.f64,
    springs: ti.f64,
    sinking: ti.f64,
    borne: ti.f64,
    dt: ti.f64,
    mass: Numbers,
    stiff: Numbers,
    thick: Numbers,
    touch: Touches,
    loose: Loose,
):
    """Set the stiffness with which contacts are looked for: so many times the inertia of their points in a step, or of
    the mass of bodies that each has to bear [kg]; or such that the force that is known of would let them sink by a
    share of their thickness, but not more than so many times that of springs and inertia there.

    Forces that go on from step to step follow what is sunk: with less stiffness than the inertia of all that they bear
    they come too late, and what lies there is thrown up."""
    for c in range(touches):
        heavy, soft = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        for corner in ti.static(range(4)):
            i = touch.touch_corner[4 * c + corner]
            if 0 <= i < points:
                inertia, squared = mass[i] / (dt * dt), touch.touch_weight[c][corner] ** 2
                heavy += squared / inertia
                soft += squared / (inertia + stiff[i])
        for side in ti.static(range(2)):
            body = touch.touch_body[2 * c + side]
            if body >= 0:
                give = touch.touch_sum[2 * c + side] ** 2 / loose.loose_block[2 * body][0, 0]
                heavy += give
                soft += give
        least, most = inertias / ti.max(heavy, 1e-30), springs / ti.max(soft, 1e-30)
        least = ti.max(least, inertias * borne / (dt * dt))
        touch.hard[c] = ti.max(least, ti.min(touch.press[c] / (sinking * thick[c]), most))


@ti.kernel
def count_astray(
    touches: ti.i32, both: ti.i32, share: ti.f64, thick: Numbers, touch: Touches, place: Vectors
) -> ti.i32:
    """How many contacts lack more than a share of their thickness, or, of `both`, press from as far."""
    found = 0
    for c in range(touches):
        n = touch.touch_normal[c]
        over = n.dot(carried(c, touch, place)) - touch.law[c][0]
        if over < -share * thick[c] or (both and over > share * thick[c] and n.dot(touch.touch_force[c]) > 0.0):
            found += 1
    return found


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
