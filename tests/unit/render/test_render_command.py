"""`python -m render` from end to end, in tiny pictures."""

import json
import os
import shutil
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

TINY = {"resolution": [32, 18], "samples": 1}
PROMPTLY = 120
"""Seconds: bpy hangs for ever at exit if a handler is left."""


def run(film, out, spec, *options, frames="0:0"):
    simulation, surface = film
    command = [sys.executable, "-m", "render", "--spec", json.dumps(spec), "--frames", frames, "--out", str(out)]
    command += ["--simulation", str(simulation), *(["--surface", str(surface)] if surface else []), *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=PROMPTLY)


def picture(path):
    return np.asarray(Image.open(path).convert("RGB"), dtype=float)


def test_pictures_and_summary(film, tmp_path):
    blend = tmp_path / "scene.blend"
    done = run(film, tmp_path / "out", TINY, "--save-blend", str(blend), "--threads", "1", frames="0:1")
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(tmp_path / "out")) == ["00000.png", "00001.png", "summary.json"]
    first, second = (picture(tmp_path / "out" / name) for name in ("00000.png", "00001.png"))
    assert first.shape == (18, 32, 3)
    assert first.std() > 2
    assert np.abs(first - second).max() > 20, "the water of frame 0 should be gone in frame 1"
    assert blend.stat().st_size > 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "done"
    assert summary["frames"] == {"first": 0, "last": 1, "count": 2, "without_water": [1]}
    assert set(summary["wall_s"]) == {"import", "load", "build", "render", "write", "total"}
    assert summary["threads"] == 1
    assert done.stdout == ""
    assert [line.split(":")[0] for line in done.stderr.splitlines()] == ["frame 0 (1 of 2)", "frame 1 (2 of 2)"]


def test_the_same_frame_has_the_same_bytes_in_any_block(film, tmp_path):
    for name, frames in (("one", "1:1"), ("two", "0:1")):
        assert run(film, tmp_path / name, TINY, "--threads", "1", frames=frames).returncode == 0
    assert (tmp_path / "one" / "00001.png").read_bytes() == (tmp_path / "two" / "00001.png").read_bytes()


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ({"samples": -1}, "samples"),
        ({**TINY, "blender": "no/such/blender"}, "blender"),
        ({**TINY, "lights": {"environment": {"file": "gone.hdr"}}}, "gone.hdr"),
    ],
)
def test_refusals(film, tmp_path, spec, said):
    done = run(film, tmp_path / "out", spec)
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_a_blender_that_is_not_there_is_refused(film, tmp_path):
    done = run(film, tmp_path / "out", TINY, "--blender", "no/such/blender")
    assert (done.returncode, "no/such/blender" in done.stderr) == (2, True)


def test_a_missing_extent_is_refused(film, tmp_path):
    (film[0] / "summary.json").unlink()
    done = run(film, tmp_path / "out", TINY)
    assert (done.returncode, "extent" in done.stderr) == (2, True)


def test_a_missing_surface_is_refused_before_a_picture_is_taken(film, tmp_path):
    done = run(film, tmp_path / "out", TINY, frames="7:7")
    assert (done.returncode, "surface_00007.ply" in done.stderr) == (2, True)
    assert os.listdir(tmp_path / "out") == []


def test_a_folder_that_can_not_be_made_is_a_failure(film, tmp_path):
    (tmp_path / "file").write_text("")
    done = run(film, tmp_path / "file" / "out", TINY)
    assert done.returncode == 1
    assert "cannot make the folder" in done.stderr


@pytest.mark.skipif(shutil.which("blender") is None, reason="no installed Blender")
def test_an_installed_blender_takes_the_place_of_the_wheel(film, tmp_path):
    done = run(film, tmp_path / "out", TINY, "--blender", "blender", frames="0:1")
    assert done.returncode == 0, done.stderr
    first, second = (picture(tmp_path / "out" / name) for name in ("00000.png", "00001.png"))
    assert first.shape == (18, 32, 3)
    assert np.abs(first - second).max() > 20


@pytest.mark.parametrize("moving", ["water", "body"])
def test_streaks_are_as_long_as_the_way_while_the_shutter_is_open(tmp_path, write_mesh, moving):
    # way = speed * shutter / fps = 12 m/s * 0.5 / 12 Hz = 0.5 m
    simulation, surface = tmp_path / "simulation", tmp_path / "surface"
    simulation.mkdir()
    surface.mkdir()
    corners, faces = [(-0.1, -0.1, 0), (0.1, -0.1, 0), (0.1, 0.1, 0), (-0.1, 0.1, 0)], [(0, 1, 2), (0, 2, 3)]
    if moving == "water":
        vertices = [(*corner, 0, 0, 1, 12, 0, 0) for corner in corners]
        write_mesh(surface / "surface_00000.ply", "x y z nx ny nz vx vy vz", vertices, faces)
    else:
        write_mesh(simulation / "body_plate.ply", "x y z", corners, faces)
        row = "0,0,plate,0,0,0,1,0,0,0,12,0,0,0,0,0"
        (simulation / "bodies.csv").write_text(f"frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n{row}\n")
    extent = {"min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5]}
    (simulation / "summary.json").write_text(json.dumps({"extent": extent}))
    spec = {
        "resolution": [160, 90],
        "samples": 64,
        "noise_threshold": 0,
        "denoise": False,
        "ground": {"enabled": False},
        "background": {"type": "plain", "color": "#fff"},
        "view_transform": "Standard",
        "exposure": -1,
        # 0.08 rad across 160 pixels from 20 m away: 1 m is 100 pixels
        "camera": {"position": [0, 0, 20], "target": [0, 0, 0], "focal_length": 0.036 / 0.08},
        "water": {"type": "matte", "color": "#000"},
        "materials": {"plate": {"type": "matte", "color": "#000"}},
    }
    used = surface if moving == "water" else None
    done = run((simulation, used), tmp_path / "out", spec, "--fps", "12")
    assert done.returncode == 0, done.stderr
    light = (picture(tmp_path / "out" / "00000.png")[45].mean(axis=1) / 255) ** 2.2
    share = 1 - light / light[0]
    # a plate that moves farther than its width hides a trapezoid: at half its height it is as wide as the way
    hidden = np.flatnonzero(share > share.max() / 2)
    assert len(hidden) == pytest.approx(100 * 0.5, abs=3)
    assert hidden.mean() == pytest.approx(79.5, abs=2), "the streak should be centred on the frame"
