"""Which scenes take one thread, and that they go on so."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from sim.run.checkpoint import Checkpoint
from sim.run.one_thread import takes_one_thread
from sim.run.stepping import Run
from sim.spec import SimulationSpec

DROP = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [0, 0.3, 0]}
WATER = {"particle_radius": 0.0125, "bodies": {"drop": DROP}}
TAP = {"emitters": {"tap": {"shape": {"type": "disc", "radius": 0.1}, "speed": 1}}}
BOX = {"shape": {"type": "box", "size": [0.1] * 3}, "motion": "dynamic", "density": 500}
SHEET = {"shape": {"type": "sheet", "size": [1, 1]}}


@pytest.mark.parametrize(
    ("particles", "made", "one"),
    [
        (4_999, {"fluid": {"solver": "dfsph"}}, True),
        (5_000, {"fluid": {"solver": "dfsph"}}, False),
        (4_999, {"fluid": {"solver": "wcsph"}}, False),
        (1_999, {"fluid": {"solver": "wcsph"}}, True),
        (100, {"fluid": {"solver": "dfsph", **TAP}}, False),
        (0, {"cloth": {"sheets": {"a": SHEET | {"spacing": 0.01}}}}, True),
        (0, {"cloth": {"sheets": {"a": SHEET | {"spacing": 0.005}}}}, False),
        (0, {"rigid": {"bodies": {"box": BOX}}}, True),
        (5_000, {"fluid": {"solver": "dfsph"}, "rigid": {"bodies": {"box": BOX}}}, False),
    ],
)
def test_small_scenes_take_one(particles, made, one):
    fluid = {"fluid": WATER | made["fluid"]} if "fluid" in made else {}
    world = Run(SimulationSpec.model_validate({"fps": 24, **made, **fluid}), Path("/"), warn=lambda _: None).world
    assert takes_one_thread(world, particles) is one


def test_a_run_goes_on_as_it_began(simulate):
    """Also where it is small no longer, or small by now: threads decide how its numbers are rounded."""
    spec = {"fps": 50, "fluid": WATER | {"solver": "dfsph"}}
    out = simulate(spec, 1)
    assert json.loads((out / "summary.json").read_text())["one_thread"] is True
    state = Checkpoint.load(out / "state_00001.npz", SimulationSpec.model_validate(spec))
    assert state.one_thread
    for one in (True, False):
        state.one_thread = one
        run = Run(SimulationSpec.model_validate(spec), Path("/"), arch="cpu", warn=lambda _: None)
        run.resume(state)
        assert run.one_thread is one
        assert run.checkpoint().one_thread is one
