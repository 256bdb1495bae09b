"""Impulses of all contacts together: projected Gauss-Seidel on velocities, with Coulomb's round cone.

At every contact the relative velocity along the normal may not be below the limit that the gap leaves for the step,
the impulse along it pulls nowhere, and one of them is at rest (Signorini). Friction opposes sliding with the
coefficient mu times the normal impulse, or holds with less (Coulomb); it is projected onto the disc, not a pyramid
(Moreau 1988; Jean 1999). Sweeps go on until no relative velocity is changed by more than asked for. Between them
impulses go on along a conjugate direction, without which a heavy body on a light one would take thousands of sweeps
(NNCG, Silcowitz-Hansen et al. 2010).
"""

from sim.device.compiler import ti
from sim.device.double import Numbers, Vectors, cross_matrix, mat3, vec3
from sim.rigid.layout import Contacts, Motion


@ti.func
def _mobility(motion: ti.template(), body: ti.i32, place: vec3) -> mat3:
    """Change of velocity at a place of a body by an impulse there [1/kg]."""
    arm = cross_matrix(place - motion.position[body])
    turning = arm @ motion.inverse_inertia[body] @ arm
    unit = mat3([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    return unit * motion.inverse_mass[body] - turning


@ti.func
def relative_velocity(motion: ti.template(), contacts: ti.template(), c: ti.i32) -> vec3:
    """Of the first body as seen from the second, where they touch [m/s]."""
    return relative(motion.velocity, motion.spin, motion, contacts, c)


@ti.func
def relative(
    velocity: ti.template(), spin: ti.template(), motion: ti.template(), contacts: ti.template(), c: ti.i32
) -> vec3:
    """The same with other velocities than those of `motion`."""
    a, b, place = contacts.body[2 * c], contacts.body[2 * c + 1], contacts.place[c]
    at_a = velocity[a] + spin[a].cross(place - motion.position[a])
    at_b = velocity[b] + spin[b].cross(place - motion.position[b])
    return at_a - at_b


@ti.func
def strike(motion: ti.template(), contacts: ti.template(), c: ti.i32, impulse: vec3):
    """An impulse [N s] on the first body and its opposite on the second, at one place."""
    a, b, place = contacts.body[2 * c], contacts.body[2 * c + 1], contacts.place[c]
    turn_a = (place - motion.position[a]).cross(impulse)
    turn_b = (place - motion.position[b]).cross(impulse)
    motion.velocity[a] += motion.inverse_mass[a] * impulse
    motion.spin[a] += motion.inverse_inertia[a] @ turn_a
    motion.momentum[a] += turn_a
    motion.velocity[b] -= motion.inverse_mass[b] * impulse
    motion.spin[b] -= motion.inverse_inertia[b] @ turn_b
    motion.momentum[b] -= turn_b


@ti.kernel
def solve(
    count: ti.i32, begin: ti.i32, most: ti.i32, error: ti.f64, motion: Motion, contacts: Contacts, outcome: Numbers
):
    """Sweep at most `most` times, until no relative velocity changes by more than `error` [m/s].

    begin: 1 to find effective masses first, and to apply the impulses that are there already. Written: the number of
    sweeps and the greatest change in the last [m/s].
    """
    if begin == 1:
        for c in range(count):
            _weigh(motion, contacts, c)
    ti.loop_config(serialize=True)
    for _ in range(1):
        if begin == 1:
            for c in range(count):
                pressing = contacts.normal_impulse[c] * contacts.normal[c]
                strike(motion, contacts, c, pressing + contacts.friction_impulse[c])
        sweeps, last, change = 0, ti.cast(0.0, ti.f64), error + 1.0
        while sweeps < most and change > error:
            if sweeps == 1:
                for c in range(count):
                    contacts.search_direction[c] = contacts.impulse_change[c]
            elif sweeps > 1:
                _go_on(count, motion, contacts, last)
            last = _energy(count, contacts)
            change = 0.0
            for c in range(count):
                change = ti.max(change, _settle(motion, contacts, c))
            sweeps += 1
        outcome[0], outcome[1] = sweeps, change


@ti.func
def _weigh(motion: ti.template(), contacts: ti.template(), c: ti.i32):
    """Find the effective masses of a contact, and its response."""
    at, n = contacts.place[c], contacts.normal[c]
    mobility = _mobility(motion, contacts.body[2 * c], at) + _mobility(motion, contacts.body[2 * c + 1], at)
    contacts.normal_response[c] = mobility @ n
    contacts.normal_mass[c] = 1.0 / n.dot(contacts.normal_response[c])
    # The greatest mobility across: of a smaller one, friction would point elsewhere than against sliding.
    u = n.cross(vec3(1.0, 0.0, 0.0) if abs(n[0]) < 0.5 else vec3(0.0, 1.0, 0.0)).normalized()
    v = n.cross(u)
    uu, uv, vv = u.dot(mobility @ u), u.dot(mobility @ v), v.dot(mobility @ v)
    half = 0.5 * (uu - vv)
    contacts.tangent_mass[c] = 1.0 / (0.5 * (uu + vv) + ti.sqrt(half * half + uv * uv))
    contacts.friction_impulse[c] -= n * n.dot(contacts.friction_impulse[c])


@ti.kernel
def replace(count: ti.i32, motion: Motion, contacts: Contacts, push: Numbers, drag: Vectors):
    """Take these impulses for the ones that there are."""
    ti.loop_config(serialize=True)
    for c in range(count):
        more = (push[c] - contacts.normal_impulse[c]) * contacts.normal[c] + drag[c] - contacts.friction_impulse[c]
        contacts.normal_impulse[c], contacts.friction_impulse[c] = push[c], drag[c]
        strike(motion, contacts, c, more)


@ti.func
def _energy(count: ti.i32, contacts: ti.template()) -> ti.f64:
    """Square of what the last sweep added, weighted by mobility [J]."""
    total = ti.cast(0.0, ti.f64)
    for c in range(count):
        total += contacts.impulse_change[c].norm_sqr() / contacts.normal_mass[c]
    return total


@ti.func
def _go_on(count: ti.i32, motion: ti.template(), contacts: ti.template(), last: ti.f64):
    """Add the former direction by the ratio of two sweeps' squares, or begin anew where they grow."""
    share = _energy(count, contacts) / last
    for c in range(count):
        direction = contacts.search_direction[c]
        if share <= 1.0:
            impulse = share * direction
            push = contacts.normal[c].dot(impulse)
            contacts.normal_impulse[c] += push
            contacts.friction_impulse[c] += impulse - push * contacts.normal[c]
            strike(motion, contacts, c, impulse)
            contacts.search_direction[c] = impulse + contacts.impulse_change[c]
        else:
            contacts.search_direction[c] = vec3(0.0)


@ti.func
def _settle(motion: ti.template(), contacts: ti.template(), c: ti.i32) -> ti.f64:
    """Change the impulses of one contact to what its own laws ask for; returns by how much its velocity changes."""
    n, velocity = contacts.normal[c], relative_velocity(motion, contacts, c)
    push = ti.max(contacts.normal_impulse[c] + contacts.normal_mass[c] * (contacts.limit[c] - n.dot(velocity)), 0.0)
    more = push - contacts.normal_impulse[c]
    contacts.normal_impulse[c] = push
    impulse, change = more * n, abs(more) / contacts.normal_mass[c]

    drag = contacts.friction_impulse[c]
    if push > 0.0 or drag.norm_sqr() > 0.0:
        sliding = velocity + more * contacts.normal_response[c] + contacts.arc_velocity[c]
        sliding -= n * n.dot(sliding)
        wanted = drag - contacts.tangent_mass[c] * sliding
        length = wanted.norm()
        if length > contacts.static_friction[c] * push:
            wanted *= ti.min(contacts.kinetic_friction[c] * push / length, 1.0)
        contacts.friction_impulse[c] = wanted
        impulse += wanted - drag
        change = ti.max(change, (wanted - drag).norm() / contacts.tangent_mass[c])
    contacts.impulse_change[c] = impulse
    if change > 0.0:
        strike(motion, contacts, c, impulse)
    return change
