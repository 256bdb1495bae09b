"""What a film is predicted to take, with its jobs laid side by side."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from scene.load import Scene
from workflow.budget.calibrate import Calibration
from workflow.budget.detail import Presets
from workflow.budget.model import Model
from workflow.budget.schedule import SIDE_BY_SIDE, wall
from workflow.plan.timeline import Timeline

FILM = 5.0
"""For Snakemake to begin, and for the film to be put together [s]."""


@dataclass(frozen=True)
class Forecast:
    """What a film is predicted to take: wall time, seconds of work by stage, bytes."""

    wall_s: float
    simulate_s: float
    reconstruct_s: float
    render_s: float
    bytes: float

    def __str__(self) -> str:
        parts = {"simulation": self.simulate_s, "surfaces": self.reconstruct_s, "pictures": self.render_s}
        work = ", ".join(f"{seconds:.0f} s of {part}" for part, seconds in parts.items() if seconds)
        return f"predicted {self.wall_s:.0f} s ({work}, side by side) and {self.bytes / 1e6:.0f} MB"


@contextmanager
def calibrated(presets: Presets, cores: int, tell: Callable[[str], None]) -> Iterator[tuple[Calibration, Model]]:
    """A model of the films of a scene on so many cores, and what it can be corrected by; raises PilotFailed."""
    with tempfile.TemporaryDirectory(prefix="tidemill-") as folder:
        calibration = Calibration(presets, cores, Path(folder), tell)
        yield calibration, calibration.model()


def forecast(model: Model, scene: Scene, cores: int) -> Forecast:
    """Of a scene's film on so many cores."""
    found = model.predict(scene)
    timeline = Timeline(scene.simulation.fps, scene.last_frame)
    own, surface, picture = found.overheads
    steps = [0.0, *found.simulate]
    segments = [own + sum(steps[frame] for frame in timeline.segment(k)) for k in range(timeline.segments)]
    surfaces = [surface + len(timeline.segment(k)) * found.surface for k in range(timeline.segments)]
    if scene.simulation.fluid is None:
        surfaces = []
    blocks = [picture + len(timeline.block(k)) * found.picture for k in range(timeline.blocks)]
    time = wall(timeline, segments, surfaces, blocks, FILM, slots=min(SIDE_BY_SIDE, cores))
    return Forecast(time, sum(segments), sum(surfaces), sum(blocks), found.size)


def predicted(presets: Presets, scene: Scene, cores: int, tell: Callable[[str], None]) -> Forecast:
    """What the film of one of a scene's presets takes on so many cores, after pilots of it; raises PilotFailed."""
    with calibrated(presets, cores, tell) as (calibration, model):
        calibration.probe(model, scene)
        return forecast(model, scene, cores)


def teller(name: str) -> Callable[[str], None]:
    """Tells what goes on with a film's forecast, on the error stream."""
    return lambda text: print(f"forecast of {name}: {text}", file=sys.stderr, flush=True)
