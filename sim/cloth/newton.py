"""The equations of a step of implicit Euler.

The new positions minimise the energy

    sum m |x - y|^2 / (2 dt^2) + springs(x) + hinges(x) + dampers(x) + drag(x),

y where the points would go with gravity alone (Martin et al. 2011). Dampers store c (l - l_before)^2 / (2 dt), which
depends on lengths alone, so that turning is not damped. Second derivatives are taken without what would make them
negative, so that every way found leads down.
"""

import taichi as ti

from sim.cloth.air import drag, drag_block
from sim.cloth.hinges import fold, turned
from sim.cloth.layout import ROWS, Angles, Drag, Points, Strands, Touches
from sim.cloth.springs import block, line
from sim.cloth.touch import touch_energy
from sim.double import Integers, Matrices, Numbers, Vectors, mat3, vec2, vec3

BEFORE, NOW, BEND = range(3)
"""Scalars of conjugate gradients: r.z of the iteration before and of this one, and p.Ap."""

Trial = ti.types.argpack(
    start=Vectors,
    aim=Vectors,
    base=Vectors,
    place=Vectors,
    length_before=Numbers,
    angle_before=Numbers,
)
"""Where points were, would go without springs, were tried before, and are tried [m]; lengths [m] and angles [rad]
before the step."""

System = ti.types.argpack(
    spring_normal=Vectors,
    spring_block=Vectors,
    moment=Numbers,
    hinge_stiff=Numbers,
    slope=Vectors,
    slope_way=Numbers,
    residual=Vectors,
    scaled=Vectors,
    course=Vectors,
    bent=Vectors,
    answer=Vectors,
    inverse=Matrices,
    term=Numbers,
    scalar=Numbers,
)
"""Springs: directions; stiffness along and across [N/m], tension [N]. Hinges: moments [N m], stiffness [N m], the four
slopes of each [1/m]. Points: what conjugate gradients need. Terms and scalars of sums."""


@ti.func
def add_range(row: ti.i32, count: ti.i32, term: ti.template()):
    """Sum one of ROWS ranges of so many terms, into a place behind them."""
    size = (count + ROWS - 1) // ROWS
    total = ti.cast(0.0, ti.f64)
    for k in range(ti.min(row * size, count), ti.min((row + 1) * size, count)):
        total += term[k]
    term[count + row] = total


@ti.func
def add_ranges(count: ti.i32, term: ti.template()) -> ti.f64:
    """Sum what `add_range` left."""
    total = ti.cast(0.0, ti.f64)
    for row in range(ROWS):
        total += term[count + row]
    return total


@ti.func
def _hinge(k: ti.i32, a: ti.template(), place: ti.template()):
    return fold(
        place[a.corners[4 * k]], place[a.corners[4 * k + 1]], place[a.corners[4 * k + 2]], place[a.corners[4 * k + 3]]
    )


@ti.kernel
def begin(
    points: ti.i32,
    total: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    falls: Numbers,
    p: Points,
    s: Strands,
    a: Angles,
    t: Trial,
) -> ti.i32:
    """Remember the start, and try the positions of steady motion, or of a free fall for points that are said to do so
    (1 or 0); held points, and those of solids after the cloth's, are in `place` already. Returns whether a spring would
    turn by more than a right angle."""
    for i in range(total):
        x = p.position[i]
        t.start[i] = x
        if p.mobile[i]:
            t.aim[i] = x + dt * (p.velocity[i] + dt * gravity)
            t.place[i] = x + dt * (p.velocity[i] + falls[i] * dt * gravity)
    turning = 0
    for k in range(springs):
        one, other = s.ends[2 * k], s.ends[2 * k + 1]
        along, length = line(p.position[one], p.position[other])
        t.length_before[k] = length
        if along.dot(t.place[one] - t.place[other]) < 0.0:
            ti.atomic_max(turning, 1)
    for k in range(hinges):
        t.angle_before[k] = _hinge(k, a, p.position).angle
    return turning


@ti.kernel
def stay(points: ti.i32, p: Points, t: Trial):
    """Try the places of the start."""
    for i in range(points):
        if p.mobile[i]:
            t.place[i] = t.start[i]


@ti.kernel
def assess(
    airy: ti.template(),
    points: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    touches: ti.i32,
    dt: ti.f64,
    wind: vec3,
    mass: Numbers,
    mobile: Integers,
    s: Strands,
    a: Angles,
    touch: Touches,
    d: Drag,
    t: Trial,
    e: System,
) -> ti.f64:
    """Forces and stiffness of springs, hinges and contacts at the places tried; returns the energy [J].

    Masses come apart from the rest of the points: Taichi takes no more than 64 arguments."""
    for k in range(springs):
        along, length = line(t.place[s.ends[2 * k]], t.place[s.ends[2 * k + 1]])
        over, since = length - s.rest[k], length - t.length_before[k]
        tension = s.stiff[k] * over + s.damp[k] / dt * since
        stiffness, across = block(s.stiff[k] + s.damp[k] / dt, tension, length)
        e.spring_normal[k] = along
        e.spring_block[k] = vec3(stiffness, across, tension)
        e.term[points + k] = 0.5 * (s.stiff[k] * over * over + s.damp[k] / dt * since * since)
    for k in range(hinges):
        hinge = _hinge(k, a, t.place)
        over, since = turned(hinge.angle, a.rest_angle[k]), turned(hinge.angle, t.angle_before[k])
        e.moment[k] = a.rigid[k] * over + a.bend_damp[k] / dt * since
        e.hinge_stiff[k] = a.rigid[k] + a.bend_damp[k] / dt
        e.slope[4 * k] = hinge.p
        e.slope[4 * k + 1] = hinge.q
        e.slope[4 * k + 2] = hinge.r
        e.slope[4 * k + 3] = hinge.s
        e.term[points + springs + k] = 0.5 * (a.rigid[k] * over * over + a.bend_damp[k] / dt * since * since)
    for c in range(touches):
        e.term[points + springs + hinges + c] = touch_energy(c, touch, t.start, t.place)
    for i in range(points):
        energy = ti.cast(0.0, ti.f64)
        if mobile[i]:
            energy = 0.5 * mass[i] / (dt * dt) * (t.place[i] - t.aim[i]).norm_sqr()
            if ti.static(airy):
                past = (t.place[i] - t.start[i]) / dt - wind
                energy += 0.5 * dt * past.dot(drag(i, past, d))
        e.term[i] = energy
    count = points + springs + hinges + touches
    for row in range(ROWS):
        add_range(row, count, e.term)
    energy = ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for _once in range(1):
        energy = add_ranges(count, e.term)
    return energy


@ti.kernel
def linearize(
    airy: ti.template(),
    points: ti.i32,
    dt: ti.f64,
    wind: vec3,
    p: Points,
    s: Strands,
    a: Angles,
    touch: Touches,
    d: Drag,
    t: Trial,
    e: System,
) -> vec2:
    """Forces that are left at the places tried, and the preconditioner: blocks of the diagonal. Returns r.z, and the
    sum of r^2 / m, which bounds what is wrong whatever the springs: A is at least m / dt^2."""
    for i in range(points):
        z, r = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
        if p.mobile[i]:
            unit = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            inertia = p.mass[i] / (dt * dt)
            r = inertia * (t.aim[i] - t.place[i])
            diagonal = inertia * unit
            for entry in range(s.first_spring[i], s.first_spring[i + 1]):
                k, end = s.of_spring[entry] // 2, s.of_spring[entry] % 2
                n, b = e.spring_normal[k], e.spring_block[k]
                r -= ti.cast(1 - 2 * end, ti.f64) * b[2] * n
                diagonal += b[1] * unit + (b[0] - b[1]) * n.outer_product(n)
            for entry in range(a.first_hinge[i], a.first_hinge[i + 1]):
                k, lean = a.of_hinge[entry] // 4, e.slope[a.of_hinge[entry]]
                r -= e.moment[k] * lean
                diagonal += e.hinge_stiff[k] * lean.outer_product(lean)
            for entry in range(touch.first_touch[i], touch.first_touch[i + 1]):
                c = touch.of_touch[entry] // 4
                w = touch.touch_weight[c][touch.of_touch[entry] % 4]
                n, slip, b = touch.touch_normal[c], touch.touch_slip[c], touch.touch_block[c]
                r += w * touch.touch_force[c]
                diagonal += w * w * (b[1] * unit + (b[0] - b[1]) * n.outer_product(n))
                diagonal += w * w * (b[2] - b[1]) * slip.outer_product(slip)
            if ti.static(airy):
                r -= drag(i, (t.place[i] - t.start[i]) / dt - wind, d)
                diagonal += drag_block(i, d) / dt
            e.inverse[i] = diagonal.inverse()
            z = e.inverse[i] @ r
        e.residual[i] = r
        e.scaled[i] = z
        e.course[i] = z
        e.answer[i] = vec3(0.0, 0.0, 0.0)
        t.base[i] = t.place[i]
        e.term[i] = r.dot(z)
    for row in range(ROWS):
        add_range(row, points, e.term)
    ti.loop_config(serialize=True)
    for _once in range(1):
        total = add_ranges(points, e.term)
        e.scalar[NOW] = total
    for i in range(points):
        left = ti.cast(0.0, ti.f64)
        if p.mobile[i]:
            left = e.residual[i].norm_sqr() / p.mass[i]
        e.term[i] = left
    for row in range(ROWS):
        add_range(row, points, e.term)
    unbalanced = ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for _once in range(1):
        unbalanced = add_ranges(points, e.term)
    return vec2(e.scalar[NOW], unbalanced)


@ti.kernel
def load_on(points: ti.i32, dt: ti.f64, p: Points, load: Vectors, t: Trial):
    """Let forces on points [N] act in the step besides gravity."""
    for i in range(points):
        if p.mobile[i]:
            t.aim[i] += dt * dt / p.mass[i] * load[i]


@ti.kernel
def ask(points: ti.i32, p: Points, load: Vectors, e: System) -> ti.f64:
    """Begin to look for how points give way to forces [N] beside those there are; returns r.z."""
    for i in range(points):
        z, r = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
        if p.mobile[i]:
            r = load[i]
            z = e.inverse[i] @ r
        e.residual[i] = r
        e.course[i] = z
        e.answer[i] = vec3(0.0, 0.0, 0.0)
        e.term[i] = r.dot(z)
    for row in range(ROWS):
        add_range(row, points, e.term)
    ti.loop_config(serialize=True)
    for _once in range(1):
        total = add_ranges(points, e.term)
        e.scalar[NOW] = total
    return e.scalar[NOW]


@ti.kernel
def move(points: ti.i32, share: ti.f64, t: Trial, e: System) -> ti.f64:
    """Try a share of the way found; returns how far the whole of it takes any point [m]."""
    longest = ti.cast(0.0, ti.f64)
    for i in range(points):
        t.place[i] = t.base[i] + share * e.answer[i]
        ti.atomic_max(longest, e.answer[i].norm())
    return longest


@ti.kernel
def finish(total: ti.i32, dt: ti.f64, p: Points, t: Trial):
    """Take the places tried."""
    for i in range(total):
        p.velocity[i] = (t.place[i] - t.start[i]) / dt
        p.position[i] = t.place[i]
