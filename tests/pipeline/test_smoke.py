"""The tiny scenes of the project, through all the real stages."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image
from plyfile import PlyData

from tests.pipeline.conftest import ROOT, Project, source_tree

FRAMES = {"splash": 7, "drain": 10, "still": 4}


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> Project:
    project = source_tree(tmp_path_factory.mktemp("smoke") / "project")
    shutil.copytree(ROOT / "scenes" / "tiny", project.folder / "scenes" / "tiny")
    # With a slash at the end, as the shell completes the name of a folder.
    project.make("renders/tiny/splash", "renders/tiny/drain/", "renders/tiny/still")
    return project


def folder(films: Project, name: str) -> Path:
    return films.folder / "renders" / "tiny" / name


def surfaces(films: Project, name: str, quality: str) -> list[int]:
    """Vertices of the surface of each frame."""
    files = sorted((films.folder / "results" / "tiny" / name / quality / "surface").glob("*/surface_*.ply"))
    return [PlyData.read(file)["vertex"].count for file in files]


@pytest.mark.parametrize("name", FRAMES)
def test_the_film_is_whole(films, name):
    made = folder(films, name)
    reader = imageio_ffmpeg.read_frames(made / f"{name}.mp4")
    size = next(reader)["size"]
    assert size == (160, 90)
    assert sum(1 for _ in reader) == FRAMES[name]
    pictures = sorted((made / "frames").glob("*.png"))
    assert [picture.name for picture in pictures] == [f"{frame:05d}.png" for frame in range(FRAMES[name])]
    for picture in pictures:
        pixels = np.asarray(Image.open(picture).convert("RGB"), dtype=float)
        assert pixels.shape == (90, 160, 3)
        assert pixels.std() > 3, f"{picture} is blank"
    assert Image.open(made / "contact.png").width > 160
    summary = json.loads((made / "summary.json").read_text())
    assert summary["status"] == "done"
    assert summary["frames"] == FRAMES[name]


def test_the_splash_moves(films):
    pictures = [np.asarray(Image.open(folder(films, "splash") / "frames" / f"{i:05d}.png"), float) for i in (0, 6)]
    assert np.abs(pictures[0] - pictures[1]).mean() > 1
    assert min(surfaces(films, "splash", "standard")) > 0


def test_frames_without_water_are_rendered(films):
    counts = surfaces(films, "drain", "draft")
    assert counts[0] == counts[1] == 0, "the water has not come yet"
    assert min(counts[2:7]) > 0
    assert counts[8] == counts[9] == 0, "the water has gone"


def test_a_scene_without_fluid_has_nothing_to_reconstruct(films):
    assert not (films.folder / "results" / "tiny" / "still" / "draft" / "surface").exists()
    planned = films.snakemake("--dry-run", "--forceall", "renders/tiny/still")
    assert planned.code == 0, planned.text
    assert planned.stages == {"simulate", "render", "film"}


def test_all_is_up_to_date_afterwards(films):
    assert films.dry_run("renders/tiny/splash", "renders/tiny/drain", "renders/tiny/still").nothing
