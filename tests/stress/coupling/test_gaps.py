"""Water between solids that come so near to each other that not even one layer of particles fits between them."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from tests.stress.scenes import assert_nothing_broken
from tests.support.fluid.vessels import FLOOR, RADIUS, SPACING, glass
from tests.support.in_time import in_time
from tests.support.particles import read_table

PCISPH = pytest.param(
    "pcisph",
    marks=[
        pytest.mark.slow,
        pytest.mark.xfail(strict=True, reason="raises the pressure of what has no room without end"),
    ],
)
TANK = {"tank": {"type": "box", "size": [0.4, 0.8, 0.4]}}
WATER = {"water": {"shape": {"type": "box", "size": [0.4, 0.3, 0.4]}, "position": [0, 0.15, 0]}}


def pool(rigid: dict[str, Any], solver: str = "dfsph", **fluid: Any) -> dict[str, Any]:
    fluid = {"solver": solver, "particle_radius": 0.01, "bodies": WATER} | fluid
    return {"fps": 50, "containers": TANK, "fluid": fluid, "rigid": {"bodies": rigid}}


def frames_repeated(out) -> int:
    return json.loads((out / "summary.json").read_text())["counts"]["retries"]


def two_boxes(seed: int) -> dict[str, Any]:
    """The heavier one lies on the lighter one, which it turns over in the water."""
    off = np.random.default_rng(seed).uniform(-1e-4, 1e-4, 3)
    box = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "motion": "dynamic"}
    upper = [float(x) for x in np.array([0, 0.5, 0]) + off]
    return {
        "lower": box | {"position": [0, 0.4, 0], "density": 300},
        "upper": box | {"position": upper, "density": 500},
    }


D, SPEED = 2.5e-3, 0.5
"""Spacing [m] of the scenes in which bodies land, and how fast they do [m/s]."""
LANDING = {
    "slab": ({"type": "box", "size": [0.04, 0.01, 0.02]}, 0.01, 0.02),
    "plate": ({"type": "box", "size": [0.04, 0.005, 0.04]}, 0.005, 0.04),
    "cube": ({"type": "box", "size": [0.02, 0.02, 0.02]}, 0.02, 0.02),
    "can": ({"type": "cylinder", "radius": 0.012, "height": 0.012}, 0.012, 0.024),
    "ball": ({"type": "sphere", "radius": 0.01}, 0.02, 0.02),
}
"""Shape, height and width [m] of each."""


def landing(name: str, solver: str) -> dict[str, Any]:
    """A stone body, a few layers above the floor of a small tank of water, askew by a degree."""
    shape, height, _ = LANDING[name]
    water = {"shape": {"type": "box", "size": [0.065, 0.075, 0.065]}, "position": [0, 0.0375, 0]}
    body = {
        "shape": shape,
        "position": [0.3 * D, height / 2 + 4 * D, -0.2 * D],
        "rotation": [{"axis": [1, 1, -1], "angle": 1}],
        "density": 2500,
        "velocity": [0, -SPEED, 0],
        "motion": "dynamic",
    }
    return {
        "fps": 200,
        "containers": {"tank": {"type": "box", "size": [0.065, 0.11, 0.065]}},
        "fluid": {"solver": solver, "particle_radius": D / 2, "bodies": {"water": water}},
        "rigid": {"bodies": {"body": body}},
    }


SHAPES = {
    "box": lambda random: {"size": [float(x) for x in random.uniform(0.06, 0.12, 3)]},
    "sphere": lambda random: {"radius": float(random.uniform(0.03, 0.06))},
    "cylinder": lambda random: {
        "radius": float(random.uniform(0.03, 0.06)),
        "height": float(random.uniform(0.04, 0.12)),
    },
}


def six_bodies(seed: int) -> dict[str, Any]:
    random = np.random.default_rng(seed)
    found = {}
    for number, (y, x) in enumerate([(y, x) for y in (0.4, 0.54, 0.68) for x in (-0.09, 0.09)]):
        kind = str(random.choice(list(SHAPES)))
        found[f"body{number}"] = {
            "shape": {"type": kind} | SHAPES[kind](random),
            "position": [x, y, float(random.uniform(-0.1, 0.1))],
            "rotation": [{"axis": [float(v) for v in random.normal(size=3)], "angle": float(random.uniform(0, 180))}],
            "density": float(random.choice([150, 300, 500, 800, 1200, 2500])),
            "motion": "dynamic",
        }
    return found


@pytest.mark.outcome("A")
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("ratio", [4.0, 4.4])
def test_boxes_turn_over_in_water_without_a_frame_repeated(simulate, seed, ratio):
    """They slide along each other and along the walls: what is between them comes out somewhere. It was shot out."""
    out = simulate(pool(two_boxes(seed), support_ratio=ratio), 70)
    assert_nothing_broken(out)
    assert frames_repeated(out) == 0


@pytest.mark.slow
@pytest.mark.outcome("A")
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("solver", ["dfsph", "iisph", "wcsph"])
def test_bodies_are_thrown_into_a_pool_without_a_frame_repeated(simulate, solver, seed):
    out = simulate(pool(six_bodies(seed), solver), 70)
    assert_nothing_broken(out)
    assert frames_repeated(out) == 0


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", ["dfsph", *in_time("iisph", "wcsph"), PCISPH])
def test_a_plate_pressed_on_the_ground_shoots_nothing_out(simulate, solver):
    """Nothing drives water faster than it would run out of the pool (Torricelli), but for the plate, whose speed it
    has and whose edges it is deflected by; and it is let go as slowly when the plate is lifted."""
    speed, deep = 0.2, 0.2
    keys = [
        {"at": 0, "position": [0, 0.12, 0]},
        {"at": 0.5, "position": [0, 0.02, 0]},
        {"at": 0.6, "position": [0, 0.02, 0]},
        {"at": 0.8, "position": [0, 0.06, 0]},
    ]
    plate = {"shape": {"type": "box", "size": [0.12, 0.04, 0.12]}, "motion": "prescribed", "keyframes": keys}
    water = {"water": {"shape": {"type": "box", "size": [0.4, deep, 0.4]}, "position": [0, deep / 2, 0]}}
    out = simulate(pool({"plate": plate}, solver, bodies=water), 40)
    assert_nothing_broken(out)
    assert frames_repeated(out) == 0
    steps = read_table(out / "steps.csv")
    assert steps["v_max"].max() < np.sqrt(2 * 9.81 * deep) + 2 * speed


@pytest.mark.slow
@pytest.mark.outcome("A")
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("wall", [0.25, 0.8])
def test_ice_falls_into_a_glass_without_a_frame_repeated(simulate, tmp_path, wall, seed):
    """Five cubes of 3.6 d in a glass of 14 d: water runs over its rim, a particle alone at a time."""
    glass(tmp_path, wall * SPACING)
    random = np.random.default_rng(seed)
    bodies = {
        "glass": {"shape": {"type": "mesh", "file": "glass.ply"}},
        "table": {"shape": {"type": "plane"}, "position": [0, -1e-4, 0]},
    }
    for number, angle in enumerate(np.linspace(0, 2 * np.pi, 5, endpoint=False)):
        bodies[f"ice{number}"] = {
            "shape": {"type": "box", "size": [0.018, 0.018, 0.018]},
            "position": [float(0.012 * np.cos(angle)), 0.075 + 0.032 * number, float(0.012 * np.sin(angle))],
            "rotation": [{"axis": [float(v) for v in random.normal(size=3)], "angle": float(random.uniform(0, 180))}],
            "density": 917,
            "motion": "dynamic",
        }
    water = {"shape": {"type": "cylinder", "radius": RADIUS, "height": 0.045}, "position": [0, FLOOR + 0.0225, 0]}
    fluid = {"solver": "dfsph", "particle_radius": SPACING / 2, "bodies": {"water": water}}
    out = simulate({"fps": 50, "fluid": fluid, "rigid": {"bodies": bodies}}, 50)
    assert_nothing_broken(out)
    assert frames_repeated(out) == 0


@pytest.mark.outcome("A")
@pytest.mark.slow
@pytest.mark.parametrize(
    ("solver", "name"), [*(("dfsph", name) for name in LANDING), ("iisph", "slab"), ("wcsph", "slab")]
)
def test_a_body_lands_under_water_and_squeezes_it_out_as_fast_as_it_must(simulate, solver, name):
    """The last layer, d thick, leaves from under a width L at V L / 2 d, by continuity. It was shot out at twenty times
    the speed V of the body, and half of these scenes stopped. By WCSPH that layer is compressed, bears it, and leaves
    within 0.25 s."""
    out = simulate(landing(name, solver), 60 if solver == "wcsph" else 24)
    assert_nothing_broken(out)
    assert frames_repeated(out) == 0
    width = LANDING[name][2]
    assert read_table(out / "steps.csv")["v_max"].max() < SPEED * width / (2 * D)
    fallen = read_table(out / "bodies.csv")
    assert fallen["y"][-1] < LANDING[name][1] / 2 + 0.5 * D, "it has not landed"
