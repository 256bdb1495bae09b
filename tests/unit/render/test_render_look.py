"""Passes, seeds, overrides of materials and moving cameras, in tiny pictures of a wall."""

import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

DISTANCE = 5.0
PLACED = {"position": [0, 1, DISTANCE], "target": [0, 1, 0]}
DIM = {"sun": {"strength": 0}, "environment": {"strength": 0.05}}
TINY = {"resolution": [32, 18], "samples": 1, "ground": {"enabled": False}, "camera": PLACED, "motion_blur": False}


@pytest.fixture
def wall(tmp_path, write_mesh):
    """A wall of 4 m by 4 m in the plane z = 0, whose front is lit."""
    simulation = tmp_path / "simulation"
    simulation.mkdir()
    corners = [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)]
    write_mesh(simulation / "body_wall.ply", "x y z", corners, [(0, 1, 2), (0, 2, 3)])
    rows = ["frame,time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"]
    rows += [f"{frame},{frame / 24},wall,0,1,0,1,0,0,0,0,0,0,0,0,0" for frame in (0, 1)]
    (simulation / "bodies.csv").write_text("\n".join(rows) + "\n")
    (simulation / "summary.json").write_text(json.dumps({"extent": {"min": [-2, -1, -0.5], "max": [2, 3, 0.5]}}))
    return simulation


def render(simulation, out, *options, frames="0:1", **settings):
    command = [sys.executable, "-m", "render", "--spec", json.dumps(TINY | settings), "--frames", frames]
    command += ["--simulation", str(simulation), "--out", str(out), "--threads", "1", *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return [np.asarray(Image.open(path).convert("RGB"), dtype=float) for path in sorted(out.glob("*.png"))]


def test_passes_hold_what_is_there(wall, tmp_path):
    """The depth of a wall that the camera faces is its distance; its normal points at the camera."""
    import OpenEXR

    out = tmp_path / "out"
    render(wall, out, passes=["depth", "normal", "objects"], frames="0:0")
    assert sorted(path.name for path in out.iterdir()) == ["00000.exr", "00000.png", "summary.json"]
    with OpenEXR.File(str(out / "00000.exr"), separate_channels=True) as file:
        values = {name: channel.pixels for name, channel in file.channels().items()}
        header = {name: str(value) for name, value in file.header().items()}
    depth = next(pixels for name, pixels in values.items() if name.endswith(("Depth.Z", "Depth.V")))
    assert depth.dtype == np.float32 and depth.shape == (18, 32)
    assert depth[9, 16] == pytest.approx(DISTANCE, rel=1e-4)
    normal = [next(pixels for name, pixels in values.items() if name.endswith(f"Normal.{axis}")) for axis in "XYZ"]
    assert [pixels[9, 16] for pixels in normal] == pytest.approx([0, -1, 0], abs=1e-3)
    assert any(name.startswith("cryptomatte/") and '"wall"' in value for name, value in header.items())


def test_noise_hangs_still_unless_its_seed_is_animated(wall, tmp_path):
    noisy = {"denoise": False, "noise_threshold": 0, "lights": {"sun": {"angle": 90}}}
    still = render(wall, tmp_path / "still", **noisy)
    moving = render(wall, tmp_path / "moving", animated_seed=True, **noisy)
    assert (still[0] == still[1]).all()
    assert np.abs(moving[0] - moving[1]).max() > 5


def test_denoising_of_each_quality_takes_noise_away(wall, tmp_path):
    noisy = {"noise_threshold": 0, "lights": {"sun": {"angle": 90}}, "frames": "0:0"}
    ways = {"none": {"denoise": False}} | {name: {"denoise_quality": name} for name in ("high", "balanced", "fast")}
    found = {name: render(wall, tmp_path / name, **noisy, **way)[0] for name, way in ways.items()}
    grain = {name: np.abs(np.diff(picture, axis=1)).mean() for name, picture in found.items()}
    assert max(grain[name] for name in ("high", "balanced", "fast")) < grain["none"] / 2
    assert (found["high"] != found["fast"]).any()


def test_any_input_of_the_principled_shader_can_be_set(wall, tmp_path):
    look = {"type": "plastic", "color": "#000000"}
    glow = look | {"principled": {"Emission Color": "#ff0000", "Emission Strength": 5}}
    dark, bright = (
        render(wall, tmp_path / name, materials={"wall": found}, lights=DIM, frames="0:0")[0][9, 16]
        for name, found in (("dark", look), ("bright", glow))
    )
    assert bright[0] > dark[0] + 100 and bright[0] > bright[2] + 50


def test_a_camera_that_moves_sees_the_wall_from_both_places(wall, tmp_path):
    there = [{"at": 0, **PLACED}, {"at": 1 / 24, "position": [0, 1, 50], "target": [0, 1, 0]}]
    near, far = render(wall, tmp_path / "moved", camera={"keyframes": there}, materials={"wall": {"type": "matte"}})
    still = render(wall, tmp_path / "still", materials={"wall": {"type": "matte"}}, frames="0:0")[0]
    assert np.abs(near - still).max() <= 2
    assert np.abs(far - still).mean() > 5


@pytest.mark.skipif(shutil.which("blender") is None, reason="needs a Blender that is installed, as Debian's package")
def test_a_stock_blender_opens_the_scene_with_all_that_is_in_it(wall, tmp_path):
    blend = tmp_path / "scene.blend"
    render(wall, tmp_path / "out", "--save-blend", str(blend), "--blender", "blender", frames="0:0")
    told = (
        "import bpy; o = bpy.data.objects['wall']; print('TOLD', len(o.data.polygons), bool(bpy.context.scene.camera), "
    )
    told += "all(i.packed_file for i in bpy.data.images if i.source == 'FILE'), o.material_slots[0].material.name)"
    command = ["blender", "-b", "--factory-startup", str(blend), "--python-exit-code", "3", "--python-expr", told]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "TOLD 2 True True wall" in done.stdout, done.stdout


def test_a_panorama_that_is_no_picture_is_refused(wall, tmp_path):
    """Blender would show it in pink."""
    (tmp_path / "sky.hdr").write_text("#?RADIANCE not really")
    settings = TINY | {"lights": {"environment": {"file": str(tmp_path / "sky.hdr")}}}
    command = [sys.executable, "-m", "render", "--spec", json.dumps(settings), "--frames", "0:0"]
    command += ["--simulation", str(wall), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 2, done.stderr
    assert "lights.environment: Blender cannot read the image" in done.stderr
    assert not list((tmp_path / "out").glob("*.png"))
