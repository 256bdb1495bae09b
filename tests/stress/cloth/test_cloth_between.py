"""Bodies that bounce, and cloth that comes between: what it stops gives nothing back, what it does not bounces."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.bodies import ball, box, ground
from tests.support.cloths import G, extremes, scene, sheet
from tests.support.in_time import in_time
from tests.support.meshes import write
from tests.support.stepping import advance

MADE = 0.01
"""Of the energy that a scene sets free; see `test_cloth_bears_bodies`."""
STEPS = [0.004, *(pytest.param(dt, marks=pytest.mark.slow) for dt in (0.016, 0.0005))]


def bounces(**bodies):
    """On a floor from which everything comes back as fast as it came."""
    return {"floor": ground(restitution=1)} | {name: body | {"restitution": 1} for name, body in bodies.items()}


@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("mass", [2.9, *(pytest.param(m, marks=pytest.mark.slow) for m in (0.02, 30))])
@pytest.mark.parametrize("restitution", [1, pytest.param(0, marks=pytest.mark.slow)])
def test_a_ball_in_a_bag_lands(tmp_path, restitution, mass, dt):
    """A closed bag of 54 g falls on the ground, and the ball in it on the bag."""
    import trimesh

    bag = {"shape": {"type": "mesh", "file": str(write(tmp_path / "bag.off", trimesh.creation.icosphere(2, 0.12)))}}
    bag |= {"mass_per_area": 0.3, "stretch_stiffness": 500, "thickness": 0.004, "position": [0, 0.3, 0]}
    inside = ball(0.07, mass=mass, position=[0.02, 0.29, 0], restitution=restitution)
    world = scene({"bag": bag}, {"floor": ground(restitution=restitution), "ball": inside}, gravity=[0, -G, 0])
    least, first, most = extremes(world, 0.5, dt)
    assert most - first <= MADE * (first - least)


TOWEL = sheet((0.2, 0.2), position=[0, 0.002, 0], spacing=0.04, thickness=0.004)
PARTLY = {
    "a plank with one half on a towel": (
        {"a": TOWEL | {"position": [0.1, 0.002, 0]}},
        bounces(plank=box((0.2, 0.05, 0.1), mass=2, position=[0, 0.2, 0])),
    ),
    "a plank with one end on a towel": (
        {"a": TOWEL | {"position": [0.16, 0.002, 0]}},
        bounces(plank=box((0.2, 0.05, 0.1), mass=2, position=[0, 0.2, 0])),
    ),
    "a ball on a towel on a ball": (
        {"a": TOWEL | {"position": [0, 0.3025, 0]}},
        bounces(low=ball(0.1, mass=1, position=[0, 0.2, 0]), high=ball(0.05, mass=0.2, position=[0, 0.355, 0])),
    ),
}


@pytest.mark.parametrize("dt", STEPS)
@pytest.mark.parametrize("name", [next(iter(PARTLY)), *in_time(*list(PARTLY)[1:])])
def test_what_lands_on_cloth_in_part_makes_no_energy(name, dt):
    sheets, bodies = PARTLY[name]
    least, first, most = extremes(scene(sheets, bodies, gravity=[0, -G, 0]), 0.5, dt)
    assert most - first <= MADE * (first - least)


def test_a_ball_under_a_cloth_bounces():
    """It comes back as if the cloth that lies on it, of a mass of m over its own M, stopped on it: up at
    (e - m/M) / (1 + m/M) of the speed at which it came down."""
    e, drop, mass = 0.7, 0.3, 1.0
    towel = sheet((0.2, 0.2), position=[0, 0.1045 + drop, 0], spacing=0.04, thickness=0.004, mass_per_area=0.05)
    falling = ball(0.05, mass=mass, position=[0, 0.05 + drop, 0], restitution=e)
    world = scene({"a": towel}, {"floor": ground(restitution=e), "ball": falling}, gravity=[0, -G, 0])
    heights = []
    for k in range(1, 111):
        advance(world, 0.004, 0.004 * k)
        heights.append(world.rigid.position[world.rigid.dynamic][0, 1] - 0.05)
    least = int(np.argmin(heights))
    share = world.cloth.mesh.mass.sum() / mass
    assert max(heights[least:]) == pytest.approx(drop * ((e - share) / (1 + share)) ** 2, rel=0.02)
