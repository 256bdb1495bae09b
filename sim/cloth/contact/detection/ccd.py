"""When two primitives that move straight come near each other: additive advancement (Li et al. 2021, ACCD).

They are moved on by as much of the step as they could need at least to come so near, again and again: what is said to
stay apart stays apart.
"""

from sim.cloth.contact.detection.proximity import nearest
from sim.device.compiler import ti
from sim.device.double import vec3

ROUNDS = 64
"""Of advancement; what has not come to an end by then counts as near."""
ENOUGH = 0.02
"""Of the distance to be kept: primitives that come so much nearer than it asks to within this share have arrived."""


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
def time_of_nearness(
    edges: ti.template(),
    p: vec3,
    q: vec3,
    r: vec3,
    s: vec3,
    dp: vec3,
    dq: vec3,
    dr: vec3,
    ds: vec3,
    distance: ti.f64,
) -> ti.f64:
    """The share of the displacements after which primitives are `distance` [m] apart or less; above 1 if never."""
    displacement = span(edges, dp, dq, dr, ds)
    time, near, rounds = ti.cast(0.0, ti.f64), 0, 0
    while near == 0 and time <= 1.0:
        apart = nearest(edges, p + time * dp, q + time * dq, r + time * dr, s + time * ds).apart.norm()
        rounds += 1
        if apart <= (1.0 + ENOUGH) * distance or rounds > ROUNDS:
            near = 1
        elif displacement * (1.0 - time) <= apart - distance:
            time = 2.0
        else:
            time += (apart - distance) / displacement
    return time
