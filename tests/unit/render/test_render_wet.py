"""What is wet in pictures: as much darker as it should be, where it should be, and with the body."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
import trimesh
from PIL import Image

from common.ply import write_mesh, write_points
from render.errors import Unusable
from render.looks.wet import DIFFUSE, LOOKS, WATER, moisten, soaked
from workflow.stages.wet.marks import WET_POINT

CELL = 0.05
PIXELS = 24
GREY = 0.5
"""Reflectance of what is dry."""
TRAPPED = 1 - (1 - DIFFUSE) / WATER**2
MIRRORED = ((WATER - 1) / (WATER + 1)) ** 2
"""Share of the light straight from below that the film throws back."""


def srgb(linear: float) -> float:
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def wet_points(low, high, wet=1.0) -> np.ndarray:
    """All points of the lattice in a box of whole numbers of cells."""
    places = np.stack(np.meshgrid(*map(np.arange, low, np.add(high, 1)), indexing="ij"), axis=-1).reshape(-1, 3)
    points = np.empty(len(places), WET_POINT)
    for axis, column in zip("xyz", CELL * places.T, strict=True):
        points[axis] = column
    points["wet"] = wet
    return points


@pytest.fixture
def folders(tmp_path):
    """Of a simulation without anything on a floor, and of what is wet: nothing."""
    simulation, wet = tmp_path / "simulation", tmp_path / "wet"
    simulation.mkdir()
    wet.mkdir()
    extent = {"min": [-1, 0, -1], "max": [1, 0.5, 1]}
    (simulation / "summary.json").write_text(json.dumps({"extent": extent, "ground": {"height": 0.0}}))
    (wet / "summary.json").write_text(json.dumps({"cell": CELL, "floors": [0.0]}))
    return simulation, wet


def pictures(folders, last=0, **settings) -> list[np.ndarray]:
    """Linear light of pictures from above, in which a metre is a quarter of them, shape [n, n]."""
    simulation, wet = folders
    out = simulation.parent / "out"
    spec = {
        "resolution": [PIXELS, PIXELS],
        "samples": 32,
        "noise_threshold": 0,
        "denoise": False,
        "camera": {"projection": "orthographic", "width": 4, "position": [0, 3, 0.001], "target": [0, 0, 0]},
        "lights": {"sun": {"elevation": 45, "strength": 3.0}, "environment": {"strength": 0}},
        "background": {"type": "plain", "color": "#000000"},
        "view_transform": "Standard",
        "motion_blur": False,
        **settings,
    }
    command = [sys.executable, "-m", "render", "--spec", json.dumps(spec), "--frames", f"0:{last}", "--threads", "1"]
    command += ["--simulation", str(simulation), "--wet", str(wet), "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=400)
    assert done.returncode == 0, done.stderr
    found = []
    for frame in range(last + 1):
        value = np.asarray(Image.open(out / f"{frame:05d}.png").convert("L"), float) / 255
        found.append(np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4))
    return found


def test_wet_ground_is_as_much_darker_as_light_that_is_trapped_below_a_film(folders):
    """r (1 - p) / (1 - p r) below the film (Lekner & Dorf 1988), of which the film throws back its share; within 3 %,
    of which 1 % are the 8 bits of a picture and the rest noise. Half as wet is as dark, and has no film."""
    _, wet = folders
    left = wet_points((-60, 0, -60), (-12, 1, 60))
    right = wet_points((12, 0, -60), (60, 1, 60), 0.5)
    write_points(wet / "wet_floor_00000.ply", np.concatenate([left, right]))
    ground = {"material": {"type": "matte", "color": [srgb(GREY)] * 3}}
    (bright,) = pictures(folders, ground=ground)
    shares = [bright[6:18, columns].mean() / bright[6:18, 11:13].mean() for columns in (slice(3, 7), slice(17, 21))]
    below = (1 - TRAPPED) / (1 - TRAPPED * GREY)
    assert shares[0] == pytest.approx(below * (1 - LOOKS["matte"].film * MIRRORED), rel=0.03)
    assert shares[1] == pytest.approx(below, rel=0.03)


def test_wetness_moves_with_its_body(folders):
    """The left half of a plate is wet; turned by half a circle, the right half is darker. What is out of sight of the
    lattice's other layers stays dry: the plate has a thickness of several cells, and is wet on top alone."""
    simulation, wet = folders
    plate = trimesh.creation.box((2.0, 0.4, 2.0))
    write_mesh(simulation / "body_plate.ply", plate.vertices, plate.faces)
    rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    rows += [f"0,0,plate,0,0.2,0,1,0,0,0{',0' * 6}", f"1,1,plate,0,0.2,0,0,0,1,0{',0' * 6}"]
    rows += [f"2,2,plate,0,0.2,0,0,1,0,0{',0' * 6}"]
    (simulation / "bodies.csv").write_text("\n".join(rows) + "\n")
    for frame in range(3):
        write_points(wet / f"wet_body_plate_{frame:05d}.ply", wet_points((-20, 4, -20), (-2, 5, 20)))
    settings = {"ground": {"enabled": False}, "materials": {"plate": {"type": "matte", "color": [srgb(GREY)] * 3}}}
    first, turned, upside_down = pictures(folders, last=2, **settings)
    for picture, (dark, light) in ((first, (8, 15)), (turned, (15, 8))):
        ratio = picture[8:16, dark - 1 : dark + 1].mean() / picture[8:16, light - 1 : light + 1].mean()
        assert ratio == pytest.approx((1 - TRAPPED) / (1 - TRAPPED * GREY), rel=0.05)
    assert upside_down[8:16, 7:17].min() > 0.9 * upside_down[8:16, 7:17].max()


def test_sheets_say_how_wet_they_are(folders):
    pytest.importorskip("bpy")
    from render.content.changing.wetness import Wetness
    from render.content.ply import read_mesh
    from render.inputs import Box, Inputs

    simulation, wet = folders
    write_mesh(simulation / "cloth_towel_00000.ply", np.eye(3), np.array([[0, 1, 2]]))
    points = np.zeros(3, WET_POINT)
    points["wet"] = 0, 0.25, 1
    write_points(wet / "wet_cloth_towel_00000.ply", points)
    found = Wetness(Inputs(simulation, None, wet=wet), Box((-1, -1, 0), (1, 1, 1)))
    meshes = {"cloth_towel": read_mesh(simulation / "cloth_towel_00000.ply"), "water": None}
    assert found.read(meshes, 0)["cloth_towel"].columns["wet"].tolist() == [0, 0.25, 1]
    assert "wet" not in found.read(meshes, 1)["cloth_towel"].columns
    write_points(wet / "wet_cloth_towel_00000.ply", points[:2])
    with pytest.raises(Unusable, match="of another mesh: 2 vertices, not 3"):
        found.read(meshes, 0)
    (wet / "summary.json").write_text("{}")
    with pytest.raises(Unusable, match="does not say the cell"):
        Inputs(simulation, None, wet=wet).wet_lattice()


def test_what_is_clear_does_not_change():
    from types import SimpleNamespace

    assert not any(soaked(SimpleNamespace(type="glass")))
    assert soaked(SimpleNamespace(type="wood", varnish=1.0)) == (0.0, 1.0)
    pores = [soaked(SimpleNamespace(type=name)).pores for name in ("matte", "stone", "planks", "tiles", "metal")]
    assert pores == sorted(pores, reverse=True)
    assert callable(moisten)
