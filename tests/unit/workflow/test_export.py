"""What `python -m workflow.export` writes of what a run has left; formats of packages are in test_additions.py."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from common.manifest import Manifest, spoiled
from workflow.export import gather
from workflow.formats import FORMATS

ROOT = Path(__file__).resolve().parents[3]
BALL = {"shape": {"type": "sphere", "radius": 0.1}, "position": [0, 1, 0], "motion": "dynamic"}


def python(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, "-m", *arguments], cwd=folder, env=environment, capture_output=True, text=True
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """With a scene of a ball that falls, and two frames of it."""
    made = tmp_path_factory.mktemp("export")
    (made / "scenes").mkdir()
    scene = {"duration": 0.04, "fps": 50, "rigid": {"bodies": {"ball": BALL}}}
    (made / "scenes" / "ball.yaml").write_text(json.dumps(scene))
    done = python(made, "sim", "run", "scenes/ball.yaml", "--out", "out")
    assert done.returncode == 0, done.stderr
    return made


def test_an_animation_is_written(folder):
    done = python(folder, "workflow.export", "ball", "--simulation", "out", "--out", "ball.usda")
    assert done.returncode == 0, done.stderr
    text = (folder / "ball.usda").read_text()
    assert text.startswith("#usda") and "ball" in text
    assert "endTimeCode = 2" in text


def test_the_parts_of_a_film_are_one_animation(folder, monkeypatch):
    """Each with a manifest, as jobs leave it, and with a table that belongs to all of them."""
    parts = []
    for index, frames in enumerate(("0:1", "2:2")):
        parts.append(folder / f"part{index}")
        state = ["--resume", parts[0] / "state_00001.npz"] if index else []
        done = python(folder, "sim", "run", "scenes/ball.yaml", "--frames", frames, "--out", parts[-1], *state)
        assert done.returncode == 0, done.stderr
        Manifest.of(parts[-1], "plan").write(parts[-1])
    whole = gather(parts, folder / "whole")
    assert spoiled(whole, ("",), None) is None
    assert (whole / "bodies.csv").read_text() == (folder / "out" / "bodies.csv").read_text()


def test_particles_of_a_film_have_the_sources_that_its_last_part_knows(tmp_path):
    for index, table in enumerate(("id,time,source\n0,0,drop\n", "id,time,source\n0,0,drop\n8,1,tap\n")):
        (tmp_path / f"part{index}").mkdir()
        (tmp_path / f"part{index}" / "sources.csv").write_text(table)
    whole = gather([tmp_path / "part0", tmp_path / "part1"], tmp_path / "whole")
    assert (whole / "sources.csv").read_text() == table


def test_every_format_is_offered_for_a_name_that_is_none(folder):
    done = python(folder, "workflow.export", "ball", "--simulation", "out", "--out", "ball.fbx")
    assert done.returncode == 2
    assert all(name in done.stderr for name in FORMATS)


@pytest.fixture(scope="module")
def wet(tmp_path_factory) -> Path:
    """With a scene of eight particles that would foam, and two frames of it."""
    made = tmp_path_factory.mktemp("wet")
    (made / "scenes").mkdir()
    drop = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 1, 0]}
    scene = {"duration": 0.02, "fps": 50, "fluid": {"particle_radius": 0.05, "bodies": {"drop": drop}}, "foam": {}}
    (made / "scenes" / "drop.yaml").write_text(json.dumps(scene))
    done = python(made, "sim", "run", "scenes/drop.yaml", "--out", "out")
    assert done.returncode == 0, done.stderr
    return made


def test_particles_need_no_surface(wet):
    """Those of a run, as points as wide as the particles are apart; that there is no foam yet is said."""
    spec = json.dumps({"surface": False, "particles": True})
    done = python(wet, "workflow.export", "drop", "--simulation", "out", "--out", "drop.usda", "--spec", spec)
    assert done.returncode == 0, done.stderr
    assert "no foam yet" in done.stderr
    text = (wet / "drop.usda").read_text()
    assert 'Xform "particles"' in text and 'Xform "water"' not in text
    assert f"float[] widths = [{', '.join(['0.1'] * 8)}]" in text


def test_water_without_a_surface_is_refused_with_both_ways_out(wet):
    done = python(wet, "workflow.export", "drop", "--simulation", "out", "--out", "drop.glb")
    assert done.returncode == 2
    assert "make the film first, or give --spec" in done.stderr and "particles" in done.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--out", "ball.usda"], "is missing. make the film first"),
        (["--out", "ball.usda", "--simulation", "nowhere"], "nowhere is missing. make the film first"),
        (["--out", "ball.usda", "--simulation", "out", "--spec", '{"scale": 2}'], "scale: Extra inputs"),
        (["--out", "ball.glb", "--simulation", "out", "--spec", '{"particles": true}'], "the scene has no fluid"),
    ],
)
def test_what_cannot_be_written_is_refused(folder, options, message):
    done = python(folder, "workflow.export", "ball", *options)
    assert done.returncode == 2
    assert message in done.stderr
