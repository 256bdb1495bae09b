"""A tiny pool for the stress tests, the commands that simulate it, and what no run may leave behind."""

from __future__ import annotations

import copy
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.run import stepping
from sim.run.failure import Fault, find_fault
from tests import rounding
from tests.support.particles import read_frame

ROOT = Path(__file__).resolve().parents[2]
POOL: dict[str, Any] = {
    "fps": 100,
    "containers": {"tank": {"type": "box", "size": [0.4, 0.4, 0.4], "open": []}},
    "fluid": {
        "particle_radius": 0.02,
        "bodies": {"water": {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.15, 0]}},
    },
}
"""125 particles that fall 5 cm."""
THICK: dict[str, Any] = {
    "fluid__viscosity": 0.5,
    "fluid__viscosity_solver": "implicit",
    "fluid__xsph": 0.05,
    "fluid__surface_tension": 1.0,
    "fluid__surface_tension_model": "akinci2013",
    "fluid__adhesion": 0.5,
}
"""Settings of POOL with all that acts between particles beside pressure."""


def pool(**changes: Any) -> dict[str, Any]:
    """POOL with other settings, by path with two underscores for a dot."""
    scene = copy.deepcopy(POOL)
    for path, value in changes.items():
        *groups, last = path.split("__")
        target = scene
        for group in groups:
            target = target.setdefault(group, {})
        target[last] = value
    return scene


def make_faults(monkeypatch: pytest.MonkeyPatch, count: int, *, above: float) -> None:
    """Let the next `count` steps after which the kinetic energy [J] is `above` this seem wrong."""
    left = [Fault("a fault of the test", "nothing")] * count

    def find(world, measure, dt):
        if left and measure.kinetic_energy > above:
            return left.pop()
        return find_fault(world, measure, dt)

    monkeypatch.setattr(stepping, "find_fault", find)


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def segment_command(scene: dict[str, Any], out: Path, frames: str, *options: Any) -> list[str]:
    settings = ["--spec", json.dumps(scene), "--folder", str(out.parent), "--frames", frames, "--out", str(out)]
    return [sys.executable, "-m", rounding.segment(), *settings, "--arch", "cpu", "--threads", "1", *map(str, options)]


def run_segment(scene: dict[str, Any], out: Path, frames: str, *options: Any) -> subprocess.CompletedProcess[str]:
    """Run `python -m sim.segment` to its end."""
    return finish(segment_command(scene, out, frames, *options), out.parent)


def finish(command: list[str], folder: Path, **options: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, timeout=60, **options)


def contents(folder: Path, pattern: str) -> dict[str, bytes]:
    """The bytes of the files that match, by name; there must be some."""
    found = {path.name: path.read_bytes() for path in sorted(folder.glob(pattern))}
    assert found, f"no {pattern} in {folder}"
    return found


def failure(out: Path) -> dict[str, Any]:
    """What a run that stopped tells; the last good state that it names must be there."""
    report = json.loads((out / "failure.json").read_text())
    assert (out / report["last_good_state"]).exists()
    return report


def assert_nothing_broken(out: Path) -> None:
    """No value that is not finite in any frame or state, no half file."""
    for path in out.glob("fluid_*.ply"):
        points = read_frame(out, int(path.stem[-5:]))
        assert all(np.isfinite(points[name]).all() for name in points.dtype.names), path
    for path in out.glob("state_*.npz"):
        with np.load(path, allow_pickle=False) as state:
            assert all(np.isfinite(state[name]).all() for name in state.files if name != "meta"), path
    hidden = [path.name for path in out.glob(".*")]
    assert not hidden, hidden
