"""Pilots: a film's stages on a coarse copy of its scene, as its jobs would run them, and what they took."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from common.distribution import HOME
from scene.load import Scene
from workflow.plan.jobs import ENTRY, Plan
from workflow.stages.film.summaries import read
from workflow.stages.film.tables import numbers


class PilotFailed(RuntimeError):
    """A stage of a pilot ended otherwise than well; holds what it said."""


@dataclass(frozen=True)
class Simulated:
    """What the frames after the first took; arrays have shape [frames]."""

    steps: np.ndarray
    particles: np.ndarray
    """Mean over the steps of a frame."""
    iterations: np.ndarray
    """Of pressure, mean over the steps of a frame."""
    stepping: np.ndarray
    """[s]"""
    overhead: float
    """Of the process, with its kernels loaded [s]."""
    output: float
    """Of a frame [s]."""
    size: float
    """Of a frame's points [bytes]."""
    fixed: float
    """Of a job's other files [bytes]."""


@dataclass(frozen=True)
class Drawn:
    """What the surface or the picture of a frame took."""

    seconds: float
    overhead: float
    """Of the process [s]."""
    size: float
    """Of the file [bytes]."""


class Pilot:
    """A scene at a coarse detail, simulated; its files are in `folder`."""

    def __init__(self, scene: Scene, folder: Path, threads: int):
        self.scene = scene
        self._plan = Plan(scene, HOME)
        self._folder = folder
        self._threads = threads

    def simulate(self, last: int | None = None) -> Simulated:
        """The frames to `last`, or all; raises PilotFailed."""
        job = self._plan.whole_simulation()
        last = self.scene.last_frame if last is None else last
        words = ["--folder", str(self.scene.folder), "--frames", f"0:{last}"]
        out = self._folder / "simulation"
        total = self._run("simulate", job.spec, words, out)
        found = {name: np.array(column) for name, column in numbers(out / "steps.csv", _COLUMNS).items()}
        frame = np.ceil(found["time"] * self.scene.simulation.fps - 1e-6).astype(int) - 1
        steps = np.bincount(frame, minlength=last)

        def mean(name: str) -> np.ndarray:
            return np.bincount(frame, found.get(name, np.zeros(len(frame))), last) / np.maximum(steps, 1)

        stepping = np.bincount(frame, _without_loading(found["wall_s"]), last)
        output = read(out)["wall_s"].get("output", 0.0)
        overhead = total - stepping.sum() - output
        sizes = {path.name: path.stat().st_size for path in out.iterdir()}
        points = sum(size for name, size in sizes.items() if name.startswith(_POINTS))
        return Simulated(
            steps=steps,
            particles=mean("n_fluid"),
            iterations=mean("pressure_iterations"),
            stepping=stepping,
            overhead=overhead,
            output=output / (last + 1),
            size=points / (last + 1),
            fixed=sum(sizes.values()) - points,
        )

    def surface(self, frame: int, settings: Scene) -> Drawn:
        """The surface of a frame with the settings of a scene, made with that of the next; raises PilotFailed."""
        spec = json.loads(self._plan.job("reconstruct").spec)
        spec["surface"] = settings.surface.model_dump(mode="json")
        out = self._surfaces(settings, frame)
        words = ["--simulation", str(self._folder / "simulation")]
        total = self._run("reconstruct", json.dumps(spec), [*words, "--frames", f"{frame}:{frame + 1}"], out)
        wall = read(out)["wall_s"]
        both = sum(wall.get(phase, 0.0) for phase in ("load", "splashsurf", "write"))
        return Drawn(both / 2, total - both, (out / f"surface_{frame:05d}.ply").stat().st_size)

    def _surfaces(self, settings: Scene, frame: int) -> Path:
        return self._folder / f"surface_{settings.surface.cube_size:g}_{frame}"

    def picture(self, frame: int, settings: Scene, changes: Mapping[str, Any]) -> Drawn:
        """The picture of a frame with the settings of a scene, some of them changed; raises PilotFailed.

        It is the second of its process: Blender takes longer for the first.
        """
        surface = self._surfaces(settings, frame)
        if self._plan.has_surface and not surface.exists():
            self.surface(frame, settings)
        spec = {**json.loads(Plan(settings, HOME).job("render").spec), **changes}
        out = Path(tempfile.mkdtemp(dir=self._folder, prefix=f"picture_{frame}_"))
        words = ["--simulation", str(self._folder / "simulation")]
        words += ["--surface", str(surface)] if self._plan.has_surface else []
        words += ["--frames", f"{frame}:{frame + 1}", "--fps", f"{self.scene.simulation.fps:.17g}"]
        total = self._run("render", json.dumps(spec), words, out)
        seconds = read(out)["wall_s_per_frame"][1]
        return Drawn(seconds, total - 2 * seconds, (out / f"{frame:05d}.png").stat().st_size)

    def _run(self, stage: str, spec: str, words: Sequence[str], out: Path) -> float:
        """Wall time of a stage's command [s]."""
        command = [sys.executable, "-m", ENTRY[stage], "--spec", "-", *words]
        command += ["--out", str(out), "--threads", str(self._threads)]
        start = time.perf_counter()
        done = subprocess.run(command, input=spec, capture_output=True, text=True, check=False)
        if done.returncode:
            raise PilotFailed(done.stderr.strip()[-2000:])
        return time.perf_counter() - start


_POINTS = ("fluid_", "cloth_", "state_")
_COLUMNS = ("time", "wall_s", "n_fluid", "pressure_iterations")


def _without_loading(seconds: np.ndarray) -> np.ndarray:
    """Steps that load a kernel take seconds; each counts as those around it."""
    usual = np.array([np.median(seconds[max(0, k - 10) : k + 11]) for k in range(len(seconds))])
    return np.where(seconds > 10 * usual + 0.05, usual, seconds)
