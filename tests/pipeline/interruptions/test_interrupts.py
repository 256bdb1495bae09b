"""Killed at the worst moment, the same command finishes the film and repeats at most what was running."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

TARGET = "renders/tests/pond"


def processes_in(folder: Path) -> list[str]:
    """Command lines of the processes that work in a folder."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and Path(os.readlink(entry / "cwd")) == folder.resolve():
                found.append((entry / "cmdline").read_bytes().replace(b"\0", b" ").decode())
        except OSError:
            continue
    return found


def wait_for(condition, seconds: float) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


def killed_while_rendering(project) -> None:
    project.edit("samples: 1", "samples: 2")
    running = subprocess.Popen(
        project.command("--cores", "1", TARGET),
        cwd=project.folder,
        env=project.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    frames = project.results / "frames"
    assert wait_for(lambda: list(frames.glob(".*.partial-*/*.png")), 60)
    running.send_signal(signal.SIGKILL)
    running.wait()


def test_sigkill_leaves_no_process_and_no_half_result(project):
    killed_while_rendering(project)
    assert wait_for(lambda: not processes_in(project.folder), 15), processes_in(project.folder)
    assert not (project.results / "frames" / "000").exists() or not (project.results / "frames" / "001").exists()
    assert "--unlock" in project.snakemake("--cores", "1", TARGET).text
    assert project.snakemake("--unlock", TARGET).code == 0
    ran = project.make()
    assert ran.stages == {"render", "film"}
    assert project.dry_run().nothing
    assert not list(project.results.rglob(".*.partial-*"))
    assert not list(project.results.rglob(".*.lock"))


def test_a_refused_stage_leaves_nothing_that_counts(fresh):
    fresh.edit("gravity: [0, -9.81, 0]", "gravity: [0, -9.81, 0]\nstep: {fixed: 1.0}")
    ran = fresh.snakemake("--cores", "1", TARGET)
    assert ran.code != 0
    assert "step.fixed" in ran.text
    assert "tidemill: the command refused its settings" in ran.text
    assert not (fresh.results / "simulation" / "000").exists()
    assert "step.fixed" in (fresh.results / "logs" / "simulation" / "000.log").read_text()
