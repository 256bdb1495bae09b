"""The pass `motion` of whatever moves, against the way of its image: f v / (fps depth)."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from common.ply import write_points
from sim.foam.particles import FOAM_POINT

FPS, DISTANCE, WIDTH, HEIGHT, ANGLE = 24.0, 5.0, 64, 36, 40.0
FOCAL = WIDTH / 2 / math.tan(math.radians(ANGLE) / 2)
"""[px]"""
VELOCITY = (1.2, -0.7, 0.0)
"""[m/s]"""
WAY = FOCAL * np.array(VELOCITY[:2]) / (FPS * DISTANCE)
"""Of the image in a frame [px]."""
BACK = -np.tile(WAY, 2)
"""From where it is to where it was, and from where it will be."""
EYE = (0.0, 1.0, DISTANCE)
CORNERS = [(-2, -1, 0), (2, -1, 0), (2, 3, 0), (-2, 3, 0)]
SIDES = [(0, 1, 2), (0, 2, 3)]


def vectors(simulation: Path, out: Path, *options: str, **settings) -> np.ndarray:
    """The four channels in the middle of the picture."""
    import OpenEXR

    camera = settings.pop("camera", {"position": EYE, "target": [0, 1, 0], "field_of_view": ANGLE})
    spec = {"resolution": [WIDTH, HEIGHT], "samples": 1, "motion_blur": False, "passes": ["motion"]}
    spec |= {"ground": {"enabled": False}, "camera": camera, **settings}
    command = [sys.executable, "-m", "render", "--spec", json.dumps(spec), "--frames", "2:2", "--fps", str(FPS)]
    command += ["--simulation", str(simulation), "--out", str(out), "--threads", "1", *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(out / "00002.exr"), separate_channels=True) as file:
        found = {name.rpartition(".")[2]: c.pixels for name, c in file.channels().items() if "Vector" in name}
    return np.array([found[axis][HEIGHT // 2, WIDTH // 2] for axis in "XYZW"])


@pytest.fixture
def simulation(tmp_path) -> Path:
    folder = tmp_path / "simulation"
    folder.mkdir()
    (folder / "summary.json").write_text(json.dumps({"extent": {"min": [-2, -1, -0.5], "max": [2, 3, 0.5]}}))
    return folder


def wall(simulation: Path, write_mesh, velocity) -> None:
    write_mesh(simulation / "body_wall.ply", "x y z", [(x, y - 1, z) for x, y, z in CORNERS], SIDES)
    moves = ",".join(map(str, velocity))
    rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    rows += [f"{frame},{frame / FPS},wall,0,1,0,1,0,0,0,{moves},0,0,0" for frame in range(4)]
    (simulation / "bodies.csv").write_text("\n".join(rows) + "\n")


def test_a_body(simulation, write_mesh, tmp_path):
    wall(simulation, write_mesh, VELOCITY)
    assert vectors(simulation, tmp_path / "out") == pytest.approx(BACK, abs=1e-3)


def test_cloth(simulation, write_mesh, tmp_path):
    for frame in (0, 2):
        sheet = [(*corner, *VELOCITY) for corner in CORNERS]
        write_mesh(simulation / f"cloth_sheet_{frame:05d}.ply", "x y z vx vy vz", sheet, SIDES)
    assert vectors(simulation, tmp_path / "out") == pytest.approx(BACK, abs=1e-3)


def test_water(simulation, write_mesh, tmp_path):
    surface = tmp_path / "surface"
    surface.mkdir()
    points = [(*corner, 0, 0, 1, *VELOCITY) for corner in CORNERS]
    write_mesh(surface / "surface_00002.ply", "x y z nx ny nz vx vy vz", points, SIDES)
    assert vectors(simulation, tmp_path / "out", "--surface", str(surface)) == pytest.approx(BACK, abs=1e-3)


def test_foam(simulation, tmp_path):
    """A ball, whose nearest point is its radius nearer; its mesh is up to 7 % of that within it."""
    foam, radius = tmp_path / "foam", 0.5
    foam.mkdir()
    drop = np.zeros(1, FOAM_POINT)
    for name, value in zip(("y", "radius", "vx", "vy", "vz"), (1.0, radius, *VELOCITY), strict=True):
        drop[name] = value
    write_points(foam / "foam_00002.ply", drop)
    found = vectors(simulation, tmp_path / "out", "--foam", str(foam))
    assert found == pytest.approx(BACK * DISTANCE / (DISTANCE - radius), rel=0.07 * radius / (DISTANCE - radius))


def test_a_camera_that_moves(simulation, write_mesh, tmp_path):
    """Past a wall at rest, the other way."""
    wall(simulation, write_mesh, (0, 0, 0))
    ways = [(frame - 2) / FPS * np.array(VELOCITY) for frame in range(5)]
    keys = [
        {"at": frame / FPS, "position": [*(EYE - way)], "target": [*((0, 1, 0) - way)]}
        for frame, way in enumerate(ways)
    ]
    camera = {"keyframes": keys, "field_of_view": ANGLE}
    assert vectors(simulation, tmp_path / "out", camera=camera) == pytest.approx(BACK, abs=1e-3)


SHOWN = 4.0
"""By an orthographic camera, across the picture [m]."""
TO_SCALE = {"projection": "orthographic", "width": SHOWN}


def test_to_scale_distance_does_not_matter(simulation, write_mesh, tmp_path):
    """Of a body, and of what comes nearer: v pixels / (fps m), by nothing else."""
    wall(simulation, write_mesh, (*VELOCITY[:2], 3.0))
    camera = {"position": EYE, "target": [0, 1, 0], **TO_SCALE}
    way = np.array(VELOCITY[:2]) / FPS * WIDTH / SHOWN
    assert vectors(simulation, tmp_path / "out", camera=camera) == pytest.approx(-np.tile(way, 2), abs=1e-3)


def test_to_scale_a_camera_that_moves(simulation, write_mesh, tmp_path):
    wall(simulation, write_mesh, (0, 0, 0))
    ways = [(frame - 2) / FPS * np.array(VELOCITY) for frame in range(5)]
    keys = [
        {"at": frame / FPS, "position": [*(EYE - way)], "target": [*((0, 1, 0) - way)]}
        for frame, way in enumerate(ways)
    ]
    way = np.array(VELOCITY[:2]) / FPS * WIDTH / SHOWN
    found = vectors(simulation, tmp_path / "out", camera={"keyframes": keys, **TO_SCALE})
    assert found == pytest.approx(-np.tile(way, 2), abs=1e-3)


def test_what_rests_does_not_move(simulation, write_mesh, tmp_path):
    wall(simulation, write_mesh, (0, 0, 0))
    assert vectors(simulation, tmp_path / "out") == pytest.approx(np.zeros(4), abs=1e-5)
