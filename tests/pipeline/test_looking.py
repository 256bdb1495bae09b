"""Pictures without Blender and how far a film is, from what its stages left."""

from __future__ import annotations

import shutil
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

NAME = "tests/pond"


def call(project, module, *options):
    command = [sys.executable, "-m", f"workflow.{module}", *options]
    return subprocess.run(command, cwd=project.folder, capture_output=True, text=True, timeout=120)


def picture(path) -> np.ndarray:
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


@pytest.mark.parametrize("options", [(), ("--particles",)])
def test_a_preview_shows_water_where_the_film_does(finished, tmp_path, options):
    drawn = {}
    for frame in (0, 8):
        out = tmp_path / f"{frame}.png"
        ran = call(finished, "preview", NAME, "--frame", str(frame), "--out", str(out), *options)
        assert ran.returncode == 0 and ran.stdout.strip() == str(out), ran.stderr
        assert "WARN" not in ran.stderr
        drawn[frame] = picture(out)
        assert drawn[frame].shape == (724, 960, 3)
    changed = np.abs(drawn[0] - drawn[8]).max(axis=2) > 60
    assert changed[200:].mean() > 0.02, "water moves"
    film = picture(finished.film / "frames" / "00008.png"), picture(finished.film / "frames" / "00000.png")
    rows, columns = np.nonzero(np.abs(film[0] - film[1]).max(axis=2) > 40)
    seen, wanted = np.argwhere(changed).mean(axis=0) / (724, 960), (rows.mean() / 49, columns.mean() / 65)
    assert np.abs(seen - wanted).max() < 0.12, "the camera is that of the film"


def test_what_is_not_there_is_refused(finished, fresh):
    for project, options, words in (
        (fresh, (), "simulate the scene first"),
        (finished, ("--frame", "99"), "there are 0 to 8"),
        (finished, ("--frame", "3", "--quality", "draft"), "simulate the scene first"),
    ):
        ran = call(project, "preview", NAME, *options)
        assert ran.returncode == 2 and words in ran.stderr, ran.stderr
    ran = call(finished, "status", "tests/pont")
    assert ran.returncode == 2 and "pond" in ran.stderr


def test_the_status_follows_what_is_there(project):
    text = call(project, "status", NAME).stdout
    assert "the film is in renders/tests/pond" in text and text.count("9/9") == 3, text
    results = project.folder / "results" / NAME / "standard"
    shutil.rmtree(project.film)
    last = sorted((results / "frames").glob("[0-9]*"))[-1]
    partial = last.with_name(f".{last.name}.partial-1")
    last.rename(partial)
    for extra in sorted(partial.glob("*.png"))[1:]:
        extra.unlink()
    text = call(project, "status", NAME).stdout
    assert "film is in" not in text and "about" in text and "last picture" in text, text
    assert text.count("9/9") == 2, text


def test_what_a_changed_scene_makes_anew_is_told(project):
    project.scene.write_text(project.scene.read_text().replace("samples: 1", "samples: 2"))
    text = call(project, "status", NAME).stdout
    assert "0/9 (9 anew)" in text and "nothing is being made" in text, text
