"""When two primitives that move straight come near each other: additive advancement (Li et al. 2021, ACCD).

They are moved on by as much of the step as they could need at least to come so near, again and again: what is said to
stay apart stays apart. Most stay apart along the line between where they are nearest now: since primitives are convex
and move straight, how far they are apart along a line is never less than at the begin and at the end.
"""

from typing import Any

from sim.cloth.contact.detection.proximity import nearest
from sim.device.compiler import ti
from sim.device.double import vec3, vec4

ROUNDS = 64
"""Of advancement; what has not come to an end by then counts as near."""
ENOUGH = 0.02
"""Of the distance to be kept: primitives that come so much nearer than it asks to within this share have arrived."""

Approach: Any = ti.types.struct(
    start=ti.f64, start_weight=vec4, start_apart=vec3, time=ti.f64, weight=vec4, apart=vec3, narrow=ti.i32
)
"""Distance [m] and nearest points (`proximity.Nearest`) at the start; the share of the displacements after which
primitives are near, above 1 if never, and the nearest points then; whether they come too near."""


@ti.func
def span(edges: ti.template(), dp: vec3, dq: vec3, dr: vec3, ds: vec3) -> ti.f64:
    """No point of one primitive comes nearer to any of the other than by this [m], for displacements of their
    points."""
    displacement = ti.cast(0.0, ti.f64)
    if ti.static(edges):
        mean = 0.25 * (dp + dq + dr + ds)
        displacement = ti.max((dp - mean).norm(), (dq - mean).norm()) + ti.max((dr - mean).norm(), (ds - mean).norm())
    else:
        displacement = ti.max((dp - dq).norm(), ti.max((dp - dr).norm(), (dp - ds).norm()))
    return displacement


@ti.func
def apart_along(edges: ti.template(), n: vec3, p: vec3, q: vec3, r: vec3, s: vec3) -> ti.f64:
    """How far the first primitive is from the other along a unit vector [m]."""
    near, far = n.dot(p), ti.max(n.dot(r), n.dot(s))
    if ti.static(edges):
        near = ti.min(near, n.dot(q))
    else:
        far = ti.max(far, n.dot(q))
    return near - far


@ti.func
def approach(
    edges: ti.template(),
    p: vec3,
    q: vec3,
    r: vec3,
    s: vec3,
    dp: vec3,
    dq: vec3,
    dr: vec3,
    ds: vec3,
    thickness: ti.f64,
    early: ti.f64,
    least: ti.f64,
) -> Approach:
    """How primitives come near each other while their points are displaced: near at `early` of `thickness` [m], too
    near at `least` of it, or of the distance at the start where that is less.

    One loop looks for both: what is inlined here is most of what a kernel takes to compile."""
    found = Approach(time=2.0, narrow=0)
    limit, time, displacement = early * thickness, ti.cast(0.0, ti.f64), ti.cast(-1.0, ti.f64)
    near, rounds, going = 0, 0, 1
    while going == 1:
        there = nearest(edges, p + time * dp, q + time * dq, r + time * dr, s + time * ds)
        distance = there.apart.norm()
        if near == 0 and rounds == 0:
            found.start_weight, found.start_apart, found.start = there.weight, there.apart, distance
        rounds += 1
        enough = (1.0 + ENOUGH) * limit
        if distance <= enough or rounds > ROUNDS:
            if near == 1:
                found.narrow = 1
                going = 0
            else:
                found.time, found.weight, found.apart = time, there.weight, there.apart
                limit = least * ti.min(thickness, found.start)
                near, rounds = 1, 0
        elif apart_along(edges, there.apart / distance, p + dp, q + dq, r + dr, s + ds) > enough:
            going = 0
        else:
            if displacement < 0.0:
                displacement = span(edges, dp, dq, dr, ds)
            if displacement * (1.0 - time) <= distance - limit:
                going = 0
            else:
                time += (distance - limit) / displacement
                going = int(time <= 1.0)
    return found
