"""What becomes of fluid between two solids that leave less room than a layer of particles.

There a particle stays as a layer is: what the solids add does not grow while they come nearer, it is led along the
middle of the gap, and as there is less room than it takes, it may be denser than the fluid. So nothing is squeezed out
like a ball of steel. How much room it lacks is its slack [m]. At the mouth of the gap, where nothing catches it any
more, it keeps that for a while, or it would be shot out: what overlaps there would be put right in one step, and the
faster, the shorter that is.

Functions of several half-spaces take them as `sim.fluid.boundary.faces` lists them, from `first` to before `last`.
"""

from sim.device.arrays import real, vec3, vec4
from sim.device.compiler import ti
from sim.fluid.boundary.half_spaces.pose import surface_velocity
from sim.fluid.layout import DISTANCE
from sim.geometry.distance.narrow_band import OPPOSITE

NARROW, WIDE = 1.2, 2.0
"""Spacings between two solids up to which no layer of particles acts on them, and from which all do."""
SLIM_NARROW, SLIM_WIDE = 0.95, 1.15
"""The same of slim bodies."""
WEDGE, INCLINED, STRAIGHT = 0.5, 0.9, 0.98
"""Cosines of the angle between two solids: from the first on what is between them lacks room, from the second it is
led, and from the third it cannot get out."""
CENTRED, LEAD, LED = 0.2, 2.0, 0.15
"""A particle is led to the middle of a gap by this share of its way there in a step, or as fast as it would fall over
so many spacings while it has to go one; and from so many spacings of slack on."""
PACE, PRESSED = 0.15, 0.05
"""Slack falls at this share of a particle's pace, less where it is compressed, and not at all from this compression."""
FULL = 1.001
"""Spacings between two half-spaces, with the slack that what is between them has, up to which there is a single layer:
no less is left for it."""
TIGHTEST = 0.5
"""Spacings of a gap under which what is caught does not get any denser."""


@ti.func
def facing(one: vec3, other: vec3):
    """Whether two surfaces with these normals face each other."""
    return one.dot(other) < OPPOSITE


@ti.func
def openness(gap: real, spacing: real, slim: ti.i32) -> real:
    """How far what particles do in a gap between two solids is what a fluid would do: between none and all of it.

    One or two layers of particles press on what encloses them by how well they fit in, as molecules do (Israelachvili
    2011, ch. 15), and not by the pressure around: that of films has to act instead
    (`sim.coupling.fluid_rigid.lubrication`). A slim body weighs so little against that pressure that it would tremble,
    and stir the fluid.
    """
    least, most = ti.select(slim == 1, SLIM_NARROW, NARROW), ti.select(slim == 1, SLIM_WIDE, WIDE)
    s = ti.math.clamp((gap / spacing - least) / (most - least), 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


@ti.func
def missing_room(one: vec4, other: vec4, least: real, spacing: real) -> real:
    """By how much two half-spaces are nearer to what is between them than to a layer [m], as far as they face each
    other: not at all where the cosine of their angle is `least`."""
    opposed = ti.math.clamp((-one.xyz.dot(other.xyz) - least) / (STRAIGHT - least), 0.0, 1.0)
    return 0.5 * opposed * (spacing - one.w - other.w)


@ti.func
def most_missing_room(first: ti.i32, last: ti.i32, walls: ti.template()) -> real:
    """The slack that the tightest of the gaps around a particle gives it [m]."""
    most = ti.cast(0.0, real)
    for e in range(first, last):
        for other in range(first, e):
            if walls.solid[other] != walls.solid[e]:
                most = ti.max(most, missing_room(walls.face[e], walls.face[other], WEDGE, walls.spacing))
    return most


@ti.func
def slack_after(slack: real, dt: real, v: vec3, compression: real, fall: real) -> real:
    """What is left of a slack [m] after dt [s]: it falls as a particle moves with v, and where it is at rest as one
    that has fallen; fall: g d [m^2/s^2]."""
    pace = PACE * ti.sqrt(fall + v.dot(v)) * ti.math.clamp(1.0 - compression / PRESSED, 0.0, 1.0)
    return ti.max(slack - dt * pace, 0.0)


@ti.func
def steered(
    v: vec3,
    x: vec3,
    dt: real,
    fall: real,
    slack: real,
    first: ti.i32,
    last: ti.i32,
    walls: ti.template(),
) -> vec3:
    """The velocity of a particle with slack: to the middle of the gap that it is in, and out of
    surfaces that it is in by more than that."""
    spacing = walls.spacing
    along, tightest, kept = v, ti.cast(0.0, real), ti.cast(0.0, real)
    for e in range(first, last):
        for other in range(first, e):
            tight = missing_room(walls.face[e], walls.face[other], INCLINED, spacing)
            if walls.solid[other] != walls.solid[e] and tight > tightest:
                tightest, kept = tight, ti.min(tight / (LED * spacing), 1.0)
                normal = (walls.face[e].xyz - walls.face[other].xyz).normalized()
                off = 0.5 * (walls.face[other][DISTANCE] - walls.face[e][DISTANCE])
                one = surface_velocity(walls.solid[e], x, walls.pose)
                two = surface_velocity(walls.solid[other], x, walls.pose)
                rate = rate_of(ti.abs(normal.dot(one - two)) + ti.sqrt(fall), dt, spacing)
                along += kept * (rate * off + normal.dot(0.5 * (one + two) - along)) * normal
    stopped = (1.0 - kept) * ti.min(slack / (LED * spacing), 1.0)
    for e in range(first, last):
        if walls.face[e][DISTANCE] < 0.5 * spacing:
            out = ti.max(0.5 * spacing - walls.face[e][DISTANCE] - slack, 0.0) * rate_of(ti.sqrt(fall), dt, spacing)
            speed = walls.face[e].xyz.dot(along - surface_velocity(walls.solid[e], x, walls.pose))
            along += stopped * ti.max(out - speed, 0.0) * walls.face[e].xyz
    return along


@ti.func
def velocity_in_gap(
    e: ti.i32,
    x: vec3,
    first: ti.i32,
    last: ti.i32,
    walls: ti.template(),
) -> vec3:
    """The velocity [m/s] of a half-space as fluid at x feels it. In a gap narrower than a layer it is what both sides
    have in common: the layer there gets denser while they close, and would be squeezed out without need."""
    own = surface_velocity(walls.solid[e], x, walls.pose)
    found = own
    for other in range(first, last):
        opposed = walls.solid[other] != walls.solid[e] and facing(walls.face[e].xyz, walls.face[other].xyz)
        if opposed and walls.face[e][DISTANCE] + walls.face[other][DISTANCE] < FULL * walls.spacing:
            found = 0.5 * (own + surface_velocity(walls.solid[other], x, walls.pose))
    return found


@ti.func
def rate_of(speed: real, dt: real, spacing: real) -> real:
    """At which a particle is led [1/s] where this is the speed [m/s] of what moves it."""
    return ti.min(CENTRED / dt, LEAD * speed / spacing)


@ti.func
def allowed_excess(slack: real, spacing: real) -> real:
    """By how much a particle may be denser than the fluid, over that: what is d thick has d - 2 slack of room."""
    return 2.0 * slack / ti.max(spacing - 2.0 * slack, TIGHTEST * spacing)


@ti.func
def pressing_density(density: real, rest_density: real, excess: real) -> real:
    """The density that pressure is to act on, of a particle that may be denser by this `excess` over the fluid's."""
    return density - ti.math.clamp(density - rest_density, 0.0, excess * rest_density)
