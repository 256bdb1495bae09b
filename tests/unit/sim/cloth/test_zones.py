"""Points that would pass one another go on as one, and keep their momentum."""

from __future__ import annotations

import numpy as np
import pytest

from sim.cloth.contact.impact_zones import ImpactZones

MASS = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 0.0, 0.0])
"""[kg]; the last two points are fixed."""
WAYS = np.random.default_rng(1).normal(size=(7, 3))


def joined(zones: ImpactZones, pairs: list[list[int]], times: int) -> np.ndarray:
    ways = WAYS.copy()
    for _ in range(times):
        ways = zones.join(zones.add(np.array(pairs, np.int32)), ways)
    return ways


def test_a_free_zone_goes_on_with_its_momentum():
    ways = joined(ImpactZones(MASS), [[0, 1, 2, 3]], 60)
    mean = MASS[:4] @ WAYS[:4] / MASS[:4].sum()
    assert ways[:4] == pytest.approx(np.tile(mean, (4, 1)))
    assert (ways[4:] == WAYS[4:]).all()
    once = joined(ImpactZones(MASS), [[0, 1, 2, 3]], 1)
    assert MASS @ once == pytest.approx(MASS @ WAYS)
    assert np.ptp(once[:4], axis=0) == pytest.approx(0.5 * np.ptp(WAYS[:4], axis=0))


def test_a_zone_that_meets_something_fixed_goes_where_that_goes():
    ways = joined(ImpactZones(MASS), [[0, 1, 5, 6]], 60)
    assert ways[:2] == pytest.approx(np.tile(WAYS[5:].mean(axis=0), (2, 1)))
    assert (ways[5:] == WAYS[5:]).all()


def test_zones_that_share_a_point_become_one_and_stay_it():
    zones = ImpactZones(MASS)
    zones.add(np.array([[0, 1, -1, -1]], np.int32))
    zone = zones.add(np.array([[1, 2, -1, -1]], np.int32))
    assert zone[0] == zone[1] == zone[2] >= 0
    assert (zone[3:] == -1).all()
    # A pair elsewhere leaves the others alone.
    zone = zones.add(np.array([[3, 4, -1, -1]], np.int32))
    assert (zone[:3] == -1).all() and zone[3] == zone[4] >= 0
