"""The equations of a step of implicit Euler.

The new positions minimise the energy

    sum m |x - y|^2 / (2 dt^2) + springs(x) + hinges(x) + dampers(x) + drag(x),

y where the points would go with gravity alone (Martin et al. 2011). Dampers store c (l - l_before)^2 / (2 dt), which
depends on lengths alone, so that turning is not damped. Second derivatives are taken without what would make them
negative, so that every way found leads down.
"""

from typing import Any

import taichi as ti

from sim.cloth.contact.augmented_lagrangian import on_body, slipping, touch_energy
from sim.cloth.fabric.air_drag import drag, drag_block
from sim.cloth.fabric.bending import fold, turned
from sim.cloth.fabric.layout import ROWS, Angles, Drag, Holds, Loose, Points, Rows, Strands, Touches
from sim.cloth.fabric.springs import block, line
from sim.device.double import Matrices, Numbers, Vectors, cross_matrix, mat3, vec2, vec3, vec5

NOW, DOWN, BEND, SHARE, LOW, HIGH, SLOPE_LOW, SLOPE_HIGH, SETTLED = range(9)
"""Scalars of conjugate gradients: r.z; along the course, p.r and p.Ap, how far to go, between which shares, the slopes
at these, and whether that is settled."""

Trial: Any = ti.types.argpack(
    start=Vectors,
    aim=Vectors,
    base=Vectors,
    place=Vectors,
    length_before=Numbers,
    angle_before=Numbers,
)
"""Where points were, would go without springs, were tried before, and are tried [m]; lengths [m] and angles [rad]
before the step."""

Strain: Any = ti.types.argpack(
    spring_normal=Vectors,
    spring_block=Vectors,
    moment=Numbers,
    hinge_stiff=Numbers,
    slope=Vectors,
    term=Numbers,
)
"""Springs: directions; stiffness along and across [N/m], tension [N]. Hinges: moments [N m], stiffness [N m], the four
slopes of each [1/m]. Energies of all of them, of contacts and of points [J]."""

System: Any = ti.types.argpack(
    force=Vectors,
    force_before=Vectors,
    residual=Vectors,
    scaled=Vectors,
    course=Vectors,
    bent=Vectors,
    response=Vectors,
    line=Vectors,
    inverse=Matrices,
    part=Vectors,
    scalar=Numbers,
)
"""Of points: forces that are left where Newton's method is, and where it was [N]; what conjugate gradients need; the
last way of Newton's method [m]. Terms of sums, three at once, and scalars."""


@ti.func
def add_range(row: ti.i32, count: ti.i32, total: ti.template(), term: ti.template()):
    """Add one of ROWS ranges of so many terms to `total`, into a place behind them."""
    size = (count + ROWS - 1) // ROWS
    whole = total
    for k in range(ti.min(row * size, count), ti.min((row + 1) * size, count)):
        whole += term[k]
    term[count + row] = whole


@ti.func
def add_ranges(count: ti.i32, total: ti.template(), term: ti.template()):
    """Add what `add_range` left to `total`."""
    whole = total
    for row in range(ROWS):
        whole += term[count + row]
    return whole


@ti.func
def turn(sums: vec3, before: ti.f64, e: ti.template()):
    """Which share of the way before the next one keeps (Polak and Ribiere); `sums`: r.z, z and the r before, and r and
    the way before; `before`: r.z before, or 0 to keep nothing."""
    keep = ti.cast(0.0, ti.f64)
    if before > 0.0:
        keep = ti.max((sums[0] - sums[1]) / before, 0.0)
    down = sums[0] + keep * sums[2]
    if not down > 0.0:
        keep, down = ti.cast(0.0, ti.f64), sums[0]
    e.scalar[NOW] = sums[0]
    e.scalar[DOWN] = down
    e.scalar[SHARE] = keep


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
    now: ti.f64,
    ago: ti.f64,
    place_before: Vectors,
    velocity_before: Vectors,
    p: Points,
    s: Strands,
    a: Angles,
    t: Trial,
) -> ti.i32:
    """Remember the start, and try the positions of steady motion, or of a free fall for points that are said to do so
    (1 or 0); held points, and those of solids after the cloth's, are in `place` already. `now` and `ago`: weights of
    what points do, and did a step before, in where they start (`sim.cloth.integrators.backward_differences`). Returns
    whether a spring would turn by more than a right angle."""
    for i in range(total):
        x, v = p.position[i], p.velocity[i]
        if i < points and ago > 0.0:
            x = now * x - ago * place_before[i]
            v = now * v - ago * velocity_before[i]
        t.start[i] = x
        if p.mobile[i]:
            t.aim[i] = x + dt * (v + dt * gravity)
            t.place[i] = x + dt * (v + falls[i] * dt * gravity)
    turning = 0
    for k in range(springs):
        one, other = s.ends[2 * k], s.ends[2 * k + 1]
        along, length = line(t.start[one], t.start[other])
        t.length_before[k] = length
        if along.dot(t.place[one] - t.place[other]) < 0.0:
            ti.atomic_max(turning, 1)
    for k in range(hinges):
        t.angle_before[k] = _hinge(k, a, t.start).angle
    return turning


@ti.kernel
def stay(points: ti.i32, p: Points, t: Trial):
    """Try the places of the start."""
    for i in range(points):
        if p.mobile[i]:
            t.place[i] = t.start[i]


@ti.kernel
def assess_touches(first: ti.i32, touches: ti.i32, rows: ti.i32, touch: Touches, loose: Loose, t: Trial, term: Numbers):
    """Forces and stiffness of contacts at the places tried; energies [J] of them, and of the ways of bodies in so many
    rows, from the `first` term on."""
    for c in range(touches):
        term[first + c] = touch_energy(c, touch, t.start, t.place, loose.loose_way)
    for row in range(rows):
        off = loose.loose_way[row] - loose.loose_aim[row]
        term[first + touches + row] = 0.5 * off.dot(loose.loose_block[row] @ off)


@ti.kernel
def assess(
    airy: ti.template(),
    points: ti.i32,
    springs: ti.i32,
    hinges: ti.i32,
    others: ti.i32,
    dt: ti.f64,
    wind: vec3,
    p: Points,
    s: Strands,
    a: Angles,
    d: Drag,
    t: Trial,
    e: Strain,
) -> ti.f64:
    """Forces and stiffness of springs and hinges at the places tried; returns the energy [J], with so many terms of
    others that `assess_touches` has found."""
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
    for i in range(points):
        energy = ti.cast(0.0, ti.f64)
        if p.mobile[i]:
            energy = 0.5 * p.mass[i] / (dt * dt) * (t.place[i] - t.aim[i]).norm_sqr()
            if ti.static(airy):
                past = (t.place[i] - t.start[i]) / dt - wind
                energy += 0.5 * dt * past.dot(drag(i, past, d))
        e.term[i] = energy
    count = points + springs + hinges + others
    for row in range(ROWS):
        add_range(row, count, ti.cast(0.0, ti.f64), e.term)
    energy = ti.cast(0.0, ti.f64)
    ti.loop_config(serialize=True)
    for _once in range(1):
        energy = add_ranges(count, ti.cast(0.0, ti.f64), e.term)
    return energy


@ti.func
def _pressed_block(c: ti.i32, touch: ti.template()) -> mat3:
    """How much less a contact pushes for each way that its sides move apart."""
    unit = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    n, slip, b = touch.touch_normal[c], slipping(c, touch), touch.touch_block[c]
    return b[1] * unit + (b[0] - b[1]) * n.outer_product(n) + (b[2] - b[1]) * slip.outer_product(slip)


@ti.func
def _tied(n: vec3, b: vec3):
    """How the force of a spring changes."""
    return b[1] * mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) + (b[0] - b[1]) * n.outer_product(n)


@ti.kernel
def tie(pairs: ti.i32, rows: Rows, e: Strain):
    """The blocks of the matrix beside the diagonal."""
    for pair in range(pairs):
        found = ti.Matrix.zero(ti.f64, 3, 3)
        for entry in range(rows.first_tie[pair], rows.first_tie[pair + 1]):
            what = rows.of_tie[entry]
            if what < 0:
                found -= _tied(e.spring_normal[-1 - what], e.spring_block[-1 - what])
            else:
                k, one, other = what // 16, what // 4 % 4, what % 4
                found += (e.hinge_stiff[k] * e.slope[4 * k + one]).outer_product(e.slope[4 * k + other])
        rows.off_block[rows.slot[2 * pair]] = found
        rows.off_block[rows.slot[2 * pair + 1]] = found.transpose()


@ti.kernel
def stiffen(
    airy: ti.template(),
    points: ti.i32,
    dt: ti.f64,
    wind: vec3,
    p: Points,
    s: Strands,
    a: Angles,
    d: Drag,
    rows: Rows,
    t: Trial,
    e: Strain,
    force: Vectors,
):
    """Forces that are left at the places tried, and the blocks of the diagonal, both without contacts."""
    for i in range(points):
        r = vec3(0.0, 0.0, 0.0)
        if p.mobile[i]:
            inertia = p.mass[i] / (dt * dt)
            r = inertia * (t.aim[i] - t.place[i])
            alone = inertia * mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            if ti.static(airy):
                r -= drag(i, (t.place[i] - t.start[i]) / dt - wind, d)
                alone += drag_block(i, d) / dt
            own = alone
            for entry in range(s.first_spring[i], s.first_spring[i + 1]):
                k, end = s.of_spring[entry] // 2, s.of_spring[entry] % 2
                n, b = e.spring_normal[k], e.spring_block[k]
                r -= ti.cast(1 - 2 * end, ti.f64) * b[2] * n
                own += _tied(n, b)
            for entry in range(a.first_hinge[i], a.first_hinge[i + 1]):
                k, lean = a.of_hinge[entry] // 4, e.slope[a.of_hinge[entry]]
                r -= e.moment[k] * lean
                own += e.hinge_stiff[k] * lean.outer_product(lean)
            rows.own_block[i] = own
            rows.alone_block[i] = alone
        force[i] = r


@ti.kernel
def linearize(
    points: ti.i32,
    bodies: ti.i32,
    dt: ti.f64,
    gravity: vec3,
    p: Points,
    touch: Touches,
    loose: Loose,
    holds: Holds,
    rows: Rows,
    t: Trial,
    e: System,
) -> vec5:
    """Add forces of contacts, and find the preconditioner: blocks of the diagonal. Returns r.z; the sum of r^2 / m,
    which bounds what is wrong whatever the springs: A is at least m / dt^2; the same of the forces that act; and both
    of bodies."""
    for row in range(2 * bodies):
        i, off = points + row, loose.loose_way[row] - loose.loose_aim[row]
        inertia, found = loose.loose_block[row], loose.loose_block[row]
        for entry in range(holds.first_hold[row // 2], holds.first_hold[row // 2 + 1]):
            k = holds.of_hold[entry]
            stiff = _pressed_block(k // 2, touch)
            if row % 2 == 0:
                found += touch.touch_sum[k] ** 2 * stiff
            else:
                lever = cross_matrix(touch.touch_arm[k])
                found += lever @ stiff @ lever.transpose()
        r = on_body(row, touch, holds, touch.touch_force) - inertia @ off
        e.inverse[i] = found.inverse()
        e.force[i] = r
        e.residual[i] = r
        e.scaled[i] = e.inverse[i] @ r
        e.course[i] = e.scaled[i]
        e.response[i] = vec3(0.0, 0.0, 0.0)
        loose.loose_base[row] = loose.loose_way[row]
        if row % 2 == 0:
            off += dt * dt * gravity
        sums = vec3(dt * dt * r.dot(e.scaled[i]), r.dot(inertia.inverse() @ r), off.dot(inertia @ off))
        # Behind the sums over ranges of points.
        e.part[points + ROWS + row] = sums / (dt * dt)
    for i in range(points):
        z, r, left, acting = vec3(0.0, 0.0, 0.0), e.force[i], ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
        if p.mobile[i]:
            diagonal = rows.own_block[i]
            for entry in range(touch.first_touch[i], touch.first_touch[i + 1]):
                c = touch.of_touch[entry] // 4
                w = touch.touch_weight[c][touch.of_touch[entry] % 4]
                r += w * touch.touch_force[c]
                diagonal += w * w * _pressed_block(c, touch)
            e.inverse[i] = diagonal.inverse()
            z = e.inverse[i] @ r
            left = r.norm_sqr() / p.mass[i]
            acting = p.mass[i] * ((t.place[i] - t.aim[i]) / (dt * dt) + gravity).norm_sqr()
        e.force[i] = r
        e.residual[i] = r
        e.scaled[i] = z
        e.course[i] = z
        e.response[i] = vec3(0.0, 0.0, 0.0)
        t.base[i] = t.place[i]
        e.part[i] = vec3(r.dot(z), left, acting)
    for row in range(ROWS):
        add_range(row, points, vec3(0.0, 0.0, 0.0), e.part)
    total, of_bodies = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
    ti.loop_config(serialize=True)
    for _once in range(1):
        for row in range(2 * bodies):
            of_bodies += e.part[points + ROWS + row]
        total = add_ranges(points, vec3(0.0, 0.0, 0.0), e.part)
        e.scalar[NOW] = total[0] + of_bodies[0]
        e.scalar[DOWN] = e.scalar[NOW]
    return vec5(e.scalar[NOW], total[1], total[2], of_bodies[1], of_bodies[2])


@ti.kernel
def load_on(points: ti.i32, dt: ti.f64, p: Points, load: Vectors, t: Trial):
    """Let forces on points [N] act in the step besides gravity."""
    for i in range(points):
        if p.mobile[i]:
            t.aim[i] += dt * dt / p.mass[i] * load[i]


@ti.kernel
def ask(points: ti.i32, rows: ti.i32, p: Points, load: Vectors, e: System) -> ti.f64:
    """Begin to look for how points, and bodies in so many rows, give way to forces [N] on points beside those there
    are; returns r.z."""
    for i in range(points + rows):
        z, r = vec3(0.0, 0.0, 0.0), vec3(0.0, 0.0, 0.0)
        if i < points and p.mobile[i]:
            r = load[i]
            z = e.inverse[i] @ r
        e.residual[i] = r
        e.course[i] = z
        e.response[i] = vec3(0.0, 0.0, 0.0)
        e.part[i] = vec3(r.dot(z), 0.0, 0.0)
    for row in range(ROWS):
        add_range(row, points + rows, vec3(0.0, 0.0, 0.0), e.part)
    ti.loop_config(serialize=True)
    for _once in range(1):
        total = add_ranges(points + rows, vec3(0.0, 0.0, 0.0), e.part)[0]
        e.scalar[NOW] = total
        e.scalar[DOWN] = total
    return e.scalar[NOW]


@ti.kernel
def respond(points: ti.i32, e: System, found: Vectors):
    """What conjugate gradients found of points alone."""
    for i in range(points):
        found[i] = e.response[i]


@ti.kernel
def conjugate(rows: ti.i32, before: ti.f64, e: System) -> vec2:
    """Turn the way found, unless `before` is 0, so that it is conjugate to the one before; returns r.z and the slope
    of the energy along the way. `rows`: of points and bodies."""
    for i in range(rows):
        z = e.response[i]
        e.part[i] = vec3(e.force[i].dot(z), e.force_before[i].dot(z), e.force[i].dot(e.line[i]))
    for row in range(ROWS):
        add_range(row, rows, vec3(0.0, 0.0, 0.0), e.part)
    ti.loop_config(serialize=True)
    for _once in range(1):
        turn(add_ranges(rows, vec3(0.0, 0.0, 0.0), e.part), before, e)
    for i in range(rows):
        e.line[i] = e.response[i] + e.scalar[SHARE] * e.line[i]
        e.response[i] = e.line[i]
        e.force_before[i] = e.force[i]
    return vec2(e.scalar[NOW], e.scalar[DOWN])


@ti.kernel
def move(points: ti.i32, rows: ti.i32, share: ti.f64, reach: Numbers, loose: Loose, t: Trial, e: System) -> ti.f64:
    """Try a share of the way found, of bodies in so many rows, too; returns how far the whole of it takes any point
    [m]. `reach`: how far a way or turn of 1 of a row of a body takes its points."""
    longest = ti.cast(0.0, ti.f64)
    for row in range(rows):
        loose.loose_way[row] = loose.loose_base[row] + share * e.response[points + row]
        ti.atomic_max(longest, reach[row] * e.response[points + row].norm())
    for i in range(points):
        t.place[i] = t.base[i] + share * e.response[i]
        ti.atomic_max(longest, e.response[i].norm())
    return longest


@ti.kernel
def shift(points: ti.i32, dt: ti.f64, push: Vectors, t: Trial):
    """Move points by what an acceleration [m/s^2] does in a step."""
    for i in range(points):
        t.place[i] += dt * dt * push[i]


@ti.kernel
def finish(
    points: ti.i32,
    total: ti.i32,
    dt: ti.f64,
    since: ti.f64,
    place_before: Vectors,
    velocity_before: Vectors,
    p: Points,
    t: Trial,
):
    """Take the places tried, and remember the step; `since`: the time in which points came there from their start."""
    for i in range(total):
        if i < points:
            place_before[i] = p.position[i]
            velocity_before[i] = p.velocity[i]
        p.velocity[i] = (t.place[i] - t.start[i]) / ti.select(i < points, since, dt)
        p.position[i] = t.place[i]


@ti.kernel
def quicken(points: ti.i32, dt: ti.f64, push: Vectors, p: Points):
    """Change velocities by what an acceleration [m/s^2] does in a step."""
    for i in range(points):
        p.velocity[i] += dt * push[i]
