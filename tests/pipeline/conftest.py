"""A small film, made once a session with the real stages; every test edits a copy of its project."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TARGET = "renders/tests/pond"
SCENE = """\
description: A block of water falls beside a stone.
duration: 2
fps: 4
gravity: [0, -9.81, 0]
containers:
  tank: {type: box, size: [0.8, 1, 0.5]}
fluid:
  particle_radius: 0.05
  bodies:
    block: {shape: {type: box, size: [0.3, 0.4, 0.5]}, position: [-0.25, 0.2, 0]}
rigid:
  bodies:
    stone: {motion: static, shape: {type: mesh, file: stone.obj}, position: [0.2, 0.2, 0]}
surface:
  cube_size: 1.0
render:
  resolution: [65, 49]
  samples: 1
"""
STONE = """\
v 0.1 0.1 0.1
v 0.1 -0.1 -0.1
v -0.1 0.1 -0.1
v -0.1 -0.1 0.1
f 1 2 3
f 1 3 4
f 1 4 2
f 2 4 3
"""
STAGES = {
    **{"Simulate": "simulate", "Reconstruct": "reconstruct", "Render": "render", "Film": "film", "Foam": "foam"},
    **{"Wetness": "wet", "Trial": "trial", "Study": "study", "Wedge": "wedge"},
}


@dataclass
class Ran:
    """What snakemake did, or would do: exit code, all that it printed, the jobs with frames and reason."""

    code: int
    text: str
    jobs: list[tuple[str, str, str]] = field(default_factory=list)

    @property
    def stages(self) -> set[str]:
        return {stage for stage, _, _ in self.jobs}

    @property
    def nothing(self) -> bool:
        """Whether all was up to date."""
        return not self.jobs and "Nothing to be done" in self.text

    def frames(self, stage: str) -> list[str]:
        return sorted(frames for name, frames, _ in self.jobs if name == stage)

    def reasons(self, stage: str) -> set[str]:
        return {reason for name, _, reason in self.jobs if name == stage}


class Project:
    """A copy of the source tree with one scene of the tests."""

    def __init__(self, folder: Path):
        self.folder = folder

    @property
    def scene(self) -> Path:
        return self.folder / "scenes" / "tests" / "pond.yaml"

    @property
    def film(self) -> Path:
        return self.folder / TARGET

    @property
    def results(self) -> Path:
        return self.folder / "results" / "tests" / "pond" / "standard"

    def edit(self, old: str, new: str, file: Path | None = None) -> None:
        """Replace text in a file, by default the scene; the text must be there."""
        path = file or self.scene
        text = path.read_text()
        assert old in text, f"{old!r} is not in {path}"
        path.write_text(text.replace(old, new, 1))

    def append(self, file: str, text: str) -> None:
        path = self.folder / file
        path.write_text(path.read_text() + text)

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "snakemake", *arguments]

    def environment(self, **variables: str) -> dict[str, str]:
        return {**os.environ, "NO_COLOR": "1", **variables}

    def snakemake(self, *arguments: str, **variables: str) -> Ran:
        done = subprocess.run(
            self.command(*arguments),
            cwd=self.folder,
            env=self.environment(**variables),
            capture_output=True,
            text=True,
            timeout=300,
        )
        text = done.stdout + done.stderr
        found = re.findall(rf"Job \d+: ({'|'.join(STAGES)})([^\n]*)\nReason: ([^\n]*)", text)
        jobs = [(STAGES[verb], rest.partition("frames ")[2].strip(), reason) for verb, rest, reason in found]
        return Ran(done.returncode, text, jobs)

    def dry_run(self, *arguments: str, **variables: str) -> Ran:
        ran = self.snakemake("--dry-run", *(arguments or (TARGET,)), **variables)
        assert ran.code == 0, ran.text
        return ran

    def make(self, *arguments: str) -> Ran:
        ran = self.snakemake("--cores", "2", *(arguments or (TARGET,)))
        assert ran.code == 0, ran.text
        return ran


def source_tree(folder: Path) -> Project:
    """The source files in `folder`, with the scene of the tests, and nothing made yet."""
    ignored = shutil.ignore_patterns("__pycache__")
    for name in ("common", "scene", "sim", "render", "workflow", "profiles"):
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)
    shutil.copy2(ROOT / "Snakefile", folder)
    project = Project(folder)
    project.scene.parent.mkdir(parents=True)
    project.scene.write_text(SCENE)
    project.scene.with_name("stone.obj").write_text(STONE)
    return project


@pytest.fixture
def fresh(tmp_path: Path) -> Project:
    """A project in which nothing was made."""
    return source_tree(tmp_path / "project")


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """The project after its film was made; not to be changed."""
    project = source_tree(tmp_path_factory.mktemp("pipeline") / "project")
    project.make()
    return project


@pytest.fixture
def project(finished: Project, tmp_path: Path) -> Project:
    """A copy of the finished project, with the times of its files."""
    return Project(Path(shutil.copytree(finished.folder, tmp_path / "project", symlinks=True)))
