"""The wheel, installed where nobody may write, and a folder of one's own whose name has spaces and accents."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Installed:
    """What a wheel installs, and the folder that films are made in."""

    packages: Path
    folder: Path

    def run(self, *words: str, code: int = 0) -> str:
        """What a command prints, in the folder; `words`: a module and its arguments."""
        environment = {**os.environ, "PYTHONPATH": str(self.packages), "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run(
            [sys.executable, "-m", *words], cwd=self.folder, env=environment, capture_output=True, text=True
        )
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout + done.stderr


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"]
    subprocess.run([*pip, str(folder), str(ROOT)], check=True, capture_output=True)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    place = tmp_path_factory.mktemp("été à la mer")
    packages, folder = place / "installed here", place / "mes films"
    folder.mkdir()
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-compile", "--target"]
    subprocess.run([*pip, str(packages), str(wheel)], check=True, capture_output=True)
    paths = [packages, *packages.rglob("*")]
    for path in paths:
        path.chmod(path.stat().st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))
    here = Installed(packages, folder)
    here.run("tidemill", "new", "mon film")
    yield Installed(packages, folder / "mon film")
    for path in paths:
        path.chmod(path.stat().st_mode | stat.S_IWUSR)


def test_the_wheel_takes_no_name_but_its_own(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert {name.partition("/")[0].partition("-")[0] for name in names} == {"tidemill"}
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True).stdout.split()
    folders = ("common/", "live/", "profiles/", "render/", "scene/", "scenes/", "sim/", "workflow/")
    needed = [name for name in tracked if name.startswith(folders)]
    assert {f"tidemill/distribution/{name}" for name in needed} <= set(names)
    assert not [name for name in names if "__pycache__" in name or "/tests/" in name]


def test_a_scene_of_ones_own_by_either_command(installed):
    assert "37 frames" in installed.run("tidemill", "check", "mon_film")
    assert "renders/mon_film" in installed.run("snakemake", "-c", "1")
    for words in (("tidemill", "render", "mon_film", "-n"), ("snakemake", "-n", "renders/mon_film")):
        said = installed.run(*words)
        assert "Film renders/mon_film" in said and str(installed.packages) not in said.partition("Job stats")[2]


def test_a_scene_that_comes_with_it(installed):
    assert "Film renders/bowl" in installed.run("tidemill", "render", "bowl", "-n")
    assert "did you mean renders/bowl" in installed.run("tidemill", "render", "bowel", "-n", code=1)


@pytest.mark.slow
def test_a_film_from_an_installation_that_cannot_be_written_to(installed):
    before = sorted(installed.packages.rglob("*"))
    scene = installed.folder / "scenes" / "mon_film.yaml"
    small = scene.read_text().replace("duration: 1.5\nfps: 24\n", "duration: 0.5\nfps: 8\n").replace("12 mm", "50 mm")
    scene.write_text(small.replace("render:\n", "render:\n  resolution: [64, 36]\n  samples: 1\n"))
    installed.run("tidemill", "render", "mon_film", "-c", "2")
    made = installed.folder / "renders" / "mon_film"
    assert {"mon_film.mp4", "contact.png", "plots.png", "summary.json"} <= {path.name for path in made.iterdir()}
    assert "the film is in renders/mon_film" in installed.run("tidemill", "status", "mon_film")
    assert "Nothing to be done" in installed.run("snakemake", "--cores", "2", "renders/mon_film")
    installed.run("tidemill", "export", "mon_film", "--out", "mon_film.usdc")
    installed.run("tidemill", "preview", "mon_film", "--out", "picture.png")
    assert sorted(installed.packages.rglob("*")) == before, "root may write there, and did"
