"""Pictures without a background: what is opaque, what is shadow, and what is seen through."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
import trimesh
from PIL import Image

GLASS = {"materials": {"ball": {"type": "glass"}}}


def picture(tmp_path, write_mesh, *, passes=(), **settings):
    """A ball that stands on the ground: red, green, blue and alpha [72, 128, 4], 0 to 255."""
    simulation, out = tmp_path / "simulation", tmp_path / "out"
    simulation.mkdir(parents=True)
    ball = trimesh.creation.icosphere(4, 0.3)
    ball.apply_translation([0, 0.3, 0])
    write_mesh(simulation / "body_ball.ply", "x y z", ball.vertices.tolist(), ball.faces.tolist())
    head = "frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"
    (simulation / "bodies.csv").write_text(f"{head}\n0,0,ball,0,0,0,1,0,0,0,0,0,0,0,0,0\n")
    extent = {"min": [-0.8, 0, -0.4], "max": [0.8, 0.6, 0.4]}
    (simulation / "summary.json").write_text(json.dumps({"extent": extent}))
    spec = {"resolution": [128, 72], "samples": 16, "motion_blur": False, "passes": list(passes)}
    spec |= {"lights": {"sun": {"azimuth": -90, "elevation": 40}}, "camera": {"azimuth": 0, "elevation": 25}}
    command = [sys.executable, "-m", "render", "--spec", json.dumps(spec | settings), "--frames", "0:0"]
    command += ["--simulation", str(simulation), "--out", str(out), "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return np.asarray(Image.open(out / "00000.png")).astype(float)


TRANSPARENT = {"background": {"type": "transparent"}}


def test_alpha_is_one_on_things_none_beside_them_and_some_in_their_shadows(tmp_path, write_mesh):
    """The sun is on the left: the shadow lies on the right of the ball."""
    alpha = picture(tmp_path, write_mesh, **TRANSPARENT)[..., 3]
    left, middle, right = alpha[40:52, 20:35], alpha[34:40, 60:68], alpha[44:50, 84:92]
    assert middle.min() == 255
    assert left.max() < 40, "ambient occlusion alone"
    assert 60 < right.mean() < 250


def test_without_a_ground_there_is_no_shadow(tmp_path, write_mesh):
    alpha = picture(tmp_path, write_mesh, ground={"enabled": False}, **TRANSPARENT)[..., 3]
    assert alpha[34:40, 60:68].min() == 255
    assert alpha[:, 86:].max() == 0


def test_glass_is_seen_through(tmp_path, write_mesh):
    alpha = picture(tmp_path, write_mesh, ground={"enabled": False}, **TRANSPARENT, **GLASS)[..., 3]
    assert alpha[34:40, 60:68].mean() < 100


def test_layers_have_alpha_too(tmp_path, write_mesh):
    import OpenEXR

    picture(tmp_path, write_mesh, passes=["depth"], ground={"enabled": False}, **TRANSPARENT)
    with OpenEXR.File(str(tmp_path / "out" / "00000.exr"), separate_channels=True) as file:
        alpha = file.channels()["ViewLayer.Combined.A"].pixels
    assert (alpha[37, 64], alpha[2, 2]) == (1, 0)


def test_other_backgrounds_are_opaque(tmp_path, write_mesh):
    assert picture(tmp_path, write_mesh).shape == (72, 128, 3)


@pytest.mark.parametrize("name", ["studio", "table"])
def test_a_set_is_there_all_the_same(tmp_path, write_mesh, name):
    alpha = picture(tmp_path, write_mesh, set=name, **TRANSPARENT)[..., 3]
    assert alpha[60:, 40:90].min() == 255
