"""No room on the disk, or no right to write: a message, the right exit code, and no half file."""

from __future__ import annotations

import json
import resource
import shutil
import subprocess

import pytest

from tests.stress.scenes import assert_nothing_broken, contents, finish, pool, run_segment, segment_command
from tests.support.particles import read_table

STILL = pool(gravity=[0, 0, 0])
"""A frame of 125 particles takes 4 kB, a state 7 kB; 80 kB are kept in reserve for the end."""


@pytest.fixture
def small_disk(tmp_path):
    """A function that gives a disk of some kB."""
    mounted = []

    def mount(size: str):
        folder = tmp_path / f"disk_{size}"
        folder.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
        if not shutil.which("mount") or subprocess.run(command, capture_output=True).returncode:
            pytest.skip("no right to mount a disk")
        mounted.append(folder)
        return folder

    yield mount
    for folder in mounted:
        subprocess.run(["umount", "-l", str(folder)], check=True)


@pytest.mark.outcome("C")
def test_a_disk_that_fills_up_stops_the_run(small_disk, tmp_path):
    disk = small_disk("160k")
    out = disk / "out"
    done = run_segment(STILL, out, "0:100")
    assert done.returncode == 3, done.stderr
    assert "No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert_nothing_broken(out)
    report = json.loads((out / "failure.json").read_text())
    last = report["last_good_frame"]
    assert last >= 1
    assert f"--resume {out / report['last_good_state']}" in report["change"]
    assert sorted(contents(out, "fluid_*.ply")) == [f"fluid_{k:05d}.ply" for k in range(last + 1)]
    assert read_table(out / "steps.csv")["time"].max() == pytest.approx(last / 100)
    state = shutil.copy(out / report["last_good_state"], tmp_path)
    done = run_segment(STILL, tmp_path / "more", f"{last + 1}:{last + 1}", "--resume", state)
    assert done.returncode == 0, done.stderr


@pytest.mark.outcome("B")
def test_a_full_disk_is_refused(small_disk):
    out = small_disk("64k") / "out"
    done = run_segment(STILL, out, "0:4")
    assert done.returncode == 2, done.stderr
    assert f"{out}" in done.stderr
    assert "make room" in done.stderr
    assert not list(out.iterdir())


@pytest.mark.outcome("C")
def test_a_limit_on_the_size_of_files_stops_the_run(tmp_path):
    """The tables grow past it; frames and states are smaller than the reserve."""
    command = segment_command(
        pool(probes={f"p{k}": {"type": "front", "axis": "x", "rate": 1e5} for k in range(9)}), tmp_path / "out", "0:400"
    )
    limit = 100 * 1024
    done = finish(command, tmp_path, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    assert done.returncode == 3, done.stderr
    assert "File too large" in done.stderr
    assert_nothing_broken(tmp_path / "out")
    last = json.loads((tmp_path / "out" / "failure.json").read_text())["last_good_frame"]
    rows = (tmp_path / "out" / "probes.csv").read_bytes()
    assert rows.endswith(b"\n")
    assert read_table(tmp_path / "out" / "probes.csv")["time"].max() == pytest.approx(last / 100)
    assert len(contents(tmp_path / "out", "fluid_*.ply")) == last + 1


@pytest.mark.outcome("B")
def test_a_folder_that_can_not_be_written_is_refused(small_disk, tmp_path):
    disk = small_disk("1m")
    subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
    (tmp_path / "file").touch()
    for out, reason in ((disk / "out", "Read-only file system"), (tmp_path / "file", "File exists")):
        done = run_segment(STILL, out, "0:4")
        assert done.returncode == 2, done.stderr
        assert reason in done.stderr
        assert "Traceback" not in done.stderr
