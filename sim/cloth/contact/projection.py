"""Contacts of small steps: what springs and gravity make of one is changed as little as keeps everything apart.

Points go to the nearest places, in the metric of their masses, at which no contact is below its limit. Forces that take
them there are looked for by Jacobi's method, each projected to a push and to Coulomb's cone; every mass is shared among
its contacts, or that would not converge (Tonge et al. 2012). It begins with the forces of the
small step before.
"""

import taichi as ti

from sim.cloth.contact.augmented_lagrangian import NOTHING, led, on_body
from sim.cloth.fabric.layout import Holds, Loose, Pace, Points, Touches, Way
from sim.device.double import Vectors, cross_matrix, vec3


@ti.func
def mobility(p: ti.template(), i: ti.i32) -> ti.f64:
    """One over the mass [1/kg]; 0 of what is held."""
    found = ti.cast(0.0, ti.f64)
    if p.mobile[i]:
        found = 1.0 / p.mass[i]
    return found


@ti.func
def _between(c: ti.i32, points: ti.i32, share: ti.f64, touch: ti.template(), place: ti.template(), w: ti.template()):
    """Where the first side of a contact is, less that of the other [m], after a `share` of the ways of solids."""
    total = vec3(0.0, 0.0, 0.0)
    for corner in ti.static(range(4)):
        i = touch.touch_corner[4 * c + corner]
        if i >= points:
            total += touch.touch_weight[c][corner] * (w.start[i] + share * (w.aims[i] - w.start[i]))
        elif i >= 0:
            total += touch.touch_weight[c][corner] * place[i]
    return total


@ti.func
def _take_part(
    c: ti.i32, points: ti.i32, share: ti.f64, more: vec3, p: ti.template(), touch: ti.template(), w: ti.template()
):
    """Say whether a contact presses, or will, in `touch_block[c][0]`; bodies take its sides apart by `more` [m]."""
    there = _between(c, points, share, touch, p.position, w) + more
    below = touch.touch_normal[c].dot(there) < touch.touch_block[c][1]
    touch.touch_block[c][0] = 1.0 if below or touch.press[c] > 0.0 else 0.0


@ti.func
def _share_out(i: ti.i32, touch: ti.template(), w: ti.template()):
    """Count the contacts of a point that take part."""
    number = ti.cast(0.0, ti.f64)
    for entry in range(touch.first_touch[i], touch.first_touch[i + 1]):
        number += touch.touch_block[touch.of_touch[entry] // 4][0]
    w.shares[i] = number


@ti.func
def _recall(
    c: ti.i32, points: ti.i32, share: ti.f64, more: vec3, prompt: ti.f64, touch: ti.template(), w: ti.template()
):
    """Begin with the force that there was, and remember where the contact was; `prompt`: share of what its limit lacks
    that is made up for at once."""
    n = touch.touch_normal[c]
    before = _between(c, points, share, touch, w.before, w) + more
    limit, was = touch.law[c][0], n.dot(before)
    if was < limit:
        limit = was + prompt * (limit - was)
    touch.touch_trial[c] = before
    touch.touch_block[c] = vec3(0.0, limit, 0.0)
    touch.touch_way[c] = touch.press[c] * n + touch.grip[c]


@ti.func
def _press(
    c: ti.i32,
    points: ti.i32,
    dt: ti.f64,
    share: ti.f64,
    more: vec3,
    give: ti.f64,
    p: ti.template(),
    touch: ti.template(),
    w: ti.template(),
):
    """Change the force of a contact that takes part; bodies take its sides apart by `more` [m], and `give` way to it
    [1/kg]."""
    touch.touch_way[c] = vec3(0.0, 0.0, 0.0)
    soft = give
    for corner in ti.static(range(4)):
        i = touch.touch_corner[4 * c + corner]
        if 0 <= i < points:
            soft += touch.touch_weight[c][corner] ** 2 * w.shares[i] * mobility(p, i)
    if touch.touch_block[c][0] > 0.0 and soft > 0.0:
        n, before, k = touch.touch_normal[c], touch.touch_trial[c], 1.0 / (soft * dt * dt)
        there = _between(c, points, share, touch, p.position, w) + more
        push = ti.max(touch.press[c] - k * (n.dot(there) - touch.touch_block[c][1]), 0.0)
        moved = there - before
        grip = touch.grip[c] - k * (moved - n.dot(moved) * n)
        size = grip.norm()
        if size > touch.law[c][2] * push + NOTHING:
            grip *= touch.law[c][1] * push / size
        touch.touch_way[c] = (push - touch.press[c]) * n + grip - touch.grip[c]
        touch.press[c] = push
        touch.grip[c] = grip


@ti.func
def _give(i: ti.i32, dt: ti.f64, p: ti.template(), touch: ti.template()):
    """Move a point as the changes of forces on it ask."""
    change = vec3(0.0, 0.0, 0.0)
    for entry in range(touch.first_touch[i], touch.first_touch[i + 1]):
        c = touch.of_touch[entry] // 4
        change += touch.touch_weight[c][touch.of_touch[entry] % 4] * touch.touch_way[c]
    p.position[i] += dt * dt * mobility(p, i) * change


@ti.func
def _end(i: ti.i32, dt: ti.f64, p: ti.template(), touch: ti.template(), w: ti.template()):
    if touch.first_touch[i + 1] > touch.first_touch[i]:
        p.velocity[i] = (p.position[i] - w.before[i]) / dt


@ti.func
def keep_apart_alone(
    points: ti.i32,
    touches: ti.i32,
    sweeps: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    prompt: ti.f64,
    p: ti.template(),
    touch: ti.template(),
    w: ti.template(),
):
    """The contacts of one of so many small steps, on one thread, without bodies that give way; `left`: small steps to
    the end of the step."""
    if touches > 0:
        none, alike = ti.cast(0.0, ti.f64), vec3(0.0, 0.0, 0.0)
        share, earlier = _shares(number, left)
        for c in range(touches):
            _recall(c, points, earlier, alike, prompt, touch, w)
        for i in range(points):
            _give(i, dt, p, touch)
        for _sweep in range(sweeps):
            for c in range(touches):
                _take_part(c, points, share, alike, p, touch, w)
            for i in range(points):
                _share_out(i, touch, w)
            for c in range(touches):
                _press(c, points, dt, share, alike, none, p, touch, w)
            for i in range(points):
                _give(i, dt, p, touch)
        for i in range(points):
            _end(i, dt, p, touch, w)
        for c in range(touches):
            _sum_up(c, number, touch)


@ti.func
def _shares(number: ti.i32, left: ti.i32):
    """Of the ways of solids, that are behind them after a small step and before it."""
    whole = ti.cast(number, ti.f64)
    return 1.0 - ti.cast(left - 1, ti.f64) / whole, 1.0 - ti.cast(left, ti.f64) / whole


@ti.func
def _sum_up(c: ti.i32, number: ti.i32, touch: ti.template()):
    touch.touch_force[c] += (touch.press[c] * touch.touch_normal[c] + touch.grip[c]) / ti.cast(number, ti.f64)


@ti.func
def _go_on(row: ti.i32, number: ti.i32, dt: ti.f64, loose: ti.template(), pace: ti.template()):
    """Take a body's row on at its speed, without the forces that it was foreseen with."""
    pace.body_speed[row] += loose.loose_aim[row] / (dt * number * number)
    loose.loose_base[row] = loose.loose_way[row]
    loose.loose_way[row] += dt * pace.body_speed[row]


@ti.func
def _share_out_body(row: ti.i32, touch: ti.template(), holds: ti.template(), pace: ti.template()):
    number = ti.cast(0.0, ti.f64)
    for entry in range(holds.first_hold[row // 2], holds.first_hold[row // 2 + 1]):
        number += touch.touch_block[holds.of_hold[entry] // 2][0]
    pace.body_shares[row] = number


@ti.func
def _gives(c: ti.i32, touch: ti.template(), pace: ti.template()) -> ti.f64:
    """How much bodies give way to a contact at most, each with its share of them [1/kg]."""
    found = ti.cast(0.0, ti.f64)
    for side in ti.static(range(2)):
        k = 2 * c + side
        if touch.touch_body[k] >= 0:
            row, lever = 2 * touch.touch_body[k], cross_matrix(touch.touch_arm[k])
            turning = (lever.transpose() @ pace.body_gives[row + 1] @ lever).trace()
            found += pace.body_shares[row] * (touch.touch_sum[k] ** 2 * pace.body_gives[row][0, 0] + turning)
    return found


@ti.func
def _give_body(
    row: ti.i32, dt: ti.f64, touch: ti.template(), loose: ti.template(), holds: ti.template(), pace: ti.template()
):
    loose.loose_way[row] += dt * dt * pace.body_gives[row] @ on_body(row, touch, holds, touch.touch_way)


@ti.func
def _hurry(c: ti.i32, number: ti.i32, prompt: ti.f64, touch: ti.template()) -> ti.f64:
    """The share of what a limit lacks that is made up for in a small step: of bodies so little that they are not thrown
    by it."""
    found = prompt
    if touch.touch_body[2 * c] >= 0 or touch.touch_body[2 * c + 1] >= 0:
        found = 1.0 / number
    return found


@ti.kernel
def keep_bodies_apart_alone(
    points: ti.i32,
    rows: ti.i32,
    touches: ti.i32,
    sweeps: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    prompt: ti.f64,
    p: Points,
    touch: Touches,
    loose: Loose,
    holds: Holds,
    pace: Pace,
    w: Way,
):
    """The contacts of one of so many small steps, on one thread, with bodies in so many rows."""
    ti.loop_config(serialize=True)
    for _once in range(1):
        share, earlier = _shares(number, left)
        for row in range(rows):
            _go_on(row, number, dt, loose, pace)
        for c in range(touches):
            hurry = _hurry(c, number, prompt, touch)
            _recall(c, points, earlier, led(c, 0, touch, loose.loose_base), hurry, touch, w)
        for i in range(points):
            _give(i, dt, p, touch)
        for row in range(rows):
            _give_body(row, dt, touch, loose, holds, pace)
        for _sweep in range(sweeps):
            for c in range(touches):
                _take_part(c, points, share, led(c, 0, touch, loose.loose_way), p, touch, w)
            for i in range(points):
                _share_out(i, touch, w)
            for row in range(rows):
                _share_out_body(row, touch, holds, pace)
            for c in range(touches):
                more, give = led(c, 0, touch, loose.loose_way), _gives(c, touch, pace)
                _press(c, points, dt, share, more, give, p, touch, w)
            for i in range(points):
                _give(i, dt, p, touch)
            for row in range(rows):
                _give_body(row, dt, touch, loose, holds, pace)
        for i in range(points):
            _end(i, dt, p, touch, w)
        for row in range(rows):
            pace.body_speed[row] = (loose.loose_way[row] - loose.loose_base[row]) / dt
        for c in range(touches):
            _sum_up(c, number, touch)


@ti.kernel
def recall(
    points: ti.i32,
    rows: ti.i32,
    touches: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    prompt: ti.f64,
    p: Points,
    touch: Touches,
    loose: Loose,
    holds: Holds,
    pace: Pace,
    w: Way,
):
    """Begin with the contacts of one of so many small steps, on all threads, with bodies in so many rows."""
    for row in range(rows):
        _go_on(row, number, dt, loose, pace)
    for c in range(touches):
        _share, earlier = _shares(number, left)
        hurry = _hurry(c, number, prompt, touch)
        _recall(c, points, earlier, led(c, 0, touch, loose.loose_base), hurry, touch, w)
    for i in range(points):
        _give(i, dt, p, touch)
    for row in range(rows):
        _give_body(row, dt, touch, loose, holds, pace)


@ti.kernel
def sweep(
    points: ti.i32,
    rows: ti.i32,
    touches: ti.i32,
    number: ti.i32,
    left: ti.i32,
    dt: ti.f64,
    p: Points,
    touch: Touches,
    loose: Loose,
    holds: Holds,
    pace: Pace,
    w: Way,
):
    """One round of Jacobi's method in a small step: contacts change their forces, then points and bodies move by the
    changes."""
    for c in range(touches):
        share, _earlier = _shares(number, left)
        _take_part(c, points, share, led(c, 0, touch, loose.loose_way), p, touch, w)
    for i in range(points):
        _share_out(i, touch, w)
    for row in range(rows):
        _share_out_body(row, touch, holds, pace)
    for c in range(touches):
        share, _earlier = _shares(number, left)
        more, give = led(c, 0, touch, loose.loose_way), _gives(c, touch, pace)
        _press(c, points, dt, share, more, give, p, touch, w)
    for i in range(points):
        _give(i, dt, p, touch)
    for row in range(rows):
        _give_body(row, dt, touch, loose, holds, pace)


@ti.kernel
def end(
    points: ti.i32,
    rows: ti.i32,
    touches: ti.i32,
    number: ti.i32,
    dt: ti.f64,
    p: Points,
    touch: Touches,
    loose: Loose,
    pace: Pace,
    w: Way,
):
    """Velocities over a small step dt [s] of points that have contacts and of bodies, and the step's mean forces of
    contacts."""
    for i in range(points):
        _end(i, dt, p, touch, w)
    for row in range(rows):
        pace.body_speed[row] = (loose.loose_way[row] - loose.loose_base[row]) / dt
    for c in range(touches):
        _sum_up(c, number, touch)


@ti.kernel
def stand(rows: ti.i32, dt: ti.f64, loose: Loose, pace: Pace):
    """Bodies in so many rows begin a step of dt [s] without ways of their own."""
    for row in range(rows):
        pace.body_gives[row] = (dt * dt * loose.loose_block[row]).inverse()
        pace.body_speed[row] = vec3(0.0, 0.0, 0.0)
        loose.loose_way[row] = vec3(0.0, 0.0, 0.0)


@ti.kernel
def forget(touches: ti.i32, touch: Touches):
    """Forget what contacts did."""
    for c in range(touches):
        touch.touch_force[c] = vec3(0.0, 0.0, 0.0)


@ti.kernel
def remember(total: ti.i32, dt: ti.f64, p: Points, speed: Vectors, ahead: Vectors, w: Way):
    """Remember where points are and how fast [m/s], and foresee where they would go at that speed [m]."""
    for i in range(total):
        w.start[i] = p.position[i]
        speed[i] = p.velocity[i]
        ahead[i] = p.position[i] + dt * p.velocity[i]
        if p.mobile[i] == 0:
            ahead[i] = w.aims[i]


@ti.kernel
def shift(points: ti.i32, displacement: Vectors, p: Points):
    """Move points by ways [m]."""
    for i in range(points):
        p.position[i] += displacement[i]


@ti.kernel
def put_back(total: ti.i32, p: Points, speed: Vectors, w: Way):
    """Take points, those of solids too, back to where they were before the step, and to their `speed` then [m/s]."""
    for i in range(total):
        p.position[i] = w.start[i]
        p.velocity[i] = speed[i]


@ti.kernel
def carry_solids(points: ti.i32, total: ti.i32, dt: ti.f64, p: Points, w: Way):
    """Put the points of solids, behind the cloth's, at their aims, with the velocities of that way over dt [s]."""
    for i in range(points, total):
        p.velocity[i] = (w.aims[i] - w.start[i]) / dt
        p.position[i] = w.aims[i]
