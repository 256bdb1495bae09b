"""Small pictures by the render stage, in linear light."""

import json
import subprocess
import sys

import numpy as np
from PIL import Image

EXACT = {
    "samples": 4,
    "noise_threshold": 0,
    "denoise": False,
    "motion_blur": False,
    "passes": ["normal"],
    "ground": {"enabled": False},
}
"""Settings of pictures that are measured."""
HEAD = "frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"


def white_light(folder):
    """Settings by which light of 1 comes from everywhere, and is seen."""
    Image.new("RGB", (16, 8), "white").save(folder / "white.png")
    light = {"sun": {"strength": 0}, "environment": {"file": str(folder / "white.png"), "strength": 1}}
    return {"lights": light, "background": {"type": "environment"}}


def extent(simulation, low, high):
    """Make the folder of a simulation in which things happen between two corners [m]."""
    simulation.mkdir(exist_ok=True)
    (simulation / "summary.json").write_text(json.dumps({"extent": {"min": low, "max": high}}))


def rest(simulation, **places):
    """Have bodies lie at their places [m] in frame 0."""
    rows = [f"0,0,{name},{x},{y},{z},1,0,0,0,0,0,0,0,0,0" for name, (x, y, z) in places.items()]
    (simulation / "bodies.csv").write_text("\n".join([HEAD, *rows]) + "\n")


def passes(simulation, out, **settings):
    """Frame 0: red, green, blue [height, width, 3], and normals in Blender's axes, likewise."""
    import OpenEXR

    command = [sys.executable, "-m", "render", "--spec", json.dumps(EXACT | settings), "--frames", "0:0"]
    command += ["--simulation", str(simulation), "--out", str(out), "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr
    with OpenEXR.File(str(out / "00000.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    return tuple(
        np.stack([channels[f"ViewLayer.{kind}.{axis}"] for axis in axes], axis=-1)
        for kind, axes in (("Combined", "RGB"), ("Normal", "XYZ"))
    )
