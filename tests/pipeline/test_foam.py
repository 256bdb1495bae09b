"""A film whose water foams, and what an edit of the foam repeats."""

from __future__ import annotations

import csv
import json
import shutil

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from common.ply import read_points
from tests.pipeline.conftest import ROOT, Project, source_tree

pytestmark = pytest.mark.slow
FILM = "renders/tiny/foam"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Project:
    project = source_tree(tmp_path_factory.mktemp("foam") / "project")
    (project.folder / "scenes/tiny").mkdir()
    shutil.copy(ROOT / "scenes/tiny/foam.yaml", project.folder / "scenes/tiny")
    project.make(FILM)
    return project


@pytest.fixture
def project(made: Project, tmp_path) -> Project:
    return Project(shutil.copytree(made.folder, tmp_path / "project", symlinks=True))


def scene(project: Project):
    return project.folder / "scenes/tiny/foam.yaml"


def test_the_splash_foams_within_the_tank(made):
    segments = sorted((made.folder / "results/tiny/foam/standard/foam").glob("*/foam_*.ply"))
    assert len(segments) == 10
    counts = [len(read_points(path)) for path in segments]
    assert counts[0] == 0
    assert counts[-1] > 100
    for path in segments:
        points = read_points(path)
        assert (np.abs(points["x"]) <= 0.4001).all()
        assert (points["y"] >= -1e-4).all()
    summary = json.loads((made.folder / FILM / "summary.json").read_text())
    assert summary["wall_s"]["foam"]["total"] > 0


def test_no_foam_is_in_the_crate_that_it_carries_off(made):
    """In the crate's own axes, as bodies.csv has them, all is beyond one of its sides."""
    base = made.folder / "results/tiny/foam/standard"
    rows = [row for path in sorted(base.glob("simulation/*/bodies.csv")) for row in csv.DictReader(path.open())]
    places = {int(row["frame"]): row for row in rows}
    moved = [float(places[9][axis]) - float(places[0][axis]) for axis in "xz"]
    assert np.hypot(*moved) > 0.02
    near = 0
    for path in base.glob("foam/*/foam_*.ply"):
        points, row = read_points(path), places[int(path.stem.removeprefix("foam_"))]
        away = np.stack([points[axis].astype(float) - float(row[axis]) for axis in "xyz"], axis=1)
        turn = Rotation.from_quat([float(row[name]) for name in ("qx", "qy", "qz", "qw")])
        mesh = read_points(next(base.glob("simulation/000/body_crate.ply")))
        corner = np.stack([mesh[axis] for axis in "xyz"], axis=1)
        sides = Rotation.from_euler("y", 20, degrees=True).inv().apply(corner).max(axis=0)
        local = Rotation.from_euler("y", 20, degrees=True).inv().apply(turn.inv().apply(away))
        beyond = (np.abs(local) - sides).max(axis=1)
        assert (beyond > -1e-5).all()
        near += int((beyond < 0.03).sum())
    assert near > 20


def test_the_foam_is_seen(project):
    before = np.asarray(Image.open(project.folder / FILM / "frames/00008.png").convert("RGB"), float)
    project.edit("  samples: 4", "  samples: 4\n  foam: {type: matte, color: '#ff0000'}", scene(project))
    project.make(FILM)
    after = np.asarray(Image.open(project.folder / FILM / "frames/00008.png").convert("RGB"), float)
    redder = (after[..., 0] - after[..., 1]) - (before[..., 0] - before[..., 1])
    assert (redder > 20).sum() > 20


@pytest.mark.parametrize(
    ("old", "new", "stages"),
    [
        ("foam: {}", "foam: {seed: 1}", {"foam", "render", "film"}),
        ("  samples: 4", "  samples: 4\n  foam: {type: matte, color: '#ffcc00'}", {"render", "film"}),
        ("particle_radius: 25 mm", "particle_radius: 26 mm", {"simulate", "reconstruct", "foam", "render", "film"}),
        ("foam: {}\n", "", {"render", "film"}),
    ],
)
def test_what_an_edit_repeats(project, old, new, stages):
    assert project.dry_run(FILM).nothing
    project.edit(old, new, scene(project))
    assert project.dry_run(FILM).stages == stages
