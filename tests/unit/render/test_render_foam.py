"""Balls of foam in tiny pictures: where they are, how large, and how they blur."""

import json
import math
import shutil
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from common.ply import write_points
from sim.foam.particles import FOAM_POINT

HEIGHT = 90
DISTANCE, ANGLE = 10.0, 30.0
SETTINGS = {
    "resolution": [HEIGHT, HEIGHT],
    "samples": 32,
    "ground": {"enabled": False},
    "camera": {"position": [0, 0, DISTANCE], "target": [0, 0, 0], "field_of_view": ANGLE},
    "background": {"type": "plain", "color": "#000000"},
    "view_transform": "Standard",
    "shutter": 1.0,
}
METRE = HEIGHT / (2 * DISTANCE * math.tan(math.radians(ANGLE / 2)))
"""[px]"""


def picture(tmp_path, points, **settings) -> np.ndarray:
    """Brightness of a picture of balls (x, y, z, vx, radius)."""
    simulation, foam, out = (tmp_path / name for name in ("simulation", "foam", "out"))
    simulation.mkdir()
    foam.mkdir()
    (simulation / "summary.json").write_text(json.dumps({"extent": {"min": [-2, -2, -2], "max": [2, 2, 2]}}))
    records = np.zeros(len(points), FOAM_POINT)
    for column, name in enumerate(("x", "y", "z", "vx", "radius")):
        records[name] = [point[column] for point in points]
    write_points(foam / "foam_00000.ply", records)
    command = [sys.executable, "-m", "render", "--spec", json.dumps(SETTINGS | settings), "--frames", "0:0"]
    command += [
        "--simulation",
        str(simulation),
        "--foam",
        str(foam),
        "--out",
        str(out),
        "--threads",
        "1",
        "--fps",
        "10",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    return np.asarray(Image.open(out / "00000.png").convert("L"), dtype=float)


def box(bright: np.ndarray) -> tuple[float, float, float, float]:
    """Left, right, top and bottom of what is not black [px]."""
    rows, columns = np.nonzero(bright > 40)
    return columns.min(), columns.max() + 1, rows.min(), rows.max() + 1


@pytest.mark.parametrize(
    "blender",
    [
        "",
        pytest.param(
            "blender",
            marks=pytest.mark.skipif(shutil.which("blender") is None, reason="no Blender is installed"),
        ),
    ],
    ids=["bpy", "installed"],
)
def test_a_ball_is_where_and_as_large_as_it_should_be(tmp_path, monkeypatch, blender):
    monkeypatch.setenv("TIDEMILL_BLENDER", blender)
    found = box(picture(tmp_path, [(1.0, 0.5, 0.0, 0.0, 0.4)]))
    middle = HEIGHT / 2
    expected = (middle + 0.6 * METRE, middle + 1.4 * METRE, middle - 0.9 * METRE, middle - 0.1 * METRE)
    assert found == pytest.approx(expected, abs=2.0)


def test_a_ball_that_moves_is_blurred_along_its_way(tmp_path):
    """With the shutter open for a whole frame of 0.1 s: 20 m/s are 2 m."""
    left, right, top, bottom = box(picture(tmp_path, [(0.0, 0.0, 0.0, 20.0, 0.4)]))
    assert bottom - top < 0.8 * METRE + 2
    assert right - left > 2.0 * METRE


def test_no_balls_are_black(tmp_path):
    assert picture(tmp_path, []).max() < 10
