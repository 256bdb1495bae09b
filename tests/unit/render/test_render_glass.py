"""Glass loses no light: in a world that is white all around, what absorbs nothing cannot be seen.

Light runs along a pane by dozens of total reflections before it leaves, and a path tracer ends long paths.
"""

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

WHITE = {"type": "glass", "color": "#ffffff"}
SETTINGS = {
    "resolution": [48, 27],
    "samples": 4,
    "noise_threshold": 0,
    "denoise": False,
    "motion_blur": False,
    "passes": ["depth"],
    "ground": {"enabled": False},
    "background": {"type": "environment"},
    "camera": {"position": [0.9, 0.7, 1.3], "target": [0, 0.15, 0], "field_of_view": 40},
}
EXTENT = {"min": [-0.4, 0, -0.3], "max": [0.4, 0.4, 0.3]}


def cuboid(low, high, without_lid=False):
    """Corners and outward triangles."""
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    if without_lid:
        sides.remove((2, 3, 7, 6))
    return corners, [triangle for a, b, c, d in sides for triangle in ((a, b, c), (a, c, d))]


def tank(simulation, write_mesh):
    corners, triangles = cuboid(EXTENT["min"], EXTENT["max"], without_lid=True)
    write_mesh(simulation / "container_thing.ply", "x y z", corners, triangles)


def block(simulation, write_mesh):
    write_mesh(simulation / "body_thing.ply", "x y z", *cuboid((-0.3, -0.15, -0.2), (0.3, 0.15, 0.2)))
    head = "frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"
    (simulation / "bodies.csv").write_text(f"{head}\n0,0,thing,0,0.15,0,1,0,0,0,0,0,0,0,0,0\n")


def picture(tmp_path, **settings):
    """Red, green, blue of every pixel [27, 48, 3], with light of 1 from everywhere."""
    import OpenEXR

    Image.new("RGB", (16, 8), "white").save(tmp_path / "white.png")
    light = {"sun": {"strength": 0}, "environment": {"file": str(tmp_path / "white.png"), "strength": 1}}
    spec = json.dumps(SETTINGS | {"lights": light} | settings)
    command = [sys.executable, "-m", "render", "--spec", spec, "--frames", "0:0", "--threads", "1"]
    command += ["--simulation", str(tmp_path / "simulation"), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(tmp_path / "out" / "00000.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    return np.stack([channels[f"ViewLayer.Combined.{channel}"] for channel in "RGB"], axis=-1)


@pytest.fixture
def simulation(tmp_path):
    folder = tmp_path / "simulation"
    folder.mkdir()
    (folder / "summary.json").write_text(json.dumps({"extent": EXTENT}))
    return folder


@pytest.mark.parametrize("thin", [False, True], ids=["solid", "thin"])
@pytest.mark.parametrize("bounces", [2, 24])
@pytest.mark.parametrize("thing", [tank, block])
def test_white_glass_in_white_light_is_white_to_its_edges(tmp_path, simulation, write_mesh, thing, bounces, thin):
    thing(simulation, write_mesh)
    seen = picture(tmp_path, bounces=bounces, materials={"thing": WHITE | {"thin": thin}})
    assert seen.min() == pytest.approx(1, abs=0.01)
    assert seen.max() == pytest.approx(1, abs=0.01)
