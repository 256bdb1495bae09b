"""What a run keeps in memory: at most 1 kB a particle, lists of neighbours included, and all of it is counted."""

from __future__ import annotations

import json

import pytest

from tests.solvers import STRESSED
from tests.stress.scenes import assert_nothing_broken

MOST = 1000
"""Bytes a particle."""


@pytest.mark.parametrize("solver", STRESSED)
def test_a_particle_takes_a_kilobyte_at_most(simulate, solver):
    """27 000 particles in half of a box with plane walls, whose lists have grown as far as they will at rest."""
    side = 0.6
    scene = {
        "fps": 1000,
        "containers": {"tank": {"type": "box", "size": [side, side, side]}},
        "fluid": {
            "solver": solver,
            "particle_radius": 0.01,
            "bodies": {"pool": {"shape": {"type": "box", "size": [side, side, side]}, "position": [0, side / 2, 0]}},
        },
    }
    out = simulate(scene, 1, threads=1)
    assert_nothing_broken(out)
    told = json.loads((out / "summary.json").read_text())
    count = told["counts"]["particles"]
    assert count == 27_000
    lists = 4 * 30
    assert lists * count < told["bytes"]["fluid"] <= MOST * count
    print(f"{solver}: {told['bytes']['fluid'] / count:.0f} bytes a particle")
