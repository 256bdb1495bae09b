"""A film in which a splash wets a ball and the ground, and what an edit of that repeats."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from PIL import Image

from common.ply import read_points
from tests.pipeline.conftest import ROOT, Project, source_tree

pytestmark = pytest.mark.slow
FILM = "renders/tiny/splash"
WETNESS = "  samples: 4\n  wetness: {}\n  materials: {ball: {type: matte, color: '#808080'}}\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Project:
    project = source_tree(tmp_path_factory.mktemp("wetness") / "project")
    (project.folder / "scenes/tiny").mkdir()
    shutil.copy(ROOT / "scenes/tiny/splash.yaml", project.folder / "scenes/tiny")
    project.edit("  samples: 4\n", WETNESS, scene(project))
    project.make(FILM)
    return project


@pytest.fixture
def project(made: Project, tmp_path) -> Project:
    return Project(shutil.copytree(made.folder, tmp_path / "project", symlinks=True))


def scene(project: Project):
    return project.folder / "scenes/tiny/splash.yaml"


def test_the_splash_wets_the_ball_from_above(made):
    """At default settings: dry before it is hit, wet on top after it, and never dry again in half a second."""
    paths = sorted((made.folder / "results/tiny/splash/standard/wet").glob("*/wet_body_ball_*.ply"))
    counts = [len(read_points(path)) for path in paths]
    assert len(paths) == 7
    assert counts[0] == 0
    assert counts == sorted(counts)
    assert read_points(paths[-1])["y"].max() > 0.15
    summary = json.loads((made.folder / FILM / "summary.json").read_text())
    assert summary["wall_s"]["wet"]["total"] > 0


def test_it_is_seen(project):
    before = np.asarray(Image.open(project.folder / FILM / "frames/00006.png").convert("L"), float)
    project.edit("  wetness: {}\n", "", scene(project))
    assert project.dry_run(FILM).stages == {"render", "film"}
    project.make(FILM)
    after = np.asarray(Image.open(project.folder / FILM / "frames/00006.png").convert("L"), float)
    assert (before < after - 10).sum() > 50


@pytest.mark.parametrize(
    ("old", "new", "stages"),
    [
        ("wetness: {}", "wetness: {drying_time: 1 s}", {"wet", "render", "film"}),
        ("wetness: {}", "wetness: {drying_time: 10 s}", set()),
        ("'#808080'", "'#dddddd'", {"render", "film"}),
        ("particle_radius: 25 mm", "particle_radius: 26 mm", {"simulate", "reconstruct", "wet", "render", "film"}),
    ],
)
def test_what_an_edit_repeats(project, old, new, stages):
    assert project.dry_run(FILM).nothing
    project.edit(old, new, scene(project))
    assert project.dry_run(FILM).stages == stages
