"""Impulses of the contacts of a step: sweeps over them, and all at once where these come no nearer."""

from __future__ import annotations

from collections.abc import Mapping

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
TRIES = 2
"""Times that contacts may be solved at once."""


def solve_impulses(
    count: int,
    settings: Rigid,
    dynamic: np.ndarray,
    motion: Motion,
    arrays: Mapping[str, np.ndarray],
    tables: ContactTables,
) -> tuple[int, float]:
    """Change velocities as the laws of contacts ask for; returns sweeps and what the last one changed [m/s].

    arrays: the members of `motion`.
    """
    cap, error, contacts = settings.max_iterations, settings.contact_error, tables.pressed
    contact_solver.weigh(count, motion, contacts)
    sweeps, change, tries = 0, np.inf, 0
    while sweeps < cap and change > error:
        before = change
        more, change = contact_solver.solve(count, min(BATCH, cap - sweeps), error, motion, contacts)
        sweeps += int(more)
        if sweeps < cap and change > max(error, PROGRESS * before) and tries < TRIES:
            tries += 1
            found = settle_at_once(tables.members(count), arrays, dynamic, change, error)
            if found is not None:
                contact_solver.replace(count, motion, contacts, *found)
    return sweeps, float(change)
