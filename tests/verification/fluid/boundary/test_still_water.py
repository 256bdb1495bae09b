"""Water at rest around a solid stays at rest.

A lattice of particles that is cut to fit around a solid first settles, which sets it moving; after that nothing may do
work on it, and its kinetic energy falls. A pressure that is the same everywhere must not push along a surface.
"""

from __future__ import annotations

import pytest

from tests.support.in_time import in_time
from tests.support.particles import read_table

SPACING = 0.015
TANK, DEPTH = (0.36, 0.4, 0.3), 0.18
SETTLED, END = 0.5, 1.5
"""[s]"""

SOLIDS = {
    "box on the ground": {"shape": {"type": "box", "size": [0.1, 0.06, 0.1]}, "position": [0, 0.03, 0]},
    "box in the middle": {"shape": {"type": "box", "size": [0.1, 0.06, 0.1]}, "position": [0, 0.09, 0]},
    "pillar": {"shape": {"type": "box", "size": [0.1, 0.3, 0.1]}, "position": [0, 0.15, 0]},
    "plate": {"shape": {"type": "box", "size": [0.12, 0.01, 0.12]}, "position": [0, 0.005, 0]},
    "cylinder": {"shape": {"type": "cylinder", "radius": 0.05, "height": 0.06}, "position": [0, 0.03, 0]},
}


@pytest.mark.parametrize("name", [*list(SOLIDS)[:1], *in_time(*list(SOLIDS)[1:])])
def test_nothing_feeds_a_current_around_a_solid(simulate, name):
    data = {
        "fps": 10,
        "containers": {"tank": {"type": "box", "size": list(TANK)}},
        "fluid": {
            "solver": "dfsph",
            "particle_radius": SPACING / 2,
            "bodies": {
                "water": {"shape": {"type": "box", "size": [TANK[0], DEPTH, TANK[2]]}, "position": [0, DEPTH / 2, 0]}
            },
        },
        "rigid": {"bodies": {"solid": SOLIDS[name]}},
    }
    table = read_table(simulate(data, round(10 * END), threads=1) / "steps.csv")
    time, energy = table["time"], table["kinetic_energy"]
    half = (SETTLED + END) / 2
    early, late = ((time > since) & (time <= until) for since, until in ((SETTLED, half), (half, END)))
    assert energy[late].mean() < energy[early].mean()
