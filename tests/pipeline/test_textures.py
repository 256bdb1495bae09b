"""Images on bodies, from the files of a scene to the colours of a picture: up is up, left is left."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scene.load import load
from tests.support import textured
from tests.support.textured import QUARTERS, quarters
from workflow.plan.jobs import Plan

ROOT = Path(__file__).resolve().parents[2]
SCENE = """\
duration: 0.5
fps: 2
gravity: [0, 0, 0]
rigid: {{bodies: {{crate: {body}}}}}
render:
  resolution: [64, 64]
  samples: 4
  view_transform: Standard
  ground: {ground}
  camera: {{position: {camera}, target: [0, 0, 0]}}
  lights: {{sun: {{azimuth: {azimuth}, elevation: 20, strength: 3}}, environment: {{strength: {environment}}}}}
  materials: {materials}
"""
TOP = "[0, 3, 0.01]"
USUAL = {"camera": "[0, 0, 3]", "ground": "{enabled: false}", "azimuth": 0, "environment": 0.3}
QUARTER_TURN = "[{axis: [0, 1, 0], angle: 90}]"
BOX = "{type: box, size: [1, 1, 1]}"
MATTE = "{type: matte, texture: quarters.png}"


def body(shape: str = BOX, rotation: str = "[]") -> str:
    return f"{{shape: {shape}, motion: static, rotation: {rotation}}}"


def mesh(file: str) -> str:
    return f"{{type: mesh, file: {file}}}"


def run(folder: Path, *words: object, **options: str) -> None:
    command = [sys.executable, "-m", *map(str, words)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=200, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture
def filmed(tmp_path, monkeypatch):
    """The first picture of a scene, made by the commands that a film runs."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    scenes = tmp_path / "scenes"
    scenes.mkdir()
    textured.write(scenes)

    def film(crate: str, materials: str = "{}", **changes: object) -> np.ndarray:
        path = scenes / "scene.yaml"
        path.write_text(SCENE.format(**USUAL | {"body": crate, "materials": materials} | changes))
        run(tmp_path, "sim", "run", path, "--out", "sim", "--frames", "0:0", "--quiet")
        spec = Plan(load(path), ROOT).job("render").spec
        run(tmp_path, "render", "--spec", "-", "--simulation", "sim", "--frames", "0:0", "--out", "frames", input=spec)
        return np.asarray(Image.open(tmp_path / "frames" / "00000.png").convert("RGB"), dtype=int)

    return film


@pytest.mark.parametrize("file", ["cube.obj", "cube.glb", "cube.ply"])
def test_a_mesh_file_brings_its_materials(filmed, file):
    assert quarters(filmed(body(mesh(file)))) == QUARTERS


def test_so_it_does_on_its_upper_side_however_it_is_turned(filmed):
    """A quarter turn about the vertical takes its right to the back."""
    upper_left, upper_right, lower_left, lower_right = QUARTERS
    turned = (upper_right, lower_right, upper_left, lower_left)
    assert quarters(filmed(body(mesh("cube.glb"), QUARTER_TURN), camera=TOP)) == turned


def test_another_look_wins(filmed):
    assert quarters(filmed(body(mesh("cube.obj")), "{crate: {type: matte, color: '#ff0000'}}")) == ("red",) * 4


@pytest.mark.parametrize("file", ["plain.obj", "cube.glb"])
def test_a_texture_lies_as_uv_say(filmed, file):
    assert quarters(filmed(body(mesh(file)), f"{{crate: {MATTE}}}")) == QUARTERS


@pytest.mark.parametrize("look", ["plastic", "stone"])
def test_a_body_without_uv_has_it_as_from_a_box(filmed, look):
    crate = f"{{crate: {{type: {look}, texture: quarters.png}}}}"
    assert quarters(filmed(body(rotation=QUARTER_TURN), crate)) == QUARTERS


def test_the_ground_has_it_with_its_top_to_the_back(filmed):
    ground = "{height: -1, material: {type: matte, texture: quarters.png, texture_size: 6}}"
    crate = body("{type: box, size: [0.1, 0.1, 0.1]}")
    assert quarters(filmed(crate, camera=TOP, ground=ground)) == QUARTERS


def test_a_map_of_directions_leans_surfaces(filmed, tmp_path):
    """The right half leans to the right by 45 deg, away from a sun that stands on the left."""
    leaning = np.full((4, 4, 3), (128, 128, 255), np.uint8)
    leaning[:, 2:] = (218, 128, 218)
    Image.fromarray(leaning).save(tmp_path / "scenes" / "leaning.png")
    image = filmed(body(), "{crate: {type: matte, normal_map: leaning.png}}", azimuth=-60)
    assert image[32, 22].mean() > image[32, 42].mean() + 30


def test_a_map_of_roughness_dulls_a_mirror(filmed, tmp_path):
    """What mirrors a dark room but for the sun shows that where it is rough alone."""
    halves = np.zeros((4, 4), np.uint8)
    halves[:, 2:] = 255
    Image.fromarray(halves).save(tmp_path / "scenes" / "halves.png")
    image = filmed(body(), "{crate: {type: metal, roughness_map: halves.png}}", azimuth=-60, environment=0)
    assert image[32, 42].mean() > image[32, 22].mean() + 30
