"""SIGKILL at five moments: the same command finishes the film and repeats one job at most, to the same bytes."""

from __future__ import annotations

import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.pipeline.conftest import TARGET, Project, source_tree

pytestmark = pytest.mark.slow

SEGMENTS = 3
PARTS = [*((stage, k) for stage in ("simulation", "surface", "frames") for k in range(SEGMENTS)), ("film", 0)]
PATIENCE = 120.0
"""Seconds until the moment of the kill; each takes less than ten."""


def lengthened(project: Project) -> Project:
    project.edit("duration: 2", "duration: 3")
    return project


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory) -> Project:
    """A film of three segments and three blocks, made at once."""
    project = lengthened(source_tree(tmp_path_factory.mktemp("kills") / "project"))
    project.make()
    return project


def result(project: Project, stage: str, index: int) -> Path:
    return project.film if stage == "film" else project.results / stage / f"{index:03d}"


def inodes(project: Project) -> dict[tuple[str, int], int]:
    """Of every result that is there."""
    folders = {part: result(project, *part) for part in PARTS}
    return {part: folder.stat().st_ino for part, folder in folders.items() if folder.is_dir()}


def particles(project: Project) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(project.results.glob("simulation/*/fluid_*.ply"))}


def kill(project: Project, pattern: str) -> None:
    """Start the film and kill snakemake, and it alone, once something matches the pattern."""
    process = subprocess.Popen(
        project.command("--cores", "1", TARGET),
        cwd=project.folder,
        env=project.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    end = time.monotonic() + PATIENCE
    try:
        while not any(project.folder.glob(pattern)):
            assert process.poll() is None, f"ended before there was {pattern}"
            assert time.monotonic() < end, f"{pattern} never came"
            time.sleep(0.005)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()


def assert_finished(project: Project, uninterrupted: Project, before: set[tuple[str, int]]) -> None:
    """The same command after --unlock makes the rest, and at most one of the results in `before` again."""
    locks = project.folder / ".snakemake" / "locks"
    assert any(locks.iterdir())
    assert project.snakemake("--unlock", TARGET).code == 0
    there = inodes(project)
    ran = project.make()
    now = inodes(project)
    assert set(now) == set(PARTS)
    again = {part for part in before if now[part] != there.get(part)}
    assert len(again) <= 1, f"repeated {again}\n{ran.text}"
    assert len(ran.jobs) == len(PARTS) - len(before - again), ran.text
    assert particles(project) == particles(uninterrupted)
    assert project.dry_run().nothing
    assert not list(project.folder.rglob(".*.partial-*"))


SIMULATION = "results/tests/pond/standard/simulation"


@pytest.mark.parametrize(
    ("pattern", "done"),
    [
        (f"{SIMULATION}/.001.partial-*/fluid_*.ply", {("simulation", 0)}),
        (f"{SIMULATION}/001", {("simulation", 0), ("simulation", 1)}),
    ],
    ids=["simulation", "between jobs"],
)
def test_killed_before_all_is_simulated(fresh, uninterrupted, pattern, done):
    project = lengthened(fresh)
    kill(project, pattern)
    before = set(inodes(project))
    assert done <= before < set(PARTS)
    assert_finished(project, uninterrupted, before)


@pytest.mark.parametrize(
    ("old", "new", "pattern", "stages"),
    [
        ("cube_size: 1.0", "cube_size: 1.1", "results/**/surface/.001.partial-*", {"surface", "frames", "film"}),
        ("samples: 1", "samples: 2", "results/**/frames/.001.partial-*/*.png", {"frames", "film"}),
        ("fps: 4", "fps: 4\nfilm: {crf: 30}", "renders/tests/.pond.partial-*/*.mp4", {"film"}),
    ],
    ids=["reconstruction", "rendering", "encoding"],
)
def test_killed_later(uninterrupted, tmp_path, old, new, pattern, stages):
    """After an edit, with all earlier stages done."""
    project = Project(Path(shutil.copytree(uninterrupted.folder, tmp_path / "project", symlinks=True)))
    project.edit(old, new)
    edited = inodes(project)
    kill(project, pattern)
    killed = inodes(project)
    made = {part for part, inode in killed.items() if part[0] not in stages or inode != edited[part]}
    assert {part for part in PARTS if part[0] not in stages} <= made < set(PARTS)
    assert_finished(project, uninterrupted, made)
