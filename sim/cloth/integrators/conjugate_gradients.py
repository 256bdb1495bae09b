"""Conjugate gradients for a step of Newton's method, in which contacts close, open, grip and slide as the laws say.

What is minimised is quadratic but for contacts, whose energies are convex: the residual is that of the energy itself,
the way along a course is where its slope ends, and courses follow Polak and Ribiere (Nocedal & Wright 2006, sec.
5.2). Without contacts, or where contacts go on as they do, that is the linear method. Blocks of the diagonal are the
preconditioner. Small cloths are solved by one thread in one launch: threads would wait for one another most of the
time.
"""

import taichi as ti

from sim.cloth.contact.augmented_lagrangian import on_body, parted, pressed, works, yielding
from sim.cloth.fabric.layout import ROWS, Holds, Loose, Points, Rows, Touches
from sim.cloth.integrators.newton_sums import (
    BEND,
    DOWN,
    HIGH,
    LOW,
    NOW,
    SETTLED,
    SHARE,
    SLOPE_HIGH,
    SLOPE_LOW,
    System,
    add_range,
    add_ranges,
    turn,
)
from sim.device.double import vec3

AT_ONCE = 4
"""Iterations in one launch."""
TRIES, TRIES_ALONE = 3, 20
"""To find how far to go along a course, after the first: friction turns round within a hair's breadth, and threads that
share the work pay for each."""
FLAT = 0.1
"""Of the slope of the energy at the start of a course, so much may be left at its end."""
FAR = 1e30
"""No share of a course is as large."""


@ti.func
def _bend(
    i: ti.i32, points: ti.i32, p: ti.template(), loose: ti.template(), rows: ti.template(), e: ti.template()
) -> vec3:
    """How much force on a row, but for contacts, changes along the course; returns what that does to the energy."""
    q = vec3(0.0, 0.0, 0.0)
    if i >= points:
        q = loose.loose_block[i - points] @ e.course[i]
    elif p.mobile[i]:
        # Springs and hinges feel differences: what moves as a whole does not push itself, whatever their stiffness.
        own = e.course[i]
        q = rows.alone_block[i] @ own
        for k in range(rows.first_block[i], rows.first_block[i + 1]):
            q += rows.off_block[k] @ (e.course[rows.column[k]] - own)
    e.bent[i] = q
    return vec3(0.0, q.dot(e.course[i]), 0.0)


@ti.func
def _slope(linear: ti.template(), c: ti.i32, touch: ti.template(), e: ti.template()) -> vec3:
    """What a contact does to the slope of the energy after a share of the course: that it takes away, and by how much
    it bends."""
    down, bend = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    if touch.awake[c]:
        displacement, share = touch.touch_way[c], e.scalar[SHARE]
        if ti.static(linear):
            bend = displacement.dot(yielding(c, touch, displacement))
            down = -share * bend
        else:
            work, less = works(c, touch, touch.touch_trial[c] - share * touch.hard[c] * displacement, displacement)
            down, bend = work - displacement.dot(touch.touch_force[c]), less
    return vec3(down, bend, 0.0)


@ti.func
def _choose(touching: vec3, e: ti.template()):
    """The next share to try, by Newton's method on the slope, or, where that leads out, by the secant between those
    known to be too small and too large, the slope at the end that stays halved (Illinois); or settle for this one."""
    share = e.scalar[SHARE]
    down = e.scalar[DOWN] - share * e.scalar[BEND] + touching[0]
    bend = e.scalar[BEND] + touching[1]
    if abs(down) <= FLAT * e.scalar[DOWN]:
        e.scalar[SETTLED] = 1.0
    else:
        if down > 0.0:
            e.scalar[LOW] = share
            e.scalar[SLOPE_LOW] = down
            e.scalar[SLOPE_HIGH] *= 0.5
        else:
            e.scalar[HIGH] = share
            e.scalar[SLOPE_HIGH] = down
            e.scalar[SLOPE_LOW] *= 0.5
        low, high = e.scalar[LOW], e.scalar[HIGH]
        found = share
        if bend > 0.0:
            found = share + down / bend
        if found > high or found < low:
            found = low + (high - low) * e.scalar[SLOPE_LOW] / (e.scalar[SLOPE_LOW] - e.scalar[SLOPE_HIGH])
        e.scalar[SHARE] = found


@ti.func
def _begin_to_choose(bend: ti.f64, e: ti.template()):
    e.scalar[BEND] = bend
    e.scalar[SHARE] = 0.0
    e.scalar[LOW] = 0.0
    e.scalar[HIGH] = FAR
    e.scalar[SLOPE_LOW] = e.scalar[DOWN]
    e.scalar[SLOPE_HIGH] = 0.0
    e.scalar[SETTLED] = 0.0


@ti.func
def _push_on(linear: ti.template(), c: ti.i32, touch: ti.template(), e: ti.template()):
    """Go along the course with a contact; leaves by what its force changes."""
    if touch.awake[c]:
        share, displacement = e.scalar[SHARE], touch.touch_way[c]
        if ti.static(linear):
            touch.touch_way[c] = -share * yielding(c, touch, displacement)
        else:
            trial = touch.touch_trial[c] - share * touch.hard[c] * displacement
            force = pressed(c, touch, trial)
            touch.touch_trial[c] = trial
            touch.touch_way[c] = force - touch.touch_force[c]
            touch.touch_force[c] = force


@ti.func
def _step_on(
    i: ti.i32, points: ti.i32, p: ti.template(), touch: ti.template(), holds: ti.template(), e: ti.template()
) -> vec3:
    """Go along the course with a row; returns its parts of r.z, of z and the residual before, and of p.r."""
    share, before, z = e.scalar[SHARE], e.residual[i], vec3(0.0, 0.0, 0.0)
    e.response[i] += share * e.course[i]
    r = before - share * e.bent[i]
    if i >= points:
        r += on_body(i - points, touch, holds, touch.touch_way)
        z = e.inverse[i] @ r
    elif p.mobile[i]:
        for entry in range(touch.first_touch[i], touch.first_touch[i + 1]):
            c = touch.of_touch[entry] // 4
            if touch.awake[c]:
                r += touch.touch_weight[c][touch.of_touch[entry] % 4] * touch.touch_way[c]
        z = e.inverse[i] @ r
    e.residual[i] = r
    e.scaled[i] = z
    return vec3(r.dot(z), before.dot(z), r.dot(e.course[i]))


@ti.kernel
def solve_alone(
    linear: ti.template(),
    points: ti.i32,
    bodies: ti.i32,
    touches: ti.i32,
    most: ti.i32,
    enough: ti.f64,
    p: Points,
    touch: Touches,
    loose: Loose,
    holds: Holds,
    rows: Rows,
    e: System,
) -> ti.i32:
    """On one thread, until r.z is not above `enough`; returns iterations, one more than `most` where that is not so."""
    made = 0
    ti.loop_config(serialize=True)
    for _once in range(1):
        while e.scalar[NOW] > enough and made <= most:
            made += 1
            bend = vec3(0.0, 0.0, 0.0)
            for i in range(points + 2 * bodies):
                bend += _bend(i, points, p, loose, rows, e)
            _begin_to_choose(bend[1], e)
            for c in range(touches):
                if touch.awake[c]:
                    touch.touch_way[c] = parted(c, points, touch, e.course)
            for _try in range(1 + TRIES_ALONE):
                if e.scalar[SETTLED] == 0.0:
                    touching = vec3(0.0, 0.0, 0.0)
                    for c in range(touches):
                        touching += _slope(linear, c, touch, e)
                    _choose(touching, e)
            for c in range(touches):
                _push_on(linear, c, touch, e)
            sums = vec3(0.0, 0.0, 0.0)
            for i in range(points + 2 * bodies):
                sums += _step_on(i, points, p, touch, holds, e)
            turn(sums, e.scalar[NOW], e)
            for i in range(points + 2 * bodies):
                e.course[i] = e.scaled[i] + e.scalar[SHARE] * e.course[i]
    return made


@ti.kernel
def iterate(
    linear: ti.template(),
    points: ti.i32,
    bodies: ti.i32,
    touches: ti.i32,
    p: Points,
    touch: Touches,
    loose: Loose,
    holds: Holds,
    rows: Rows,
    e: System,
) -> ti.f64:
    """AT_ONCE iterations on all threads; returns r.z."""
    for _again in ti.static(range(AT_ONCE)):
        for i in range(points + 2 * bodies):
            e.part[i] = _bend(i, points, p, loose, rows, e)
        for row in range(ROWS):
            add_range(row, points + 2 * bodies, vec3(0.0, 0.0, 0.0), e.part)
        ti.loop_config(serialize=True)
        for _once in range(1):
            _begin_to_choose(add_ranges(points + 2 * bodies, vec3(0.0, 0.0, 0.0), e.part)[1], e)
        for c in range(touches):
            if touch.awake[c]:
                touch.touch_way[c] = parted(c, points, touch, e.course)
        for _try in ti.static(range(1 + TRIES)):
            for c in range(touches):
                if e.scalar[SETTLED] == 0.0:
                    e.part[c] = _slope(linear, c, touch, e)
            for row in range(ROWS):
                if e.scalar[SETTLED] == 0.0:
                    add_range(row, touches, vec3(0.0, 0.0, 0.0), e.part)
            ti.loop_config(serialize=True)
            for _once in range(1):
                if e.scalar[SETTLED] == 0.0:
                    _choose(add_ranges(touches, vec3(0.0, 0.0, 0.0), e.part), e)
        for c in range(touches):
            _push_on(linear, c, touch, e)
        for i in range(points + 2 * bodies):
            e.part[i] = _step_on(i, points, p, touch, holds, e)
        for row in range(ROWS):
            add_range(row, points + 2 * bodies, vec3(0.0, 0.0, 0.0), e.part)
        ti.loop_config(serialize=True)
        for _once in range(1):
            turn(add_ranges(points + 2 * bodies, vec3(0.0, 0.0, 0.0), e.part), e.scalar[NOW], e)
        for i in range(points + 2 * bodies):
            e.course[i] = e.scaled[i] + e.scalar[SHARE] * e.course[i]
    return e.scalar[NOW]
