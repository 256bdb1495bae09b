"""Bounces: what contacts that are struck in a step leave each other with (Newton 1687, Guendelman et al. 2003).

Where bodies meet, and how fast by then, follows from the gap and the acceleration: so a bounce neither gains nor loses
energy by the length of the step. A blow goes from pair to pair as it does along Newton's cradle; the contacts of one
pair are struck together, so that a box which lands flat bounces flat.
"""

from sim.device.compiler import ti
from sim.device.double import Integers, Numbers
from sim.rigid.dynamics.contact_solver import relative, relative_velocity, strike
from sim.rigid.layout import Bounces, Contacts, Motion, Pairs, StepVelocities

WITHIN = 1000
"""Most sweeps over the contacts of one pair."""
EVEN = 1e-9
"""They end when none changes a relative velocity by more than this share of the fastest approach."""
UNLIMITED = 1e9
"""Speed [m/s] that no contact has."""


@ti.kernel
def approach(
    count: ti.i32,
    dt: ti.f64,
    gravity: ti.f64,
    gap: Numbers,
    braked: Integers,
    velocities: StepVelocities,
    motion: Motion,
    contacts: Contacts,
    bounces: Bounces,
) -> ti.i32:
    """Which contacts are struck; returns how many.

    Written: how much faster bodies will be along the normal when they meet; `slow`, what gravity [m/s^2] does in two
    steps, which is no blow, for bodies would never come to rest; `bounce`, the restitution, or less where something
    else has `braked` one of the bodies: a contact gives back no more than its share of what it stopped, of its impulse
    (Poisson 1833).
    """
    found = 0
    for c in range(count):
        n = contacts.normal[c]
        early = n.dot(relative(velocities.old_velocity, velocities.old_spin, motion, contacts, c))
        change = n.dot(relative(velocities.free_velocity, velocities.free_spin, motion, contacts, c)) - early
        speed = early
        if gap[c] > 0.0:
            speed = -ti.sqrt(ti.max(early * early - 2.0 * change / dt * gap[c], 0.0))
        # A contact that opens may be closed by what others do: then it is struck as fast as they make it.
        faster = ti.max(ti.min(speed - early, 0.0), ti.min(change, 0.0))
        bounces.extra[c] = faster if contacts.normal_impulse[c] > 0.0 else 0.0
        bounces.slow[c] = 2.0 * ti.max(abs(change), dt * gravity) + 1e-9
        bounces.struck[c] = 0
        bounces.bounce[c] = bounces.restitution[c]
        if braked[contacts.body[2 * c]] + braked[contacts.body[2 * c + 1]] > 0:
            left = n.dot(relative_velocity(motion, contacts, c))
            stopped = contacts.normal_impulse[c] / contacts.normal_mass[c] - ti.min(left, 0.0)
            bounces.bounce[c] *= ti.min(stopped / ti.max(-early - bounces.extra[c], 1e-12), 1.0)
        if contacts.normal_impulse[c] > 0.0:
            bounces.struck[c] = 1
            if early + bounces.extra[c] < -bounces.slow[c] and bounces.restitution[c] > 0.0:
                bounces.struck[c] = 2
                found += 1
    return found


@ti.kernel
def rebound(
    pairs: ti.i32,
    most: ti.i32,
    near: Pairs,
    motion: Motion,
    contacts: Contacts,
    bounces: Bounces,
) -> ti.i32:
    """Strike one pair after the other until no two bodies approach; returns the number of rounds.

    `motion` is a copy of the velocities before the step; what comes out is written to `target_velocity`. A
    contact that is not struck yet has its turn in the next step.
    """
    rounds = 0
    ti.loop_config(serialize=True)
    for _ in range(1):
        again = True
        while again and rounds < most:
            again = False
            for k in range(pairs):
                fast, change = False, ti.cast(0.0, ti.f64)
                for c in range(near.first[k], near.first[k] + near.number[k]):
                    bounces.blow[c] = 0.0
                    bounces.target_velocity[c] = 0.0
                    if bounces.struck[c] > 0:
                        speed = contacts.normal[c].dot(relative_velocity(motion, contacts, c)) + bounces.extra[c]
                        if speed < -bounces.slow[c]:
                            fast, change = True, ti.max(change, -speed)
                            bounces.target_velocity[c] = -bounces.bounce[c] * speed
                if fast:
                    again = True
                    least, sweeps = EVEN * change, 0
                    while change > least and sweeps < WITHIN:
                        sweeps += 1
                        change = 0.0
                        for c in range(near.first[k], near.first[k] + near.number[k]):
                            if bounces.struck[c] > 0:
                                n = contacts.normal[c]
                                speed = n.dot(relative_velocity(motion, contacts, c)) + bounces.extra[c]
                                lacking = bounces.target_velocity[c] - speed
                                whole = ti.max(bounces.blow[c] + contacts.normal_mass[c] * lacking, 0.0)
                                more = whole - bounces.blow[c]
                                bounces.blow[c] += more
                                change = ti.max(change, abs(more) / contacts.normal_mass[c])
                                strike(motion, contacts, c, more * n)
                                if bounces.blow[c] > 0.0:
                                    bounces.struck[c] = 2
            rounds += 1
    for k in range(pairs):
        for c in range(near.first[k], near.first[k] + near.number[k]):
            bounces.target_velocity[c] = -UNLIMITED
            if bounces.struck[c] > 0:
                bounces.target_velocity[c] = 0.0
            if bounces.struck[c] == 2:
                speed = contacts.normal[c].dot(relative_velocity(motion, contacts, c)) + bounces.extra[c]
                bounces.target_velocity[c] = ti.max(speed, 0.0)
    return rounds
