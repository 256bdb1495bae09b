"""What the camera frames: the box around all that is placed, and around where it lands."""

from pathlib import Path

import numpy as np
import pytest

from sim.run.placing.extent import filmed
from sim.run.world import World
from sim.spec import SimulationSpec

TOWEL = {"shape": {"type": "sheet", "size": [0.4, 0.4]}, "spacing": 0.1, "thickness": 0.006}


def found(tmp_path, **scene):
    world = World(SimulationSpec.model_validate({"gravity": [0, -9.81, 0]} | scene), Path(tmp_path))
    told = filmed(world)
    return np.array([told["extent"]["min"], told["extent"]["max"]]), told["ground"], world


def test_what_falls_on_a_floor_is_framed_with_it(tmp_path):
    cube = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 1, 0]}
    bodies = {"floor": {"shape": {"type": "plane"}, "position": [0, -0.5, 0]}, "cube": cube}
    for motion, lowest in (("dynamic", -0.5), ("static", 0.9)):
        extent, ground, _ = found(tmp_path, rigid={"bodies": bodies | {"cube": cube | {"motion": motion}}})
        assert extent == pytest.approx(np.array([[-0.1, lowest, -0.1], [0.1, 1.1, 0.1]]))
        assert ground == {"height": -0.5, "cloth": None}


def test_what_falls_on_a_slope_is_framed_with_where_it_lands(tmp_path):
    """Under x = 0.1 a plane that falls by 30 degrees along x is at -0.1 tan 30."""
    slope = {"shape": {"type": "plane", "normal": [0.5, np.sqrt(0.75), 0.0]}}
    cube = {"motion": "dynamic", "shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 1, 0]}
    extent, ground, _ = found(tmp_path, rigid={"bodies": {"slope": slope, "cube": cube}})
    assert extent[0] == pytest.approx([-0.1, -0.1 * np.tan(np.radians(30)), -0.1])
    assert ground["height"] is None


def test_what_hangs_is_framed_where_it_is_placed(tmp_path):
    bodies = {"floor": {"shape": {"type": "plane"}}}
    for pins, lowest in (([], 0.0), (["left"], 2.0)):
        sheets = {"towel": TOWEL | {"position": [0, 2, 0], "pins": pins}}
        extent, ground, _ = found(tmp_path, rigid={"bodies": bodies}, cloth={"sheets": sheets})
        assert extent[0, 1] == pytest.approx(lowest)
        assert ground == {"height": 0.0, "cloth": 0.003}


def test_a_tank_on_a_shelf_does_not_lift_the_ground(tmp_path):
    tank = {"type": "box", "size": [1, 1, 1], "position": [0, 2, 0]}
    water = {"shape": {"type": "box", "size": [0.5, 0.5, 0.5]}, "position": [0, 2.25, 0]}
    scene = {"containers": {"tank": tank}, "fluid": {"particle_radius": 0.05, "bodies": {"water": water}}}
    floor = {"rigid": {"bodies": {"floor": {"shape": {"type": "plane"}}}}}
    for more, height in (({}, None), (floor, 0.0)):
        _, ground, _ = found(tmp_path, **scene, **more)
        assert ground["height"] == height


def test_where_the_simulation_has_its_origin_does_not_depend_on_what_is_filmed(tmp_path):
    cube = {"motion": "dynamic", "shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 1, 0]}
    world = found(tmp_path, rigid={"bodies": {"floor": {"shape": {"type": "plane"}}, "cube": cube}})[2]
    assert world.origin == pytest.approx([0, 1, 0])
