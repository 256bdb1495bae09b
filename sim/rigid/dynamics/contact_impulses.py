"""Impulses of the contacts of a step: sweeps over them, and all at once where these come no nearer."""

from __future__ import annotations

import numpy as np

from sim.rigid.collision.arrays import ContactTables
from sim.rigid.dynamics import contact_solver
from sim.rigid.dynamics.simultaneous import settle_at_once
from sim.rigid.layout import Motion
from sim.rigid.spec import Rigid

BATCH = 50
"""Sweeps after which it is looked whether they come nearer,"""
PROGRESS = 0.1
"""by what they changed last, as a share of what it was before."""
SLOW = 4
"""Batches that come no nearer, after which contacts are solved at once: that takes as long as thousands of sweeps, and
some come nearer yet."""
TRIES = 2
"""Times that contacts may be solved at once."""
LENIENT = 1e3
"""Where sweeps come no nearer, so many times the error that is asked for may be left, for each m/s by which a contact
has changed a velocity in the step. The corners of a face that turns contradict one another by so much, and sweeps would
only shift impulses between them."""


def solve_impulses(
    count: int,
    settings: Rigid,
    dynamic: np.ndarray,
    motion: Motion,
    tables: ContactTables,
) -> tuple[int, float, bool]:
    """Change velocities as the laws of contacts ask for; returns sweeps, what the last one changed [m/s], and whether
    that is more than may be left."""
    cap, error, contacts = settings.max_iterations, settings.contact_error, tables.pressed
    sweeps, change, slow, tries = 0, np.inf, 0, 0
    while sweeps < cap and change > error:
        before = change
        contact_solver.solve(count, int(sweeps == 0), min(BATCH, cap - sweeps), error, motion, contacts, tables.outcome)
        more, change = tables.outcome.tolist()
        sweeps += int(more)
        if change <= max(error, PROGRESS * before):
            continue
        enough = max(error, LENIENT * error * _exchanged(count, tables))
        if change <= enough:
            return sweeps, change, False
        slow += 1
        if sweeps < cap and slow % SLOW == 0 and tries < TRIES:
            tries += 1
            found = settle_at_once(tables.members(count), dict(motion.items), dynamic, change, enough)
            if found is not None:
                contact_solver.replace(count, motion, contacts, *found)
    return sweeps, change, change > error


def _exchanged(count: int, tables: ContactTables) -> float:
    """The greatest change of a relative velocity by the impulse of one contact [m/s]."""
    return float((tables.table["normal_impulse"][:count] / tables.table["normal_mass"][:count]).max())
