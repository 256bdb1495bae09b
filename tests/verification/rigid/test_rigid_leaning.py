"""Bodies that lean on one another have contacts that contradict one another by a little."""

from __future__ import annotations

import numpy as np

from sim.rigid.dynamics import contact_impulses
from tests.support.bodies import box, ground, part, step, turn


def fall(monkeypatch, lenient: float, dt: float) -> tuple[np.ndarray, int, int]:
    """Six plates, each a little aside of the one before, of which the first falls; where all are 1.3 s later,
    how often contacts were solved at once, and steps in which they were not solved."""
    at_once, capped = [], []
    settle = contact_impulses.settle_at_once
    monkeypatch.setattr(contact_impulses, "LENIENT", lenient)
    monkeypatch.setattr(contact_impulses, "settle_at_once", lambda *given: at_once.append(1) or settle(*given))
    surface = {"friction": 0.3, "restitution": 0}
    plates = {
        f"plate{k}": box(
            (0.05, 0.4, 0.2),
            position=[0.12 * k, 0.2, 0.003 * k],
            rotation=turn((0, 0, 1), 0 if k else -0.2),
            **surface,
        )
        for k in range(6)
    }
    row = part(plates | {"floor": ground(friction=1.0)}, max_step=dt)
    step(row, 1.3, lambda _: capped.append(row.stats["contacts_capped"]))
    monkeypatch.undo()
    return row.position[row.dynamic], len(at_once), sum(capped)


def test_what_contacts_contradict_one_another_is_let_be_where_nobody_sees_it(monkeypatch):
    """It moves bodies by less than a step of half the length does."""
    exact, often, unsolved = fall(monkeypatch, 0.0, 2e-3)
    finer, *_ = fall(monkeypatch, 0.0, 1e-3)
    found, seldom, still = fall(monkeypatch, contact_impulses.LENIENT, 2e-3)
    assert np.abs(found - exact).max() < 0.5 * np.abs(exact - finer).max()
    assert seldom < 0.5 * often and still < 0.5 * unsolved
    assert unsolved >= 10, "plates that contradict nothing try nothing"
