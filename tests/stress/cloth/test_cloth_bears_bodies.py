"""What lies on cloth, falls into it or is covered by it: contacts make no energy, whichever of the two is heavier."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.support.bodies import ball, box, ground
from tests.support.cloths import HANGING, G, extremes, scene, sheet
from tests.support.in_time import in_time
from tests.support.stepping import advance

THICK = 0.004
MADE = 0.01
"""Of the energy that a scene sets free, so much may come from errors of solutions: forces are balanced to 1 % of those
that act (`force_error`)."""


def cloth(size: float, height: float, **settings: Any) -> dict[str, Any]:
    return sheet((size, size), **{"position": [0, height, 0], "spacing": 0.04, "thickness": THICK} | settings)


def block(mass: float, height: float, **settings: Any) -> dict[str, Any]:
    return box((0.1, 0.04, 0.1), mass=mass, position=[0, height, 0], **settings)


PINNED = {"pins": ["left", "right", "front", "back"], "mass_per_area": 0.4, "stretch_stiffness": 5000}
SCENES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    **{
        f"block of {mass} kg on a towel": ({"floor": ground(), "block": block(mass, 0.024)}, {"a": cloth(0.2, 0.002)})
        for mass in (2e-3, 0.05, 2, 20)
    },
    **{
        f"ball of 2 kg above a towel, restitution {e}": (
            {"floor": ground(restitution=e), "ball": ball(0.035, mass=2, position=[0, 0.03915, 0], restitution=e)},
            {"a": cloth(0.2, 0.002)},
        )
        for e in (0, 1)
    },
    **{
        f"ball of {mass} kg on a trampoline": (
            {"ball": ball(0.06, mass=mass, position=[0, 0.2, 0])},
            {"a": cloth(0.6, 0, **PINNED)},
        )
        for mass in (0.01, 1, 20)
    },
    "ball into the pinned edge of a slack net": (
        {"ball": ball(0.06, mass=3.6, position=[-0.22, 0.25, -0.05], velocity=[-0.6, 0, -0.5])},
        {"a": cloth(0.6, 0, rest_scale=1.2, **PINNED)},
    ),
    **{
        f"cloth between blocks of {low} and {high} kg": (
            {"floor": ground(), "low": block(low, 0.02), "high": block(high, 0.08)},
            {"a": cloth(0.16, 0.046)},
        )
        for low, high in ((0.002, 2), (0.02, 2), (1, 1), (2, 0.02))
    },
    **{
        f"cloth over a box of {mass} kg": (
            {"floor": ground(), "box": box((0.1, 0.1, 0.1), mass=mass, position=[0, 0.05, 0])},
            {"a": cloth(0.4, 0.13, mass_per_area=0.5)},
        )
        for mass in (2e-3, 0.1, 5)
    },
    "cloth over three balls": (
        {"floor": ground()} | {f"ball{k}": ball(0.03, mass=0.02, position=[0.061 * k, 0.03, 0]) for k in (-1, 0, 1)},
        {"a": cloth(0.4, 0.1, mass_per_area=0.5)},
    ),
    "block onto two towels": (
        {"floor": ground(), "block": block(2, 0.06)},
        {"a": cloth(0.2, 0.002), "b": cloth(0.2, 0.02)},
    ),
    "block and cloth on a tower": (
        {"floor": ground(), "one": block(0.2, 0.02), "two": block(0.2, 0.06), "block": block(2, 0.12)},
        {"a": cloth(0.16, 0.0822)},
    ),
    "box thrown into a curtain": (
        {"box": box((0.06, 0.06, 0.06), mass=1, position=[-0.1, 0, 0], velocity=[2, 0, 0])},
        {"a": cloth(0.4, 0.0, rotation=HANGING, pins=["left"], mass_per_area=0.3)},
    ),
    "ball thrown at a free cloth": (
        {"ball": ball(0.05, mass=0.05, velocity=[0, 3, 0])},
        {"a": cloth(0.3, 0.1, mass_per_area=0.5)},
    ),
}
FAST = {("block of 2 kg on a towel", 0.004), ("cloth between blocks of 0.02 and 2 kg", 0.016)}
CASES = [
    pytest.param(name, dt, marks=[pytest.mark.slow] * ((name, dt) not in FAST))
    for name in SCENES
    for dt in (0.0005, 0.004, 0.016)
]


@pytest.mark.parametrize(("name", "dt"), CASES)
def test_contacts_make_no_energy(name, dt):
    """E(t) <= E(0)."""
    bodies, sheets = SCENES[name]
    least, first, most = extremes(scene(sheets, bodies, gravity=[0, -G, 0]), 0.4, dt)
    assert most - first <= MADE * (first - least) + 1e-5 * abs(first)


@pytest.mark.parametrize("seed", [1, *in_time(0, 2, 3)])
def test_edges_in_line_with_threads_make_no_energy(seed):
    """A box meets a curtain along its threads: by rounding, edges of the two slide past where they were nearest."""
    bodies, sheets = SCENES["box thrown into a curtain"]
    box = bodies["box"]
    place = np.array(box["position"]) + np.random.default_rng(seed).normal(size=3) * 1e-8
    bodies = {"box": box | {"position": place.tolist()}}
    least, first, most = extremes(scene(sheets, bodies, gravity=[0, -G, 0]), 0.4, 0.016)
    assert most - first <= MADE * (first - least) + 1e-5 * abs(first)


LYING = {
    "on the ground": ({}, {"a": cloth(0.2, THICK / 2)}),
    "on another": ({}, {"a": cloth(0.2, THICK / 2), "b": cloth(0.2, 1.5 * THICK)}),
    "on a table": ({"table": box((0.3, 0.1, 0.3), motion="static", position=[0, 0.05, 0])}, {"a": cloth(0.2, 0.102)}),
}


@pytest.mark.parametrize("dt", [1e-4, 5e-4])
@pytest.mark.parametrize("where", LYING)
def test_a_towel_that_lies_is_not_thrown_up(where, dt):
    """It is seen to touch when it has sunk in by a twentieth of its thickness, and raised to where it belongs so slowly
    that the speed is worth less than a hundredth of the way that it sank, whatever the step."""
    bodies, sheets = LYING[where]
    least, first, most = extremes(scene(sheets, {"floor": ground()} | bodies, gravity=[0, -G, 0]), 0.02, dt)
    assert most - first <= MADE * (first - least)


@pytest.mark.parametrize("mass", [0.05, 2, pytest.param(20, marks=pytest.mark.slow)])
def test_a_block_on_a_towel_stays(mass):
    """It lies at the thickness of the towel, which bears its weight."""
    world = scene(
        {"towel": cloth(0.2, THICK / 2)}, {"floor": ground(), "block": block(mass, THICK + 0.02)}, gravity=[0, -G, 0]
    )
    for k in range(1, 51):
        advance(world, 0.004, 0.004 * k)
    height = world.rigid.position[world.rigid.dynamic][0, 1]
    assert height == pytest.approx(THICK + 0.02, abs=0.01 * THICK)
    assert world.cloth.collisions.on_bodies()[0, 1] == pytest.approx(mass * G, rel=0.01)
