"""The theory that dominoes are judged by: its mechanics, and that its own steps are small enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.validation import domino_wave
from tests.validation.domino_wave import NUDGE, G, Row, arrivals
from tests.validation.rigid_peers import ROW, SEEN, START

SLICK = replace(ROW, friction=0.0)


def energy(row: Row, foremost: float, spin: float, number: int) -> float:
    """Of all that lean on one another, for a unit of mass each [J/kg]."""
    low, tilts, high = (row.tilts(np.array(foremost + nudge), number) for nudge in (-NUDGE, 0.0, NUDGE))
    spins = (high - low) / (2 * NUDGE) * spin
    inertia = (row.height**2 + row.thickness**2) / 3
    middle = (row.height * np.cos(tilts) + row.thickness * np.sin(tilts)) / 2
    return float((inertia * spins**2 / 2 + G * middle).sum())


@pytest.mark.parametrize("number", [1, 2, 8])
def test_energy_is_kept_between_blows_without_friction(number):
    tilts, _, spins = SLICK.fall(number, 0.0, 9.0)
    before, after = (energy(SLICK, tilts[k], spins[k], number) for k in (0, -1))
    given = energy(SLICK, tilts[0], 0.0, number) - energy(SLICK, tilts[-1], 0.0, number)
    assert after == pytest.approx(before, abs=1e-4 * given)


@pytest.mark.parametrize("number", [1, 8])
def test_a_blow_takes_energy(number):
    struck = SLICK.blow(number)
    before = energy(SLICK, SLICK.striking, 1.0, number) - energy(SLICK, SLICK.striking, 0.0, number)
    after = energy(SLICK, 0.0, struck, number + 1) - energy(SLICK, 0.0, 0.0, number + 1)
    assert 0 < after < before


def test_smaller_steps_change_little(monkeypatch):
    coarse = arrivals(ROW, START, SEEN)
    monkeypatch.setattr(domino_wave, "STEPS", 10 * domino_wave.STEPS)
    assert coarse == pytest.approx(arrivals(ROW, START, SEEN), rel=1e-4)
