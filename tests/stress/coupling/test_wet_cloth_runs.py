"""Runs of scenes with cloth and fluid: in two parts, with events, and through an emitter."""

from __future__ import annotations

import numpy as np
import pytest

from tests.stress.scenes import contents
from tests.support.particles import read_table
from tests.support.wet import leaks, scene

DROP = {"shape": {"type": "sphere", "radius": 0.06}, "position": [0, 0.09, 0], "velocity": [0, -6, 0]}
SHEET = {"shape": {"type": "sheet", "size": [0.3, 0.3]}, "spacing": 0.05, "pins": ["corners"], "thickness": 0.006,
         "stretch_stiffness": 30}  # fmt: skip
STRETCHING = [pytest.param("wcsph", marks=pytest.mark.slow), "dfsph"]


@pytest.mark.slow
@pytest.mark.parametrize("solver", STRETCHING)
def test_two_parts_are_the_whole(simulate, solver):
    """Also where samples are laid anew as the cloth stretches, and where pins are let go."""
    made = scene(solver, DROP, SHEET, events=[{"at": 0.045, "set": {"cloth.sheets.sheet.pins": []}}])
    whole = simulate(made, 6, "whole")
    first = simulate(made, 3, "first")
    second = simulate(made, 6, "second", first=4, state=first / "state_00003.npz")
    for files in ("cloth_*.ply", "fluid_*.ply"):
        assert contents(first, files) | contents(second, files) == contents(whole, files)
    assert contents(second, "state_00006.npz") == contents(whole, "state_00006.npz")
    assert read_table(whole / "steps.csv")["cloth_stretch"].max() > 1.3


@pytest.mark.outcome("A")
def test_nothing_goes_through_a_cloth_that_catches_water():
    """Looked at in every step, also where drops are fast."""
    number, world = leaks(scene("dfsph", DROP | {"velocity": [0, -10, 0]}, SHEET), 0.05)
    assert number == 0
    assert world.cloth.vertices("sheet")[0][:, 1].min() < -0.05


@pytest.mark.slow
def test_a_jet_pushes_a_flag():
    """A jet that meets a hanging cloth: it leans away, and nothing comes through."""
    flag = {"shape": {"type": "sheet", "size": [0.5, 0.5]}, "rotation": [{"axis": [1, 0, 0], "angle": 90}],
            "spacing": 0.05, "pins": ["back"], "thickness": 0.006}  # fmt: skip
    nozzle = {"shape": {"type": "disc", "radius": 0.05}, "position": [0, 0, 0.25], "speed": 1.5,
              "rotation": [{"axis": [1, 0, 0], "angle": -90}]}  # fmt: skip
    made = scene("dfsph", DROP, flag)
    made["fluid"] = {"solver": "dfsph", "particle_radius": 0.0125, "emitters": {"jet": nozzle}}
    number, world = leaks(made, 0.4)
    points = world.cloth.vertices("sheet")[0]
    assert number == 0
    assert points[:, 1].max() == pytest.approx(0.25)
    assert points[:, 2].mean() < -0.02


@pytest.mark.slow
@pytest.mark.parametrize("mass", [0.1, 3.6, 30])
def test_a_ball_into_the_pinned_edge_of_a_net_that_holds_water_makes_no_energy(simulate, mass):
    """E(t) <= E(s) for all s < t: of water, net and ball, to the error of a net's forces (`force_error`, 1 %)."""
    water = {"shape": {"type": "box", "size": [0.35, 0.05, 0.35]}, "position": [0, 0.06, 0]}
    net = {"shape": {"type": "sheet", "size": [0.6, 0.6]}, "spacing": 0.04, "rest_scale": 1.2, "thickness": 0.006,
           "mass_per_area": 0.4, "stretch_stiffness": 5000, "pins": ["left", "right", "front", "back"]}  # fmt: skip
    ball = {"shape": {"type": "sphere", "radius": 0.06}, "motion": "dynamic", "mass": mass,
            "position": [-0.2, 0.25, -0.05], "velocity": [-0.35, 0, -0.3]}  # fmt: skip
    table = read_table(simulate(scene("dfsph", water, net, rigid={"bodies": {"ball": ball}}), 50) / "steps.csv")
    energy = sum(table[name] for name in table.dtype.names if name.endswith("_energy"))
    lowest = np.minimum.accumulate(energy)
    assert (energy - lowest).max() <= 0.01 * (energy[0] - lowest[-1])
    assert table["cloth_contacts"].max() > 0, "the ball meets the net"
