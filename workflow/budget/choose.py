"""The finest detail that is predicted to fit a budget of time, chosen once and kept beside the results."""

from __future__ import annotations

import hashlib
import json
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from sim.settings import Refused
from workflow.budget.detail import FINEST, Presets
from workflow.budget.forecast import Forecast, calibrated, forecast, teller
from workflow.budget.model import Model
from workflow.budget.pilot import ROOT
from workflow.plan import RESULTS, Plan
from workflow.presets import QUALITIES
from workflow.scene import load
from workflow.stage import write_json

STEP = 0.05
"""Between details that are looked at."""
MARGIN = 1.2
"""A budget is so many times what is predicted: films took up to 1.25 times as long."""
AGAIN = 0.1
"""Farther than so much detail from where a model was corrected it is corrected anew."""


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
    presets, tell = Presets(path), teller(name)
    with calibrated(presets, cores, tell) as (calibration, model):
        detail, probed = _finest(presets, model, budget, cores), None
        while probed is None or abs(detail - probed) > AGAIN:
            calibration.probe(model, presets.at(detail))
            detail, probed = _finest(presets, model, budget, cores), detail
    choice = Choice(key, detail, forecast(model, presets.at(detail), cores))
    place.parent.mkdir(parents=True, exist_ok=True)
    write_json(place, asdict(choice))
    tell(f"{told(choice)}; found in {time.perf_counter() - start:.0f} s")
    return choice


def told(choice: Choice) -> str:
    """A choice in words."""
    below = int(min(choice.detail, FINEST - STEP))
    where = f"detail {choice.detail:.2f}, from {QUALITIES[below]} ({below}) to {QUALITIES[below + 1]} ({below + 1})"
    return f"{where}: {choice.forecast}"


def _finest(presets: Presets, model: Model, budget: float, cores: int) -> float:
    """The finest detail that fits; raises Refused."""
    steps = round(FINEST / STEP)
    low, high = 0, steps + 1
    needed = MARGIN * forecast(model, presets.at(0.0), cores).wall_s
    if needed > budget:
        raise Refused(
            f"--config budget={budget:g}s: even at draft quality {presets.path} takes about {needed:.0f} s",
            remedy=f"give it {needed:.0f} s or more, or a shorter duration",
        )
    while high - low > 1:
        middle = (low + high) // 2
        fits = MARGIN * forecast(model, presets.at(middle * STEP), cores).wall_s <= budget
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
