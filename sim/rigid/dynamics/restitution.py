"""Bounces: what contacts that are struck in a step leave each other with (Newton 1687, Guendelman et al. 2003).

Where bodies meet, and how fast by then, follows from the gap and the acceleration: so a bounce neither gains nor loses
energy by the length of the step. A blow goes from pair to pair as it does along Newton's cradle; the contacts of one
pair are struck together, so that a box which lands flat bounces flat.
"""

import taichi as ti

from sim.device.double import Integers, Numbers, Vectors
from sim.rigid.dynamics.contact_solver import Contacts, Motion, relative, relative_velocity, strike

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
    old_velocity: Vectors,
    old_spin: Vectors,
    free_velocity: Vectors,
    free_spin: Vectors,
    motion: Motion,
    contacts: Contacts,
    restitution: Numbers,
    braked: Integers,
    extra: Numbers,
    slow: Numbers,
    struck: Integers,
    bounce: Numbers,
) -> ti.i32:
    """Which contacts are struck; returns how many. Velocities: old before the step, free at
    its end if there were no contact.

    extra: how much faster bodies will be along the normal when they meet [m/s]; slow: what gravity [m/s^2] does in
    two steps [m/s], which is no blow, for bodies would never come to rest; bounce: the restitution, or less where
    something else has braked one of the bodies: a contact gives back no more than its share of what it stopped, of its
    impulse (Poisson 1833).
    """
    found = 0
    for c in range(count):
        n = contacts.normal[c]
        early = n.dot(relative(old_velocity, old_spin, motion, contacts, c))
        change = n.dot(relative(free_velocity, free_spin, motion, contacts, c)) - early
        speed = early
        if gap[c] > 0.0:
            speed = -ti.sqrt(ti.max(early * early - 2.0 * change / dt * gap[c], 0.0))
        extra[c] = ti.min(speed - early, 0.0) if contacts.push[c] > 0.0 else 0.0
        slow[c] = 2.0 * ti.max(abs(change), dt * gravity) + 1e-9
        struck[c] = 0
        bounce[c] = restitution[c]
        if braked[contacts.body[2 * c]] + braked[contacts.body[2 * c + 1]] > 0:
            left = n.dot(relative_velocity(motion, contacts, c))
            stopped = contacts.push[c] / contacts.along[c] - ti.min(left, 0.0)
            bounce[c] *= ti.min(stopped / ti.max(-early - extra[c], 1e-12), 1.0)
        if contacts.push[c] > 0.0:
            struck[c] = 1
            if early + extra[c] < -slow[c] and restitution[c] > 0.0:
                struck[c] = 2
                found += 1
    return found


@ti.kernel
def rebound(
    pairs: ti.i32,
    number: Integers,
    first: Integers,
    most: ti.i32,
    slow: Numbers,
    motion: Motion,
    contacts: Contacts,
    bounce: Numbers,
    extra: Numbers,
    struck: Integers,
    target: Numbers,
    blow: Numbers,
) -> ti.i32:
    """Strike one pair after the other until no two bodies approach; returns the number of rounds.

    `motion` is a copy of the velocities before the step; what comes out is written to `target`, the relative velocity
    along the normal that every contact is to have at least; one that is not struck yet has its turn in the next step.
    """
    rounds = 0
    ti.loop_config(serialize=True)
    for _ in range(1):
        again = True
        while again and rounds < most:
            again = False
            for k in range(pairs):
                fast, change = False, ti.cast(0.0, ti.f64)
                for c in range(first[k], first[k] + number[k]):
                    blow[c] = 0.0
                    target[c] = 0.0
                    if struck[c] > 0:
                        speed = contacts.normal[c].dot(relative_velocity(motion, contacts, c)) + extra[c]
                        if speed < -slow[c]:
                            fast, change = True, ti.max(change, -speed)
                            target[c] = -bounce[c] * speed
                if fast:
                    again = True
                    least, sweeps = EVEN * change, 0
                    while change > least and sweeps < WITHIN:
                        sweeps += 1
                        change = 0.0
                        for c in range(first[k], first[k] + number[k]):
                            if struck[c] > 0:
                                n = contacts.normal[c]
                                speed = n.dot(relative_velocity(motion, contacts, c)) + extra[c]
                                more = ti.max(blow[c] + contacts.along[c] * (target[c] - speed), 0.0) - blow[c]
                                blow[c] += more
                                change = ti.max(change, abs(more) / contacts.along[c])
                                strike(motion, contacts, c, more * n)
                                if blow[c] > 0.0:
                                    struck[c] = 2
            rounds += 1
    for k in range(pairs):
        for c in range(first[k], first[k] + number[k]):
            target[c] = -UNLIMITED
            if struck[c] > 0:
                target[c] = 0.0
            if struck[c] == 2:
                speed = contacts.normal[c].dot(relative_velocity(motion, contacts, c)) + extra[c]
                target[c] = ti.max(speed, 0.0)
    return rounds
