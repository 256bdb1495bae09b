"""A run that is asked to end does so after the step, with whole files and a state to go on from."""

from __future__ import annotations

import json
import signal
import subprocess
import time

import pytest

from tests.stress.scenes import (
    assert_nothing_broken,
    contents,
    environment,
    pool,
    run_segment,
    segment_command,
)

LONG = pool(step={"maximum": 1e-5})
"""1,000 steps a frame."""
PROMPT = 3.0
"""Seconds from the signal to the end of the process."""


def interrupted(out, number, *, when, **variables):
    """Start the long run, send the signal once `when` holds; returns exit code, messages and the time it took."""
    process = subprocess.Popen(
        segment_command(LONG, out, "0:1000"),
        cwd=out.parent,
        env={**environment(), **variables},
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        end = time.monotonic() + 30
        while not when() and time.monotonic() < end:
            time.sleep(0.02)
        process.send_signal(number)
        began = time.monotonic()
        messages = process.communicate(timeout=30)[1]
        return process.returncode, messages, time.monotonic() - began
    finally:
        process.kill()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_can_go_on(tmp_path, number):
    out = tmp_path / "out"
    code, messages, seconds = interrupted(out, number, when=(out / "fluid_00001.ply").exists)
    assert code == 130, messages
    assert seconds < PROMPT
    assert "Traceback" not in messages
    assert_nothing_broken(out)
    summary = json.loads((out / "summary.json").read_text())
    assert summary["status"] == "interrupted"
    frame = round(summary["simulated_s"] * 100)
    assert frame >= 1
    assert f"state kept: {out / f'state_{frame:05d}.npz'}" in messages
    assert len(contents(out, "fluid_*.ply")) == frame + 1
    short = pool()
    done = run_segment(short, tmp_path / "more", f"{frame + 1}:{frame + 1}", "--resume", out / f"state_{frame:05d}.npz")
    assert done.returncode == 0, done.stderr


def test_an_interrupt_before_the_first_frame(tmp_path):
    """While the world is built there is nothing to keep."""
    out = tmp_path / "out"
    code, messages, seconds = interrupted(out, signal.SIGTERM, when=out.exists)
    assert code in (130, -signal.SIGTERM), messages
    assert seconds < PROMPT
    assert "Traceback" not in messages
    assert_nothing_broken(out)
    assert not list(out.glob("state_*")) or (out / "fluid_00000.ply").exists()


def test_an_interrupt_while_kernels_are_compiled(tmp_path):
    """In the first step, with none kept: it takes seconds, and Python hears nothing meanwhile."""
    out, cache = tmp_path / "out", tmp_path / "kernels"
    started = (out / "fluid_00000.ply").exists
    code, messages, seconds = interrupted(out, signal.SIGTERM, when=started, TI_OFFLINE_CACHE_FILE_PATH=str(cache))
    assert code in (130, -signal.SIGTERM), messages
    assert seconds < PROMPT
    assert "Traceback" not in messages
    assert_nothing_broken(out)
    assert not (out / "fluid_00001.ply").exists()
    assert not [path for path in out.iterdir() if path.name.startswith(".")]
