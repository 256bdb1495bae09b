"""A film made by a real SLURM of this one machine, whose node fails in the middle, is the film that this machine makes
alone."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SLURM = ROOT / "tests" / "cluster" / "slurm.sh"
SCENE = "tiny/splash"
PARTS = ("Snakefile", "pyproject.toml", "profiles", "common", "scene", "workflow", "sim", "render", "scenes/tiny")
ONE_THREAD = ["--set-threads", "simulate=1", "reconstruct=1", "render=1"]
ON_ONE_NODE = [
    *("--slurm-no-account", "--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks", "3"),
    *("--default-resources", "slurm_partition=main", "runtime=20", "--latency-wait", "10"),
]

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        os.geteuid() != 0
        or not all(map(shutil.which, ("slurmctld", "slurmd", "munged")))
        or importlib.util.find_spec("snakemake_executor_plugin_slurm") is None
        or Path("/etc/slurm/slurm.conf").exists(),
        reason="needs root, Debian's slurm-wlm and munge that are not set up, and `pip install -e .[slurm]`",
    ),
]


@pytest.fixture
def slurm(tmp_path):
    folder = tmp_path / "slurm"
    subprocess.run([SLURM, "start", folder], check=True, timeout=60)
    yield lambda action: subprocess.run([SLURM, action, folder], check=True, timeout=60)
    subprocess.run([SLURM, "stop", folder], check=False, timeout=60)


def project(folder: Path) -> Path:
    for part in PARTS:
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        copy = shutil.copytree if (ROOT / part).is_dir() else shutil.copy
        copy(ROOT / part, folder / part)
    return folder


def snakemake(folder: Path, *options: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "snakemake", f"renders/{SCENE}", *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def files(folder: Path, pattern: str) -> dict[str, bytes]:
    results = folder / "results" / SCENE
    return {str(path.relative_to(results)): path.read_bytes() for path in sorted(results.rglob(pattern))}


def test_a_film_whose_node_fails_is_the_film_of_one_machine(slurm, tmp_path):
    here, there = project(tmp_path / "here"), project(tmp_path / "there")
    local = snakemake(here, "--cores", "2", *ONE_THREAD)
    text, _ = local.communicate(timeout=600)
    assert local.returncode == 0, text

    farm = snakemake(there, "--workflow-profile", "profiles/slurm", *ON_ONE_NODE, *ONE_THREAD)
    frames = there / "results" / SCENE / "standard" / "frames"
    ends = time.monotonic() + 300
    while not list(frames.glob(".*.partial-*")):
        assert time.monotonic() < ends and farm.poll() is None, "no frame was begun"
        time.sleep(0.05)
    slurm("fail")
    time.sleep(2)
    slurm("repair")
    text, _ = farm.communicate(timeout=600)
    print(text)
    assert farm.returncode == 0, text
    assert "Error in group render" in text and "Trying to restart" in text, text

    for pattern, least in (("fluid_*.ply", 7), ("surface_*.ply", 7), ("state_*.npz", 1)):
        ours, theirs = files(here, pattern), files(there, pattern)
        assert len(ours) >= least and ours.keys() == theirs.keys(), pattern
        assert ours == theirs, pattern
    for folder in (here, there):
        assert len(list((folder / "renders" / SCENE / "frames").glob("*.png"))) == 7
    assert not list((there / "results").rglob(".*.partial-*"))
