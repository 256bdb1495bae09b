"""Water in false colours: those of the map's ends where the fluid has the values of the look's; and in those of its
sources."""

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

SETTINGS = {
    "resolution": [32, 18],
    "samples": 8,
    "ground": {"enabled": False},
    "view_transform": "Standard",
    "motion_blur": False,
    "camera": {"position": [0, 0, 4], "target": [0, 0, 0]},
    "lights": {"sun": {"strength": 0}, "environment": {"light": "studio", "strength": 1}},
    "water": {"type": "colormap", "attribute": "speed", "low": 1, "high": "3 m/s", "roughness": 1},
}


@pytest.fixture
def color(film, write_mesh, tmp_path):
    """The colour in the middle of a picture of water that moves at a speed [m/s]."""
    simulation, surface = film
    (simulation / "bodies.csv").unlink()
    (simulation / "body_rock.ply").unlink()

    def call(speed: float, *shares: float, **settings: object) -> np.ndarray:
        corners = [(x, y, 0, 0, 0, 1, 0, 0, 0, speed, *shares) for x, y in ((-3, -3), (3, -3), (0, 4))]
        names = " ".join(["x y z nx ny nz vx vy vz speed", *("source_left", "source_my-tap")[: len(shares)]])
        write_mesh(surface / "surface_00000.ply", names, corners, [(0, 1, 2)])
        command = [sys.executable, "-m", "render", "--spec", json.dumps(SETTINGS | settings), "--frames", "0:0"]
        command += ["--simulation", str(simulation), "--surface", str(surface), "--out", str(tmp_path / "out")]
        done = subprocess.run([*command, "--threads", "1"], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
        picture = np.asarray(Image.open(tmp_path / "out" / "00000.png").convert("RGB"), dtype=float)
        return picture[7:11, 14:18].mean(axis=(0, 1))

    return call


def test_low_is_violet_and_high_is_yellow(color):
    """Of viridis, whatever the light: its ends are #440154 and #fde725, and beyond them the colour stays."""
    red, green, blue = color(1.0)
    assert blue > red > 2 * green
    red, green, blue = color(3.0)
    assert min(red, green) > 2 * blue
    assert color(30.0) == pytest.approx(np.array([red, green, blue]), abs=3)
    red, green, blue = color(2.0)
    assert green > 2 * red and blue > 2 * red


def test_sources_have_their_colours_which_mix_as_light(color):
    """Red and blue alone, and of half of each half of both, in a light that is dim enough for no channel to be full."""
    water = {"type": "palette", "colors": {"left": "#ff0000", "my-tap": "#0000ff"}, "roughness": 1}
    water |= {"principled": {"Specular IOR Level": 0.0}}
    lights = {"sun": {"strength": 0}, "environment": {"light": "studio", "strength": 0.3}}
    mixtures = ((1, 0), (0, 1), (0.5, 0.5))
    left, tap, both = (color(0.0, *shares, water=water, lights=lights) for shares in mixtures)
    assert 100 < left[0] < 250 and max(left[1:]) < 5
    assert 100 < tap[2] < 250 and max(tap[:2]) < 5
    assert both[1] < 5
    light = [((both[k] / 255 + 0.055) / 1.055) ** 2.4 for k in (0, 2)]
    whole = [((value / 255 + 0.055) / 1.055) ** 2.4 for value in (left[0], tap[2])]
    assert np.array(light) / whole == pytest.approx([0.5, 0.5], abs=0.05)
