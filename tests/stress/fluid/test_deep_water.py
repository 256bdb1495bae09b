"""Water many layers deep, as in a vase or a pool with fine particles: pressure grows with depth, errors add up."""

import json

import numpy as np
import pytest

from tests.stress.scenes import contents
from tests.support.in_time import in_time
from tests.support.particles import positions, read_frame, velocities

SPACING, WIDE = 0.00625, 16
G = 9.81
FAST = np.sqrt(G * SPACING)
"""Speed of a fall over half a spacing [m/s]: particles find their places, and nothing else moves."""


def still_column(solver: str, layers: int):
    """A tank of so many layers, as wide as WIDE of them."""
    side, depth = WIDE * SPACING, layers * SPACING
    water = {"shape": {"type": "box", "size": [side, depth, side]}, "position": [0, depth / 2, 0]}
    return {
        "fps": 50,
        "containers": {"tank": {"type": "box", "size": [side, 1.25 * depth, side]}},
        "fluid": {"solver": solver, "particle_radius": SPACING / 2, "bodies": {"water": water}},
    }


def counts(out) -> dict:
    return json.loads((out / "summary.json").read_text())["counts"]


def heights_at_rest(out, last: int) -> np.ndarray:
    """Of the particles [m], after nothing was repeated, and with none that move on the whole."""
    assert (counts(out)["retries"], counts(out)["steps_repeated"]) == (0, 0)
    frame = read_frame(out, last)
    assert np.sqrt((velocities(frame) ** 2).sum(axis=1).mean()) < FAST
    return positions(frame)[:, 1]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "layers"),
    [("dfsph", 64), *in_time(("wcsph", 64), ("iisph", 64), ("dfsph", 96), ("dfsph", 128), ("iisph", 128))],
)
def test_a_deep_column_stands(simulate, solver, layers):
    """Its level is kept to a spacing."""
    height = heights_at_rest(simulate(still_column(solver, layers), 8), 8)
    assert 2 * height.mean() == pytest.approx(layers * SPACING, abs=SPACING)


@pytest.mark.parametrize("solver", ["dfsph", *in_time("iisph")])
def test_two_parts_are_the_whole(simulate, solver):
    """What depth asks for is known from a state alone, byte for byte."""
    made = still_column(solver, 40)
    whole = simulate(made, 4, "whole")
    first = simulate(made, 2, "first")
    second = simulate(made, 4, "second", first=3, state=first / "state_00002.npz")
    assert contents(second, "state_00004.npz") == contents(whole, "state_00004.npz")


@pytest.mark.slow
def test_a_deep_pool_with_a_stone_in_it_stands(simulate):
    """70 layers, and a ball of 12 spacings that lies on the ground."""
    scene = still_column("dfsph", 70)
    stone = {"shape": {"type": "sphere", "radius": 6 * SPACING}, "position": [0, 6 * SPACING, 0], "density": 2500}
    scene["rigid"] = {"bodies": {"stone": stone | {"motion": "dynamic"}}}
    height = heights_at_rest(simulate(scene, 25), 25)
    assert height.max() == pytest.approx((70 - 0.5) * SPACING, abs=SPACING)


@pytest.mark.slow
@pytest.mark.parametrize(("cfl", "stable"), [(0.44, True), (1.0, False)])
def test_a_deep_column_breaks_beyond_the_frequency_of_its_lattice(simulate, monkeypatch, cfl, stable):
    """0.69 spacings of sqrt(p / rho) in a step are stable: 0.55 here, or 0.98, as far as falling allows, if the limit
    let them."""
    monkeypatch.setattr("sim.fluid.time_step_limits.PRESSED", cfl)
    scene = still_column("dfsph", 96) | {"step": {"cfl": cfl}}
    assert (counts(simulate(scene, 4))["retries"] == 0) == stable
