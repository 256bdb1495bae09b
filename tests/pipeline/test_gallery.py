"""A finished film into the gallery."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from PIL import Image, ImageSequence

SHOTS = """\
intro: Films.
shots:
  - {scene: tests/pond, title: Pond, says: It splashes., seen: A pond, frame: 2}
"""


def collect(project, *names: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "workflow.gallery", *names]
    return subprocess.run(command, cwd=project.folder, capture_output=True, text=True, timeout=500)


@pytest.fixture
def gallery(project):
    folder = project.folder / "docs" / "gallery"
    folder.mkdir(parents=True)
    (folder / "shots.yaml").write_text(SHOTS)
    return folder


@pytest.mark.slow
def test_a_film_is_collected(project, gallery):
    done = collect(project, "tests/pond")
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in gallery.iterdir()) == [
        *("pond.jpg", "pond.json", "pond.mp4", "pond.webp", "shots.yaml"),
    ]
    assert Image.open(gallery / "pond.jpg").size == (960, 540)
    assert len(ImageSequence.all_frames(Image.open(gallery / "pond.webp"))) == 9
    record = json.loads((gallery / "pond.json").read_text())
    assert record["particles"] > 0
    assert record["wall_s"]["simulate"] > 0
    page = (project.folder / "docs" / "gallery.md").read_text()
    assert "`snakemake --cores 2 renders/tests/pond`" in page


def test_what_is_not_made_is_refused(project, gallery):
    refused = collect(project, "tests/lake")
    assert refused.returncode == 2
    assert "shots.yaml does not show tests/lake" in refused.stderr
    project.edit("  samples: 1\n", "  samples: 2\n")
    outdated = collect(project, "tests/pond")
    assert outdated.returncode == 2
    assert "not as the scene now says: run snakemake --cores 2 renders/tests/pond" in outdated.stderr
    (gallery / "shots.yaml").write_text(SHOTS.replace("frame: 2", "frame: 2, quality: draft, set: [fps=12]"))
    assert """--config quality=draft set='["fps=12"]'""" in collect(project, "tests/pond").stderr
