"""Conjugate gradients for a step of Newton's method, with blocks of the diagonal as preconditioner.

Small cloths are solved by one thread in one launch: threads would wait for one another most of the time.
"""

import taichi as ti

from sim.cloth.air import drag
from sim.cloth.layout import ROWS, Angles, Drag, Points, Strands, Touches
from sim.cloth.newton import BEFORE, BEND, NOW, System, add_range, add_ranges
from sim.cloth.touch import carried, yielding
from sim.double import vec3

AT_ONCE = 4
"""Iterations in one launch."""


@ti.func
def _fold_back(k: ti.i32, a: ti.template(), e: ti.template()):
    """How much the moment of a hinge changes along the course."""
    total = ti.cast(0.0, ti.f64)
    for corner in ti.static(range(4)):
        total += e.slope[4 * k + corner].dot(e.course[a.corners[4 * k + corner]])
    e.slope_way[k] = e.hinge_stiff[k] * total


@ti.func
def _push_back(
    airy: ti.template(),
    i: ti.i32,
    dt: ti.f64,
    p: ti.template(),
    s: ti.template(),
    a: ti.template(),
    touch: ti.template(),
    d: ti.template(),
    e: ti.template(),
) -> ti.f64:
    """How much force on a point changes along the course; returns what that does to the energy."""
    q = vec3(0.0, 0.0, 0.0)
    if p.mobile[i]:
        way = e.course[i]
        q = p.mass[i] / (dt * dt) * way
        for entry in range(s.first_spring[i], s.first_spring[i + 1]):
            k, end = s.of_spring[entry] // 2, s.of_spring[entry] % 2
            n, b = e.spring_normal[k], e.spring_block[k]
            apart = way - e.course[s.ends[2 * k + 1 - end]]
            q += b[1] * apart + (b[0] - b[1]) * n.dot(apart) * n
        for entry in range(a.first_hinge[i], a.first_hinge[i + 1]):
            q += e.slope_way[a.of_hinge[entry] // 4] * e.slope[a.of_hinge[entry]]
        for entry in range(touch.first_touch[i], touch.first_touch[i + 1]):
            c = touch.of_touch[entry] // 4
            q += touch.touch_weight[c][touch.of_touch[entry] % 4] * touch.touch_way[c]
        if ti.static(airy):
            q += drag(i, way / dt, d)
    e.bent[i] = q
    return q.dot(e.course[i])


@ti.func
def _step_on(i: ti.i32, share: ti.f64, p: ti.template(), e: ti.template()) -> ti.f64:
    """Go along the course; returns the point's part of r.z."""
    e.answer[i] += share * e.course[i]
    r = e.residual[i] - share * e.bent[i]
    z = vec3(0.0, 0.0, 0.0)
    if p.mobile[i]:
        z = e.inverse[i] @ r
    e.residual[i] = r
    e.scaled[i] = z
    return r.dot(z)


@ti.func
def _ratio(one: ti.f64, other: ti.f64) -> ti.f64:
    found = ti.cast(0.0, ti.f64)
    if other > 0.0:
        found = one / other
    return found


@ti.kernel
def solve_alone(
    airy: ti.template(),
    points: ti.i32,
    hinges: ti.i32,
    touches: ti.i32,
    most: ti.i32,
    enough: ti.f64,
    dt: ti.f64,
    p: Points,
    s: Strands,
    a: Angles,
    touch: Touches,
    d: Drag,
    e: System,
) -> ti.i32:
    """On one thread, until r.z is not above `enough`; returns iterations, one more than `most` where that is not so."""
    made = 0
    ti.loop_config(serialize=True)
    for _once in range(1):
        now = e.scalar[NOW]
        while now > enough and made <= most:
            made += 1
            for k in range(hinges):
                _fold_back(k, a, e)
            for c in range(touches):
                touch.touch_way[c] = yielding(c, touch, carried(c, touch, e.course))
            bend = ti.cast(0.0, ti.f64)
            for i in range(points):
                bend += _push_back(airy, i, dt, p, s, a, touch, d, e)
            share, before = _ratio(now, bend), now
            now = ti.cast(0.0, ti.f64)
            for i in range(points):
                now += _step_on(i, share, p, e)
            go_on = _ratio(now, before)
            for i in range(points):
                e.course[i] = e.scaled[i] + go_on * e.course[i]
    return made


@ti.kernel
def iterate(
    airy: ti.template(),
    points: ti.i32,
    hinges: ti.i32,
    touches: ti.i32,
    dt: ti.f64,
    p: Points,
    s: Strands,
    a: Angles,
    touch: Touches,
    d: Drag,
    e: System,
) -> ti.f64:
    """AT_ONCE iterations on all threads; returns r.z."""
    for _again in ti.static(range(AT_ONCE)):
        for k in range(hinges):
            _fold_back(k, a, e)
        for c in range(touches):
            touch.touch_way[c] = yielding(c, touch, carried(c, touch, e.course))
        for i in range(points):
            e.term[i] = _push_back(airy, i, dt, p, s, a, touch, d, e)
        for row in range(ROWS):
            add_range(row, points, e.term)
        ti.loop_config(serialize=True)
        for _once in range(1):
            e.scalar[BEND] = add_ranges(points, e.term)
        for i in range(points):
            e.term[i] = _step_on(i, _ratio(e.scalar[NOW], e.scalar[BEND]), p, e)
        for row in range(ROWS):
            add_range(row, points, e.term)
        ti.loop_config(serialize=True)
        for _once in range(1):
            e.scalar[BEFORE] = e.scalar[NOW]
            e.scalar[NOW] = add_ranges(points, e.term)
        for i in range(points):
            e.course[i] = e.scaled[i] + _ratio(e.scalar[NOW], e.scalar[BEFORE]) * e.course[i]
    return e.scalar[NOW]
