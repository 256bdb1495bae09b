"""The finest detail that is predicted to fit a budget of time, chosen once and kept beside the results."""

from __future__ import annotations

import hashlib
import json
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from sim.settings import Refused
from workflow.budget.calibrate import Calibration
from workflow.budget.detail import FINEST, load_at
from workflow.budget.model import Model
from workflow.budget.pilot import ROOT
from workflow.budget.schedule import SIDE_BY_SIDE, wall
from workflow.plan import RESULTS, Plan
from workflow.scene import QUALITIES, Scene, load
from workflow.stage import write_json
from workflow.timeline import Timeline

STEP = 0.05
"""Between details that are looked at."""
FILM = 5.0
"""For Snakemake to begin, and for the film to be put together [s]."""
MARGIN = 1.2
"""A budget is so many times what is predicted: films took up to 1.25 times as long."""
AGAIN = 0.1
"""Farther than so much detail from where a model was corrected it is corrected anew."""


@dataclass(frozen=True)
class Forecast:
    """What a film is predicted to take: wall time, seconds of work by stage, bytes."""

    wall_s: float
    simulate_s: float
    reconstruct_s: float
    render_s: float
    bytes: float


@dataclass(frozen=True)
class Choice:
    """A detail, and what it is predicted to take. `key` tells whether it still holds."""

    key: str
    detail: float
    forecast: Forecast


def chosen(path: Path, name: str, budget: float, cores: int) -> Choice:
    """The choice for the scene at `path` with a budget [s]; made, and said on the error stream, if there is none yet.

    Raises Refused where even a draft takes longer, SceneError, and PilotFailed.
    """
    place = Path(RESULTS, name, "budget.json")
    key = _key(path, budget, cores)
    kept = _kept(place, key)
    if kept is not None:
        return kept
    start = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="tidemill-") as folder:
        tell = _teller(name)
        calibration = Calibration(path, cores, Path(folder), tell)
        model = calibration.model()
        detail, probed = _finest(path, model, budget, cores), None
        while probed is None or abs(detail - probed) > AGAIN:
            calibration.probe(model, load_at(path, detail))
            detail, probed = _finest(path, model, budget, cores), detail
    scene = load_at(path, detail)
    choice = Choice(key, detail, forecast(model, scene, cores))
    place.parent.mkdir(parents=True, exist_ok=True)
    write_json(place, asdict(choice))
    tell(f"{told(choice)}; found in {time.perf_counter() - start:.0f} s")
    return choice


def told(choice: Choice) -> str:
    """A choice in words."""
    found, below = choice.forecast, int(min(choice.detail, FINEST - STEP))
    where = f"detail {choice.detail:.2f}, from {QUALITIES[below]} ({below}) to {QUALITIES[below + 1]} ({below + 1})"
    parts = {"simulation": found.simulate_s, "surfaces": found.reconstruct_s, "pictures": found.render_s}
    work = ", ".join(f"{seconds:.0f} s of {part}" for part, seconds in parts.items() if seconds)
    return f"{where}: predicted {found.wall_s:.0f} s ({work}, side by side) and {found.bytes / 1e6:.0f} MB"


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


def _finest(path: Path, model: Model, budget: float, cores: int) -> float:
    """The finest detail that fits; raises Refused."""
    steps = round(FINEST / STEP)
    low, high = 0, steps + 1
    needed = MARGIN * forecast(model, load_at(path, 0.0), cores).wall_s
    if needed > budget:
        raise Refused(
            f"--config budget={budget:g}s: even at draft quality {path} takes about {needed:.0f} s",
            remedy=f"give it {needed:.0f} s or more, or a shorter duration",
        )
    while high - low > 1:
        middle = (low + high) // 2
        fits = MARGIN * forecast(model, load_at(path, middle * STEP), cores).wall_s <= budget
        low, high = (middle, high) if fits else (low, middle)
    return low * STEP


def _key(path: Path, budget: float, cores: int) -> str:
    plans = [Plan(load(path, quality=quality), ROOT).job("film").plan for quality in QUALITIES]
    return hashlib.sha256(json.dumps([budget, cores, *plans]).encode()).hexdigest()[:32]


def _kept(place: Path, key: str) -> Choice | None:
    try:
        data = json.loads(place.read_text(encoding="utf-8"))
        choice = Choice(data["key"], data["detail"], Forecast(**data["forecast"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return choice if choice.key == key else None


def _teller(name: str) -> Callable[[str], None]:
    return lambda text: print(f"budget of {name}: {text}", file=sys.stderr, flush=True)
