"""What `sim check` says of a scene."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.checks.preview import preview
from sim.spec import SimulationSpec

PLANE = {"shape": {"type": "plane"}}
BALL = {"shape": {"type": "sphere", "radius": 0.1}, "position": [0, 1, 0]}
TANK = {"type": "box", "size": [1, 1, 1], "open": ["top"]}


@pytest.mark.parametrize(
    ("bodies", "containers", "told"),
    [
        ({}, {}, "0 solids"),
        ({"floor": PLANE}, {}, "1 solid"),
        ({"floor": PLANE, "ball": BALL}, {"tank": TANK}, "3 solids"),
    ],
)
def test_planes_bodies_and_containers_are_solids(bodies, containers, told):
    sheet = {"shape": {"type": "sheet", "size": [0.2, 0.2]}, "position": [0, 0.5, 0], "spacing": 0.1}
    spec = {"fps": 24, "containers": containers, "cloth": {"sheets": {"sheet": sheet}}}
    if bodies:
        spec["rigid"] = {"bodies": bodies}
    assert preview(SimulationSpec.model_validate(spec), Path()).contents == f"9 points of cloth; {told}"
