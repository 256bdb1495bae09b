"""`import tidemill`: scenes, frames as arrays, surfaces and pictures, in a script."""

from __future__ import annotations

import filecmp
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tidemill
from tests.support.in_time import in_time

ROOT = Path(__file__).resolve().parents[3]
SCENE = {
    "duration": 0.1,
    "fps": 20,
    "containers": {"tank": {"type": "box", "size": [0.4, 0.4, 0.4]}},
    "fluid": {
        "particle_radius": 0.02,
        "bodies": {"pool": {"shape": {"type": "box", "size": [0.4, 0.12, 0.4]}, "position": [0, 0.06, 0]}},
    },
    "rigid": {
        "bodies": {
            "ball": {"shape": {"type": "sphere", "radius": 0.06}, "motion": "dynamic", "position": [0, 0.3, 0]},
        }
    },
    "cloth": {
        "integrator": "implicit_euler",
        "sheets": {
            "rag": {"shape": {"type": "sheet", "size": [0.1, 0.1]}, "spacing": 0.02, "position": [0.1, 0.35, 0.1]}
        },
    },
    "render": {"resolution": [64, 36], "samples": 1},
}


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("script") / "scenes" / "pond.yaml"
    path.parent.mkdir()
    path.write_text(json.dumps(SCENE))
    return path


@pytest.fixture(scope="module")
def frames(path):
    return list(tidemill.simulate(tidemill.load(path), arch="cpu", threads=1))


@pytest.mark.slow
def test_frames_are_arrays(frames):
    assert [(frame.number, frame.time) for frame in frames] == [(0, 0.0), (1, 0.05), (2, 0.1)]
    last = frames[-1]
    assert last.positions.shape == last.velocities.shape == (len(last.fluid), 3)
    assert last.positions.dtype == np.float32 and np.isfinite(last.positions).all()
    assert (np.diff(last.fluid["id"]) > 0).all()
    (rag,) = last.cloth.values()
    assert rag.vertices.shape == rag.velocities.shape == (36, 3)
    assert rag.triangles.shape == (50, 3) and rag.triangles.max() == 35


@pytest.mark.slow
def test_a_body_falls_freely(frames):
    fallen = frames[0].bodies["ball"].position[1] - frames[2].bodies["ball"].position[1]
    assert fallen == pytest.approx(9.81 * 0.1**2 / 2, abs=1e-6)
    assert frames[2].bodies["ball"].velocity == pytest.approx([0, -0.981, 0], abs=1e-6)


@pytest.mark.slow
def test_files_are_those_of_a_run(path, tmp_path):
    list(tidemill.simulate(tidemill.load(path), out=tmp_path / "script", arch="cpu", threads=1))
    command = [sys.executable, "-m", "sim", "run", str(path), "--out", str(tmp_path / "run"), "--arch", "cpu"]
    subprocess.run([*command, "--threads", "1", "--quiet"], cwd=ROOT, check=True, capture_output=True)
    names = sorted(file.name for file in (tmp_path / "run").glob("*.ply"))
    assert len(names) > 6
    assert filecmp.cmpfiles(tmp_path / "script", tmp_path / "run", names, shallow=False) == (names, [], [])
    again = list(tidemill.frames(tmp_path / "run"))
    assert [frame.number for frame in again] == [0, 1, 2]
    assert again[2].bodies["ball"].position[1] < 0.26


@pytest.mark.parametrize(
    "materials",
    [{"containers", "fluid"}, *in_time({"rigid"}, {"cloth"})],
    ids=lambda materials: max(materials),
)
def test_the_frames_of_one_material_alone(tmp_path, materials):
    absent = {"containers", "fluid", "rigid", "cloth"} - materials
    path = tmp_path / "alone.yaml"
    path.write_text(json.dumps({name: value for name, value in SCENE.items() if name not in absent}))
    written = list(tidemill.simulate(tidemill.load(path), out=tmp_path, arch="cpu", threads=1))
    read = list(tidemill.frames(tmp_path))
    assert [(frame.number, frame.time) for frame in read] == [(0, 0.0), (1, 0.05), (2, 0.1)]
    for one, other in zip(written, read, strict=True):
        assert np.array_equal(one.positions, other.positions)
        assert one.bodies.keys() == other.bodies.keys() == ({"ball"} if materials == {"rigid"} else set())
        assert one.cloth.keys() == other.cloth.keys() == ({"rag"} if materials == {"cloth"} else set())


def test_files_go_with_the_last_frame():
    scene = tidemill.load("stack", quality="draft")
    frame = next(iter(tidemill.simulate(scene, last=0, arch="cpu")))
    folder = frame.folder
    assert folder.is_dir() and "brick00" in frame.bodies
    assert frame.fluid is None and frame.positions.shape == (0, 3) and frame.cloth == {}
    del frame
    assert not folder.exists()


def test_settings_by_their_paths(path):
    scene = tidemill.load(path, settings={"fluid.viscosity": 0.5, "gravity": [0, -1.62, 0]})
    assert scene.simulation.fluid.viscosity == 0.5 and scene.simulation.gravity == (0, -1.62, 0)
    assert tidemill.load("bowl", quality="draft").quality == "draft"
    with pytest.raises(tidemill.SceneError, match="did you mean"):
        tidemill.load(path, settings={"fluid.viscocity": 0.5})


@pytest.mark.slow
def test_a_surface(path, frames):
    surface = tidemill.reconstruct(tidemill.load(path), frames[0])
    assert surface.volume == pytest.approx(0.4 * 0.12 * 0.4, rel=0.1)
    assert np.isfinite(surface.velocities).all()


@pytest.mark.slow
def test_no_surface_without_fluid(frames):
    with pytest.raises(tidemill.Refused, match="no fluid"):
        tidemill.reconstruct(tidemill.load("stack"), frames[0])


@pytest.mark.slow
def test_a_picture(path, frames, tmp_path):
    made = tidemill.render(tidemill.load(path), frames[1], tmp_path / "pictures" / "pond.png")
    with Image.open(made) as picture:
        assert picture.size == (64, 36)
        assert np.asarray(picture).std() > 5
    with pytest.raises(tidemill.RenderFailed, match="nowhere is not a folder"):
        tidemill.render(
            tidemill.load(path),
            tidemill.Frame(7, 0.35, tmp_path / "nowhere"),
            tmp_path / "none.png",
            tidemill.reconstruct(tidemill.load(path), frames[0]),
        )


@pytest.mark.slow
def test_a_picture_in_false_colours(path, frames, tmp_path):
    """Of the fluid's own speed: the first colour of inferno is black, the last one pale yellow."""
    found = []
    for high in (1e-9, 1e6):
        look = {"type": "colormap", "high": high, "map": "inferno"}
        scene = tidemill.load(path, settings={"render.water": look, "surface.attributes": ["speed"]})
        with Image.open(tidemill.render(scene, frames[1], tmp_path / f"{high}.png")) as picture:
            found.append(np.asarray(picture.convert("L"), float)[20:, 24:40].mean())
    assert found[0] > found[1] + 50


def test_the_command_loads_none_of_it():
    code = "import sys, tidemill.commands; print('numpy' in sys.modules, 'tidemill.interface' in sys.modules)"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
    assert not hasattr(tidemill, "nothing")
