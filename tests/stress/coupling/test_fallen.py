"""What falls out of the scene: it costs nothing, it is told, and what is taken out of the scene is gone for good."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from sim.fluid.time_step_limits import fall_limit
from sim.run.placing.placed_scene import LEAST_DEPTH
from tests.stress.scenes import assert_nothing_broken
from tests.support.fluid.solvers import STRESSED
from tests.support.in_time import in_time
from tests.support.particles import positions, read_frame, read_table

SPACING, G = 0.04, 9.81
BODIES_STEP = 0.004
"""The longest step that dynamic bodies have [s]."""
TOP = 0.05
"""Height of the table [m], whose lower side is at -TOP."""


def spill(solver: str, **rest) -> dict:
    """A few drops that miss a table, and a ball that does."""
    return {
        "fps": 20,
        "fluid": {
            "solver": solver,
            "particle_radius": SPACING / 2,
            "bodies": {
                f"drop{k}": {
                    "shape": {"type": "box", "size": [SPACING] * 3},
                    "position": [0.4 + 0.2 * k, 0.2, 0],
                }
                for k in range(3)
            },
        },
        "rigid": {
            "bodies": {
                "table": {"shape": {"type": "box", "size": [0.4, 2 * TOP, 0.4]}, "motion": "static"},
                "ball": {
                    "shape": {"type": "sphere", "radius": 0.02},
                    "position": [-0.5, 0.2, 0],
                    "density": 500,
                    "motion": "dynamic",
                },
            }
        },
    } | rest


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", [name for name in STRESSED if name != "wcsph"])
def test_what_falls_alone_does_not_limit_the_step(simulate, solver):
    """Drops that have fallen below all else meet nothing: at any speed the step is that of a fluid at rest."""
    scene = spill(solver)
    del scene["rigid"]["bodies"]["ball"]
    out = simulate(scene, 11, threads=1)
    assert_nothing_broken(out)
    steps = read_table(out / "steps.csv")
    at_rest = fall_limit(SPACING, G)
    assert steps["v_max"][-1] * at_rest > 0.4 * SPACING, "the way that particles may go in a step"
    per_frame = math.ceil(1 / 20 / at_rest)
    assert (steps["time"] > 0.5 + 1e-9).sum() <= per_frame + 1


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", ["dfsph", *in_time("wcsph")])
def test_what_has_fallen_out_of_the_scene_is_gone_and_told(simulate, capfd, solver):
    """By y = y0 - g t^2 / 2 it is 5 m, over the size of the scene, below the table at sqrt(2 (y0 + TOP + 5) / g)."""
    out = simulate(spill(solver), 24, threads=1, quiet=False)
    assert_nothing_broken(out)
    out_at = math.sqrt(2 * (0.2 + TOP + LEAST_DEPTH) / G)
    present = [len(read_frame(out, frame)) for frame in range(25)]
    last = math.ceil(out_at * 20)
    assert present == [3] * (last + 1) + [0] * (24 - last)
    counts = json.loads((out / "summary.json").read_text())["counts"]
    assert counts["particles_fallen"] == 3 and counts["particles"] == 0
    assert capfd.readouterr().err.count("falls out of the scene") == 1
    before = positions(read_frame(out, last))[:, 1]
    assert before == pytest.approx(0.2 - G * (last / 20) ** 2 / 2, rel=0.02)


@pytest.mark.outcome("A")
@pytest.mark.parametrize(
    "change",
    [
        {"gravity": [0, 0, 0]},
        {
            "rigid": {
                "bodies": {
                    "lift": {
                        "shape": {"type": "box", "size": [0.4, 0.1, 0.4]},
                        "motion": "prescribed",
                        "velocity": [0, -1, 0],
                    }
                }
            }
        },
    ],
    ids=["no gravity", "a lift that goes on for ever"],
)
def test_what_may_still_be_caught_stays(simulate, change):
    out = simulate(spill("dfsph", **change), 24, threads=1)
    assert len(read_frame(out, 24)) == 3


@pytest.mark.slow
def test_a_floor_keeps_everything(simulate):
    floor = {"ground": {"shape": {"type": "plane"}, "position": [0, -6, 0], "motion": "static"}}
    scene = spill("dfsph")
    scene["rigid"]["bodies"] |= floor
    out = simulate(scene, 23, threads=1)
    assert len(read_frame(out, 23)) == 3


@pytest.mark.slow
def test_a_resumed_run_loses_the_same(simulate):
    whole = simulate(spill("dfsph"), 23, "whole", threads=1)
    part = simulate(spill("dfsph"), 20, "part", threads=1)
    rest = simulate(spill("dfsph"), 23, "rest", first=21, state=part / "state_00020.npz", threads=1)
    counts = [json.loads((out / "summary.json").read_text())["counts"] for out in (whole, rest)]
    assert counts[0]["particles_fallen"] == counts[1]["particles_fallen"] == 3
    assert (whole / "fluid_00023.ply").read_bytes() == (rest / "fluid_00023.ply").read_bytes()


def test_a_ball_that_has_fallen_away_does_not_limit_the_step(simulate):
    """Others may go half of their own size in a step; it goes on for ever."""
    scene = spill("dfsph")
    out = simulate(scene | {"fluid": None}, 40, threads=1)
    steps = read_table(out / "steps.csv")
    assert np.sqrt(2 * steps["rigid_kinetic_energy"][-1] / 500 / (4 / 3 * np.pi * 0.02**3)) * BODIES_STEP > 0.02
    assert (steps["time"] > 1.95 + 1e-9).sum() <= math.ceil(0.05 / BODIES_STEP) + 1
