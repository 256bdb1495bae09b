"""The ground that pictures show: where the scene's floor is, and under the cloth that lies on it."""

import json
import subprocess
import sys

import pytest

from tests.support.pictures import extent, passes, white_light

HIGH = 2.0
LYING = 0.003
"""Height of the middle of a cloth of 6 mm that lies on a floor at 0 [m]."""


def depths(tmp_path, write_mesh, ground, water):
    """Distances of the camera, which looks straight down, to the cloth, and to the ground beside it [m]; the lowest
    that the scene places is at 4 mm."""
    import OpenEXR

    simulation, surface, out = (tmp_path / name for name in ("simulation", "surface", "out"))
    corners = [(-0.3, LYING, -0.3), (0.3, LYING, -0.3), (0.3, LYING, 0.3), (-0.3, LYING, 0.3)]
    simulation.mkdir()
    write_mesh(simulation / "cloth_towel_00000.ply", "x y z vx vy vz", [(*c, 0, 0, 0) for c in corners], [(0, 2, 1)])
    extent = {"min": [-0.5, 0.004, -0.5], "max": [0.5, 1.0, 0.5]}
    (simulation / "summary.json").write_text(json.dumps({"extent": extent, "ground": ground}))
    settings = {"resolution": [32, 32], "samples": 1, "motion_blur": False, "passes": ["depth"]}
    settings |= {"camera": {"position": [0.1, HIGH, 0.0], "target": [0.1, 0, 0.0], "field_of_view": 40}}
    command = [sys.executable, "-m", "render", "--spec", json.dumps(settings), "--frames", "0:0", "--threads", "1"]
    command += ["--simulation", str(simulation), "--out", str(out)]
    if water:
        surface.mkdir()
        write_mesh(surface / "surface_00000.ply", "x y z nx ny nz vx vy vz", [], [])
        command += ["--surface", str(surface)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(out / "00000.exr"), separate_channels=True) as file:
        seen = next(channel.pixels for name, channel in file.channels().items() if "Depth" in name)
    return float(seen.min()), float(seen.max())


@pytest.mark.parametrize("water", [False, True])
def test_cloth_on_the_floor_is_seen(tmp_path, write_mesh, water):
    """The ground is the floor; under water it may reach no further up than half way to the cloth."""
    ground = {"height": 0.0, "cloth": LYING}
    cloth, beside = depths(tmp_path, write_mesh, ground, water)
    assert cloth == pytest.approx(HIGH - LYING, abs=1e-5)
    assert beside == pytest.approx(HIGH - (LYING / 2 if water else 0), abs=1e-5)


def test_without_a_floor_the_ground_is_under_all_that_is_placed(tmp_path, write_mesh):
    assert depths(tmp_path, write_mesh, {"height": None, "cloth": None}, False)[1] == pytest.approx(1.996, abs=1e-5)


def test_boards_go_on_through_the_middle_of_the_ground(tmp_path):
    """No joint across them: in each row, the middle is as bright as its surroundings."""
    simulation = tmp_path / "simulation"
    extent(simulation, (-0.5, 0, -0.5), (0.5, 0.1, 0.5))
    camera = {"position": [0, HIGH, 0], "target": [0, 0, 0], "projection": "orthographic", "width": 0.1}
    look = {"type": "planks", "board": 0.2}
    settings = {"resolution": (64, 32), "camera": camera, "ground": {"height": 0, "material": look}, "samples": 16}
    light = passes(simulation, tmp_path / "out", **white_light(tmp_path) | settings)[0].mean(axis=(0, 2))
    assert light[30:34].min() > 0.8 * light.mean()
